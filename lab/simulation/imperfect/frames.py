"""What imperfect perception looks at: a frame whose every pixel's object is known, and where such frames come from."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.types import F32, F64, U8, U16, Frame, Intrinsics

FRAME_NS = 100_000_000
_GREY = 128


@dataclass(frozen=True, slots=True, eq=False)
class SeenFrame:
    """One frame with its truth.

    index: names the frame, with the seed, to every random draw. depth: `(H, W)` float32 metres, 0 = none.
    ids: `(H, W)` uint16 object ids, 0 = nothing. rgb: `(H, W, 3)` uint8, None where nobody rendered colour.
    blur: length of the motion blur in pixels.
    """

    index: int
    timestamp_ns: int
    intrinsics: Intrinsics
    world_from_camera: F64
    rgb: U8 | None
    depth: F32
    ids: U16
    blur: float = 0.0

    @property
    def frame_id(self) -> str:
        return f"{self.index:06d}"

    @property
    def frame(self) -> Frame:
        """As perception gets it; grey where there is no colour."""
        rgb = np.full((*self.depth.shape, 3), _GREY, np.uint8) if self.rgb is None else self.rgb
        return Frame(
            self.frame_id, self.timestamp_ns, self.intrinsics, self.world_from_camera, rgb, self.depth
        )


class DepthRenderer(Protocol):
    """Renders depth `(H, W)` metres and ids `(H, W)` at a pose."""

    @property
    def intrinsics(self) -> Intrinsics: ...

    def depth_and_ids(self, world_from_camera: F64, /) -> tuple[F32, U16]: ...


class Rendered(Protocol):
    """A picture with its truth."""

    @property
    def rgb(self) -> U8: ...
    @property
    def depth(self) -> F32: ...
    @property
    def ids(self) -> U16: ...


class ColorRenderer(Protocol):
    """Renders colour too."""

    @property
    def intrinsics(self) -> Intrinsics: ...

    def render(self, world_from_camera: F64, /) -> Rendered | tuple[U8, F32, U16]: ...


def rendered_frames(renderer: DepthRenderer, poses: Iterable[F64]) -> Iterator[SeenFrame]:
    """Frames of depth and ids only, at each pose, ten a second."""
    for index, pose in enumerate(poses):
        depth, ids = renderer.depth_and_ids(pose)
        yield SeenFrame(index, index * FRAME_NS, renderer.intrinsics, pose, None, depth, ids)


def coloured_frames(renderer: ColorRenderer, poses: Iterable[F64]) -> Iterator[SeenFrame]:
    """Frames with colour, at each pose, ten a second."""
    for index, pose in enumerate(poses):
        seen = renderer.render(pose)
        rgb, depth, ids = seen if isinstance(seen, tuple) else (seen.rgb, seen.depth, seen.ids)
        yield SeenFrame(index, index * FRAME_NS, renderer.intrinsics, pose, rgb, depth, ids)


def small_house_frames(root: Path, stride: int = 1) -> Iterator[SeenFrame]:
    """The walk `seq_a` of the small house in `root`, every `stride`-th frame. InvalidInput where it is not there."""
    folder = root / "seq_a"
    if not (folder / "poses.txt").is_file() or not (folder / "instance").is_dir():
        raise InvalidInput(
            f"{root}: expected the small house's walk (seq_a/poses.txt, rgb, depth, instance), got none"
        )
    camera = json.loads((folder / "intrinsics.json").read_text(encoding="utf-8"))
    fx, fy, cx, cy = (float(camera[name]) for name in ("fx", "fy", "cx", "cy"))
    k = Intrinsics(fx, fy, cx, cy, int(camera["width"]), int(camera["height"]))
    poses = np.loadtxt(folder / "poses.txt").reshape(-1, 4, 4)
    for index in range(0, len(poses), stride):
        rgb = _image(folder / "rgb" / f"{index:06d}.jpg", cv2.IMREAD_COLOR_RGB)
        depth = _image(folder / "depth" / f"{index:06d}.png", cv2.IMREAD_UNCHANGED)
        ids = _image(folder / "instance" / f"{index:06d}.png", cv2.IMREAD_UNCHANGED)
        metres = (depth / float(camera["depth_scale"])).astype(np.float32)
        yield SeenFrame(
            index, index * FRAME_NS, k, poses[index], rgb.astype(np.uint8), metres, ids.astype(np.uint16)
        )


def halved(frames: Iterable[SeenFrame]) -> Iterator[SeenFrame]:
    """The same frames at half the width and height: every other pixel of every other row.

    Lifting's thresholds in pixels then mean twice as much: `LiftParams(min_mask_area=20, edge=1)` keeps their sense.
    """
    for seen in frames:
        depth = np.ascontiguousarray(seen.depth[::2, ::2])
        k = seen.intrinsics
        yield replace(
            seen,
            intrinsics=Intrinsics(k.fx / 2, k.fy / 2, k.cx / 2, k.cy / 2, depth.shape[1], depth.shape[0]),
            rgb=None if seen.rgb is None else np.ascontiguousarray(seen.rgb[::2, ::2]),
            depth=depth,
            ids=np.ascontiguousarray(seen.ids[::2, ::2]),
            blur=seen.blur / 2,
        )


def _image(path: Path, flags: int) -> U8 | U16:
    image = cv2.imread(str(path), flags)
    if image is None:
        raise InvalidInput(f"{path}: expected an image, got none that can be read")
    return np.asarray(image)
