"""Replica's own semantic mesh: what every triangle belongs to, and what it is called; the truth of the data set.

SCENE/habitat/mesh_semantic.ply (faces of three or four corners, each with an object_id) and info_semantic.json
({"objects": [{"id", "class_name", ..}]}). World: z up, metres, the same as the poses of layout `replica`. The
data set writes room_0 and office_3 where its renders write room0 and office3.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.ply import Columns, read_ply
from ovip.recordings.text import read_json
from ovip.scene.types import F64, I64

_MESH = Path("habitat") / "mesh_semantic.ply"


@dataclass(frozen=True, slots=True, eq=False)
class ReplicaMesh:
    """vertices `(V, 3)` metres; faces `(T, 3)` triangles; object_ids `(T,)`; labels: object_id -> class name.

    An object_id without a label is a bit of surface that nobody named.
    """

    vertices: F64
    faces: I64
    object_ids: I64
    labels: dict[int, str]


def read_replica_mesh(folder: str | Path) -> ReplicaMesh:
    """The mesh of the scene in `folder`, which may be written room_0 or room0; InvalidInput says what is missing."""
    root = _scene(Path(folder))
    path = root / _MESH
    elements = read_ply(path)
    corners = next(iter(elements.get("vertex", [])), {})
    if not {"x", "y", "z"} <= corners.keys():
        raise InvalidInput(f"{path}: expected vertices with x, y and z, got {', '.join(corners) or 'none'}")
    vertices = np.stack([corners[axis] for axis in "xyz"], axis=1).astype(np.float64)
    groups = [_triangles(group, path) for group in elements.get("face", [])]
    faces = np.concatenate([np.empty((0, 3), np.int64), *(faces for faces, _ in groups)])
    object_ids = np.concatenate([np.empty(0, np.int64), *(ids for _, ids in groups)])
    if len(faces) and not (faces.min() >= 0 and faces.max() < len(vertices)):
        raise InvalidInput(f"{path}: expected faces of its {len(vertices)} vertices, got index {faces.max()}")
    return ReplicaMesh(vertices, faces, object_ids, _labels(root / "habitat" / "info_semantic.json"))


def _scene(folder: Path) -> Path:
    """The scene's folder by either of its names, or from its habitat/ inside."""
    other = re.sub(r"^(\D+?)_?(\d+)$", lambda m: f"{m[1]}{'' if '_' in m[0] else '_'}{m[2]}", folder.name)
    for found in (folder, folder.with_name(other), folder.parent):
        if (found / _MESH).is_file() and (found != folder.parent or folder.name == "habitat"):
            return found
    raise InvalidInput(f"{folder}: expected a scene of Replica itself, with {_MESH}, got none")


def _triangles(group: Columns, path: Path) -> tuple[I64, I64]:
    """Faces of k corners as fans of k - 2 triangles."""
    corners = group.get("vertex_indices", group.get("vertex_index"))
    if corners is None or "object_id" not in group:
        raise InvalidInput(
            f"{path}: expected faces with vertex_indices and object_id, got {', '.join(group)}"
        )
    corners = corners.astype(np.int64)
    fans = [corners[:, [0, k, k + 1]] for k in range(1, corners.shape[1] - 1)]
    if not fans:
        return np.empty((0, 3), np.int64), np.empty(0, np.int64)
    return np.stack(fans, axis=1).reshape(-1, 3), np.repeat(group["object_id"].astype(np.int64), len(fans))


def _labels(path: Path) -> dict[int, str]:
    listed = read_json(path).get("objects")
    if not isinstance(listed, list):
        raise InvalidInput(f"{path}: expected a list under 'objects', got {type(listed).__name__}")
    found = {}
    for item in listed:
        if not isinstance(item, dict) or not isinstance(item.get("id"), int):
            raise InvalidInput(f"{path}: expected objects with an 'id' and a 'class_name', got {item!r:.80}")
        found[item["id"]] = str(item.get("class_name", ""))
    return {object_id: label for object_id, label in found.items() if label}
