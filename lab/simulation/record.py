"""`python -m lab.simulation.record`: a walk through a generated home as a recording with its truth beside it."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from lab.simulation.home import Home
from lab.simulation.renderer import RenderParams
from lab.simulation.sensor import NO_NOISE, SensorParams
from lab.simulation.small_house import load_small_house
from lab.simulation.world import HOME_CAMERA, HomeWorld, HomeWorldParams
from lab.simulation.writing import HomeRecordingParams, Packing, write_home_recording
from ovip.errors import OvipError
from ovip.scene.types import Intrinsics


def main() -> None:
    """A known error ends with one line and status 1."""
    chosen = _arguments()
    try:
        world = HomeWorld(_home(chosen), _camera(chosen.width), chosen.seed, _params(chosen))
        written = HomeRecordingParams(Packing(chosen.quality, 9), instances=not chosen.no_instances)
        count = write_home_recording(chosen.out, world, params=written)
    except OvipError as error:
        print(f"record: {error}", file=sys.stderr)
        raise SystemExit(1) from error
    size = sum(path.stat().st_size for path in chosen.out.rglob("*") if path.is_file())
    print(
        f"{chosen.out}: {count} frames of {world.home.name}, {len(world.home.things)} things, {size / 1e6:.1f} MB"
    )


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m lab.simulation.record", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="a new folder for the recording")
    parser.add_argument("--seed", type=int, default=0, help="of the home, the walk and the noise")
    parser.add_argument("--style", default=None, help="of the home; by the seed where left out")
    parser.add_argument(
        "--small-house", type=Path, default=None, help="the small house in this folder instead"
    )
    parser.add_argument(
        "--frames", type=int, default=None, help="of the walk; as many as it needs where left out"
    )
    parser.add_argument(
        "--width", type=int, default=640, help="of a frame in pixels; the height is three quarters"
    )
    parser.add_argument("--quality", type=int, default=90, help="of the JPEG images, 0 to 100")
    parser.add_argument(
        "--supersample", type=int, default=2, help="colour is rendered at so many times the size"
    )
    parser.add_argument("--no-blur", action="store_true", help="no motion blur")
    parser.add_argument("--exact", action="store_true", help="no sensor noise")
    parser.add_argument("--exact-depth", action="store_true", help="no noise in depth and poses")
    parser.add_argument("--no-instances", action="store_true", help="no instance images")
    parser.add_argument("--onboard", action="store_true", help="with what the robot detects itself, exactly")
    return parser.parse_args()


def _home(chosen: argparse.Namespace) -> Home:
    if chosen.small_house is not None:
        return load_small_house(chosen.small_house)
    from lab.simulation.generate import make_home

    return make_home(chosen.seed, chosen.style)


def _camera(width: int) -> Intrinsics:
    scale = width / HOME_CAMERA.width
    height = round(HOME_CAMERA.height * scale)
    focal = HOME_CAMERA.fx * scale
    return Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2, width, height)


def _params(chosen: argparse.Namespace) -> HomeWorldParams:
    sensor = NO_NOISE if chosen.exact else SensorParams()
    if chosen.exact_depth:
        sensor = replace(NO_NOISE, blur=sensor.blur, gain=sensor.gain, grain=sensor.grain)
    if chosen.no_blur:
        sensor = replace(sensor, blur=0.0)
    return HomeWorldParams(
        sensor=sensor,
        render=RenderParams(supersample=chosen.supersample),
        onboard=chosen.onboard,
        frames=chosen.frames,
    )


if __name__ == "__main__":
    main()
