"""What a walk through a home shows of each of its objects, lifted by true masks."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import lab.simulation
import services.perception.domain
from lab.simulation.catalogue.config import cache_folder
from lab.simulation.home import Home
from lab.simulation.imperfect import SeenFrame, rendered_frames
from lab.simulation.sensor import Sensor, SensorParams
from lab.simulation.world import HOME_CAMERA
from ovip.scene.types import F32, I64
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.upkeep import UpkeepParams, denoised
from services.perception.domain.lifting import LiftParams, lift_all

FRAMES = 240
"""Frames of a walk: a minute's work or two."""

_VIEWS = ("exact", "noisy")


@dataclass(frozen=True, slots=True, eq=False)
class TrueClouds:
    """Points by object id, `(P, 3)` metres, one a voxel as the mapper keeps them.

    exact: all that perfect depth shows from true poses. noisy: of a real camera's depth and a drifting pose, cleaned
    as the mapper cleans.
    """

    exact: dict[int, F32]
    noisy: dict[int, F32]


def true_clouds(home: Home, folder: Path | None = None) -> TrueClouds:
    """Of a generated home, made and kept in `folder` (None: the lab's cache) where they were not there yet."""
    from lab.simulation.renderer import Renderer
    from lab.simulation.tour import walk_through

    kept = (folder or cache_folder() / "clouds") / f"home-{home.seed}-{_made_by(home)}.npz"
    if not kept.is_file():
        frames = rendered_frames(Renderer(home, HOME_CAMERA), walk_through(home, home.seed, FRAMES))
        _save(kept, clouds_of_walk(frames, home.seed))
    with np.load(kept) as arrays:
        return TrueClouds(*(_by_id(arrays[f"{view}_points"], arrays[f"{view}_ids"]) for view in _VIEWS))


def clouds_of_walk(frames: Iterable[SeenFrame], seed: int) -> TrueClouds:
    """Goes through the frames once; each mask is lifted as perception lifts, each cloud kept as the mapper does."""
    exact: dict[int, VoxelCloud] = {}
    noisy: dict[int, VoxelCloud] = {}
    sensor: Sensor | None = None
    for seen in frames:
        sensor = sensor or Sensor(seen.intrinsics, SensorParams(), seed)
        _add(exact, seen)
        _, depth, pose = sensor.observe(seen.frame.rgb, seen.depth, seen.world_from_camera, seen.index)
        _add(noisy, replace(seen, depth=depth, world_from_camera=pose))
    cleaned = dict(zip(noisy, denoised(list(noisy.values()), UpkeepParams()), strict=True))
    return TrueClouds(_points_of(exact), _points_of(cleaned))


def _add(clouds: dict[int, VoxelCloud], seen: SeenFrame) -> None:
    lifting = LiftParams()
    counts = np.bincount(seen.ids.ravel())
    ids = [i for i in np.flatnonzero(counts >= lifting.min_mask_area).tolist() if i > 0]
    made = lift_all(seen.frame, [seen.ids == i for i in ids], lifting)
    for object_id, lifted in zip(ids, made, strict=True):
        if lifted is None:
            continue
        cloud = VoxelCloud.of(lifted.points, lifted.colors, lifting.voxel)
        known = clouds.get(object_id)
        clouds[object_id] = cloud if known is None else known.merged(cloud)


def _points_of(clouds: dict[int, VoxelCloud]) -> dict[int, F32]:
    return {i: cloud.points for i, cloud in sorted(clouds.items())}


def _by_id(points: F32, ids: I64) -> dict[int, F32]:
    """Runs of one id apart."""
    starts = np.flatnonzero(np.diff(ids, prepend=-1))
    return {int(ids[a]): part for a, part in zip(starts, np.split(points, starts[1:]), strict=True)}


def _save(path: Path, clouds: TrueClouds) -> None:
    arrays: dict[str, Any] = {}
    for view, by_id in zip(_VIEWS, (clouds.exact, clouds.noisy), strict=True):
        arrays[f"{view}_points"] = np.concatenate([np.zeros((0, 3), np.float32), *by_id.values()])
        arrays[f"{view}_ids"] = np.repeat(np.array([*by_id], np.int64), [len(p) for p in by_id.values()])
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".npz", delete=False) as file:
        np.savez(file, **arrays)
    Path(file.name).replace(path)


def _made_by(home: Home) -> str:
    """Changes with anything that the clouds of a home are made by."""
    digest = hashlib.sha256(f"{home.name} {home.furniture} {FRAMES}".encode())
    for package in (lab.simulation, services.perception.domain):
        for path in sorted(Path(str(package.__file__)).parent.rglob("*.py")):
            digest.update(path.read_bytes())
    digest.update(Path(__file__).read_bytes())
    return digest.hexdigest()[:16]
