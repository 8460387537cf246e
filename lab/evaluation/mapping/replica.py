"""A Replica scene as a place: its recording, and truth and instance ids from the data set's own semantic mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from lab.evaluation.mapping.sources import Source
from lab.evaluation.scores.instance import NOTHING, vertex_instances
from lab.evaluation.scores.semantic import EXCLUDED, REPLICA_CLASSES
from lab.simulation.home import Home, HomeObject, Material, Mesh, Storey, triangle_areas
from lab.simulation.imperfect import SeenFrame
from ovip.errors import InvalidInput
from ovip.recordings import Recording, open_recording
from ovip.recordings.images import decode_raw_depth
from ovip.recordings.replica_mesh import ReplicaMesh, read_replica_mesh
from ovip.scene.types import Intrinsics

STRIDE = 5  # the paper's
WIDTH = 320  # pixels, about, that frames are thinned to
AGREES = 0.05  # metres between recorded and rendered depth within which a pixel's id is believed
_VOID = frozenset({"", "void", "undefined", "unlabeled"})


def replica_scenes(root: Path) -> list[str]:
    """The scenes in `root` with a recording, sorted, as the folders are called. InvalidInput for none."""
    found = sorted(folder.name for folder in root.iterdir() if (folder / "traj.txt").is_file())
    if not found:
        here = ", ".join(sorted(path.name for path in root.iterdir())[:8]) or "nothing"
        raise InvalidInput(
            f"{root}: expected Replica: a folder a scene with results/ and traj.txt (and the data set's own "
            f"habitat/mesh_semantic.ply in it or in a folder room_0 for room0), got {here}"
        )
    return found


def replica_source(root: Path, scene: str) -> Source:
    """One scene: every fifth frame, ids rendered from the mesh, truth at all of the mesh's vertices."""
    mesh = read_replica_mesh(root / scene)
    home = _home(scene, mesh)
    recording = open_recording(root / scene, "replica", stride=STRIDE)
    ids = vertex_instances(
        home.mesh.triangles,
        triangle_areas(home.mesh),
        home.mesh.object_ids.astype(np.int64),
        len(mesh.vertices),
        {thing.object_id for thing in home.things},
    )
    return Source(
        home=home,
        frames=_frames(home, recording),
        points=home.mesh.vertices,
        ids=np.where(ids == NOTHING, 0, ids),
        classes=tuple(_word(name) for name in REPLICA_CLASSES),
        only_seen=False,
    )


def _home(scene: str, mesh: ReplicaMesh) -> Home:
    """The mesh as a home of one storey: object ids count from 1, 0 = what nobody named."""
    labels = {i: _word(label) for i, label in mesh.labels.items() if _word(label) not in _VOID}
    named = sorted(set(np.unique(mesh.object_ids).tolist()) & labels.keys())
    lookup = np.zeros(1 + max([0, *named, int(mesh.object_ids.max(initial=0))]), np.uint16)
    lookup[named] = np.arange(1, len(named) + 1)
    ids = np.where(mesh.object_ids >= 0, lookup[np.maximum(mesh.object_ids, 0)], 0).astype(np.uint16)
    shape = _mesh(mesh, ids)
    areas = np.bincount(ids, weights=triangle_areas(shape), minlength=len(named) + 1)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    things = tuple(
        _thing(shape, number, labels[i], float(areas[number])) for number, i in enumerate(named, start=1)
    )
    storey = Storey(0, float(low[2]), float(high[2]))
    return Home(scene, 0, "replica", shape, (storey,), (), (), things, furniture="Replica's own mesh")


def _mesh(mesh: ReplicaMesh, ids: np.ndarray[tuple[int, ...], np.dtype[np.uint16]]) -> Mesh:
    count = len(mesh.faces)
    return Mesh(
        vertices=mesh.vertices.astype(np.float32),
        triangles=mesh.faces.astype(np.int32),
        normals=np.zeros((count, 3, 3), np.float32),
        uv=np.zeros((count, 3, 2), np.float32),
        material_ids=np.zeros(count, np.int32),
        materials=(Material(np.full(3, 200, np.uint8)),),
        object_ids=ids,
    )


def _thing(mesh: Mesh, object_id: int, label: str, area: float) -> HomeObject:
    corners = mesh.vertices[mesh.triangles[mesh.object_ids == object_id].ravel()].astype(np.float64)
    box = np.concatenate([corners.min(axis=0), corners.max(axis=0)])
    return HomeObject(object_id, label, (), label in EXCLUDED[6] - EXCLUDED[1], box, area, 0, 0)


def _word(name: str) -> str:
    return name.strip().lower().replace("-", " ").replace("_", " ")


def _frames(home: Home, recording: Recording) -> Iterator[SeenFrame]:
    """The recorded depth with ids rendered at the same pixels; 0 where the two do not agree."""
    from lab.simulation.renderer import Renderer

    step = max(1, round(recording.intrinsics.width / WIDTH))
    k = _thinned(recording.intrinsics, step)
    renderer = Renderer(home, k)
    for frame in recording:
        raw = decode_raw_depth(frame.depth_bytes)
        if raw is None:
            raise InvalidInput(
                f"{recording.name}: expected a depth image in frame {frame.index}, got none that decodes"
            )
        depth = np.ascontiguousarray(raw[::step, ::step] / frame.depth_scale, dtype=np.float32)
        rendered, ids = renderer.depth_and_ids(frame.world_from_camera)
        agrees = np.abs(rendered - depth) <= AGREES
        yield SeenFrame(
            index=frame.index,
            timestamp_ns=frame.timestamp_ns,
            intrinsics=k,
            world_from_camera=frame.world_from_camera,
            rgb=None,
            depth=depth,
            ids=np.where(agrees, ids, np.uint16(0)),
        )


def _thinned(k: Intrinsics, step: int) -> Intrinsics:
    """The camera of every `step`-th pixel of every `step`-th row."""
    width, height = -(-k.width // step), -(-k.height // step)
    return replace(
        k, fx=k.fx / step, fy=k.fy / step, cx=k.cx / step, cy=k.cy / step, width=width, height=height
    )
