"""The AWS RoboMaker small house (MIT-0) as a home: its meshes, textures, objects, zones and walled spaces.

Folder: meshes.npz, textures.json, textures/*.jpg, objects.json, rooms.json. Its functional zones are the areas,
its walled spaces the rooms.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from lab.simulation.home import Area, Home, HomeObject, Material, Mesh, Storey
from ovip.errors import InvalidInput
from ovip.recordings.text import read_text
from ovip.scene.types import F64
from ovip.scene.words import normalize_word

FUNCTIONS = {"gym corner": "gym", "relaxation corner": "living room"}
"""Zones whose name is no function word; every other zone is named by its function."""

_FILES = ("meshes.npz", "textures.json", "objects.json", "rooms.json")
_WHITE = np.array([255, 255, 255], dtype=np.uint8)


def load_small_house(root: Path) -> Home:
    """The house in folder `root`. InvalidInput where a file of it is missing."""
    missing = [name for name in _FILES if not (root / name).is_file()]
    if missing:
        raise InvalidInput(
            f"{root}: expected the small house ({', '.join(_FILES)}), missing {', '.join(missing)}"
        )
    things, rooms = _json(root / "objects.json"), _json(root / "rooms.json")
    storey = Storey(0, float(rooms["floor_z"]), float(rooms["ceiling_z"]["default"]))
    return Home(
        name="small house",
        seed=0,
        style="open-elongated",
        mesh=_mesh(root),
        storeys=(storey,),
        rooms=tuple(_space(space) for space in rooms["spaces"]),
        areas=tuple(_zone(zone) for zone in rooms["zones"]),
        objects=tuple(_object(thing) for thing in things),
        furniture="the small house's own models",
        attributions=("aws-robotics/aws-robomaker-small-house-world, MIT No Attribution (MIT-0)",),
    )


def _json(path: Path) -> Any:
    return json.loads(read_text(path))


def _mesh(root: Path) -> Mesh:
    with np.load(root / "meshes.npz") as arrays:
        normals = arrays["triangle_normals"].astype(np.float32)
        return Mesh(
            vertices=arrays["vertices"].astype(np.float32),
            triangles=arrays["triangles"].astype(np.int32),
            normals=normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-6),
            uv=arrays["triangle_uv"].astype(np.float32),
            material_ids=arrays["triangle_texture"].astype(np.int32),
            materials=_materials(root),
            object_ids=arrays["triangle_object"].astype(np.uint16),
        )


def _materials(root: Path) -> tuple[Material, ...]:
    listed = sorted(_json(root / "textures.json"), key=lambda entry: int(entry["texture_id"]))
    return tuple(Material(_WHITE, _texture(root / entry["file"])) for entry in listed)


def _texture(path: Path) -> np.ndarray[Any, np.dtype[np.uint8]]:
    image = cv2.imread(str(path), cv2.IMREAD_COLOR_RGB)
    if image is None:
        raise InvalidInput(f"{path}: expected an image, got none that can be read")
    return np.asarray(image, dtype=np.uint8)


def _space(space: dict[str, Any]) -> Area:
    name = normalize_word(space["name"])
    return Area(int(space["space_id"]), 0, name, name, _ring(space), int(space["space_id"]))


def _zone(zone: dict[str, Any]) -> Area:
    label = normalize_word(zone["label"])
    function = FUNCTIONS.get(label, label)
    return Area(int(zone["zone_id"]), 0, function, label, _ring(zone), int(zone["space_id"]))


def _ring(area: dict[str, Any]) -> F64:
    return np.asarray(area["polygon"], dtype=np.float64)


def _object(thing: dict[str, Any]) -> HomeObject:
    return HomeObject(
        object_id=int(thing["object_id"]),
        label=normalize_word(thing["label"]),
        attributes=(),
        structural=bool(thing["structural"]),
        box=np.array([*thing["aabb_low"], *thing["aabb_high"]], dtype=np.float64),
        surface_area=float(thing["surface_area"]),
        floor=0,
        area_id=int(thing["zone_id"] or 0),
    )
