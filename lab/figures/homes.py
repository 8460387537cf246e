"""A home as a picture: two views from inside, and each storey from above with its ceiling taken off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from lab.simulation.ground import Ground
from lab.simulation.home import Home, Mesh
from lab.simulation.renderer import Renderer, RenderParams
from lab.simulation.shading import ShadingParams
from lab.simulation.tour import walk_through
from lab.simulation.world import HOME_CAMERA
from ovip.errors import InvalidInput
from ovip.scene.types import F64, U8, Bools, Intrinsics

_FINE = RenderParams(supersample=2)
_FROM_ABOVE = RenderParams(supersample=2, shading=ShadingParams(lights=12, sharp=0, adaption=0.8, middle=0.4))
_CUT = 1.9  # metres above the floor at which a storey is cut open
_HIGH = 200.0  # metres from which it is looked at: nearly without perspective
_MARGIN = 0.4
_CANDIDATES = 40
_GAP = 8  # pixels
_PAPER = np.array([255, 255, 255], dtype=np.uint8)


def draw_home(home: Home, path: Path) -> Path:
    """Draws into `path` (PNG or JPEG) and returns it."""
    if not cv2.haveImageWriter(str(path)):
        raise InvalidInput(f"{path}: expected the name of a picture, like home.png")
    views = inside_views(home)
    count = len(home.storeys)
    width = (_width(views) - _GAP * (count - 1)) // count
    plans = _of_one_height([storey_from_above(home, storey.floor, width) for storey in home.storeys])
    rows = [_beside(views), _beside(plans)]
    widest = min(row.shape[1] for row in rows)
    picture = np.vstack(
        [rows[0][:, :widest], np.broadcast_to(_PAPER, (_GAP, widest, 3)), rows[1][:, :widest]]
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.ascontiguousarray(picture[..., ::-1]))
    return path


def inside_views(home: Home, count: int = 2) -> list[U8]:
    """The `count` pictures `(480, 640, 3)` of a walk through the home that show most things, from different areas."""
    renderer = Renderer(home, HOME_CAMERA, _FINE)
    ground = Ground(home)
    poses = walk_through(home, 0, _CANDIDATES, ground=ground)
    shown = [_things_shown(home, renderer, pose) for pose in poses]
    chosen: list[int] = []
    for index in np.argsort(-np.array(shown), kind="stable").tolist():
        if len(chosen) < count and all(_apart(poses[index], poses[other]) for other in chosen):
            chosen.append(index)
    return [renderer.render(poses[index]).rgb for index in chosen]


def storey_from_above(home: Home, floor: int, width: int) -> U8:
    """One storey `(H, width, 3)` seen from above, cut open under its ceiling; x to the right, y up."""
    storey = next(storey for storey in home.storeys if storey.floor == floor)
    corners = np.concatenate([area.polygon for area in home.rooms if area.floor == floor])
    low, high = corners.min(axis=0) - _MARGIN, corners.max(axis=0) + _MARGIN
    scale = width / float((high - low)[0])
    size = (width, max(16, round(float((high - low)[1]) * scale)))
    k = Intrinsics(scale * _HIGH, scale * _HIGH, (size[0] - 1) / 2, (size[1] - 1) / 2, *size)
    pose = np.diag([1.0, -1.0, -1.0, 1.0])  # looks down
    pose[:3, 3] = [*((low + high) / 2), storey.z + _HIGH]
    opened = replace(home, mesh=_cut_open(home.mesh, _ceilings(home), storey.z - 0.3, storey.z + _CUT))
    seen = Renderer(opened, k, _FROM_ABOVE).render(pose)
    return np.asarray(np.where((seen.ids > 0)[..., None], seen.rgb, _PAPER), dtype=np.uint8)


def _cut_open(mesh: Mesh, without: Bools, low: float, high: float) -> Mesh:
    """What lies between two heights and is none of the objects `without` `(N,)`; what sticks out above ends there."""
    z = mesh.vertices[:, 2][mesh.triangles]
    kept = (z.min(axis=1) < high) & (z.max(axis=1) > low) & ~without[mesh.object_ids]
    vertices = mesh.vertices.copy()
    vertices[:, 2] = np.minimum(vertices[:, 2], high)
    return replace(
        mesh,
        vertices=vertices,
        triangles=mesh.triangles[kept],
        normals=mesh.normals[kept],
        uv=mesh.uv[kept],
        material_ids=mesh.material_ids[kept],
        object_ids=mesh.object_ids[kept],
    )


def _ceilings(home: Home) -> Bools:
    without = np.zeros(int(home.mesh.object_ids.max()) + 1, dtype=bool)
    for thing in home.objects:
        without[thing.object_id] = thing.label.startswith("ceiling") or thing.label == "chandelier"
    return without


def _things_shown(home: Home, renderer: Renderer, pose: F64) -> int:
    """How many things are well in view; none where the camera is close to something."""
    depth, ids = renderer.depth_and_ids(pose)
    if np.median(depth) < 1.5:
        return 0
    counts = np.bincount(ids.ravel())
    things = [thing.object_id for thing in home.things if thing.object_id < len(counts)]
    return int(np.count_nonzero(counts[things] > 300))


def _apart(a: F64, b: F64) -> bool:
    return bool(np.linalg.norm(a[:3, 3] - b[:3, 3]) > 2.0)


def _width(pictures: Sequence[U8]) -> int:
    return sum(int(picture.shape[1]) for picture in pictures) + _GAP * (len(pictures) - 1)


def _beside(pictures: Sequence[U8]) -> U8:
    gap = np.broadcast_to(_PAPER, (pictures[0].shape[0], _GAP, 3))
    parts = [part for picture in pictures for part in (gap, picture)][1:]
    return np.asarray(np.hstack(parts), dtype=np.uint8)


def _of_one_height(pictures: Sequence[U8]) -> list[U8]:
    most = max(picture.shape[0] for picture in pictures)
    return [
        np.vstack([picture, np.broadcast_to(_PAPER, (most - picture.shape[0], picture.shape[1], 3))])
        for picture in pictures
    ]
