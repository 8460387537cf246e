"""Wavefront models: OBJ geometry, MTL materials and their pictures, read into a `Mesh`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import cv2
import numpy as np

from lab.simulation.catalogue.ears import triangulated
from lab.simulation.home import Material, Mesh
from ovip.errors import InvalidInput
from ovip.scene.types import F32, F64, I32, U8

LARGEST_TEXTURE = 256
"""Pixels along a picture's longer side."""
CREASE = np.cos(np.radians(40))
"""Faces that meet under a sharper angle keep their own normals where the file gives none."""
CLEAR = 0.05
"""A material less opaque than this is not there at all."""
GLASS = np.array([206.0, 218.0, 220.0])
"""What is seen through a see-through material, which has no place in a mesh of opaque ones."""

Reader = Callable[[str], bytes | None]
"""Gives a file beside the model by its name, None where there is none."""


@dataclass(slots=True)
class _Corners:
    """Triangles as they are read: rows of indices into v, vt, vn (-1 = none), and a material each."""

    points: list[tuple[float, ...]] = field(default_factory=list)
    pictures: list[tuple[float, ...]] = field(default_factory=list)
    normals: list[tuple[float, ...]] = field(default_factory=list)
    faces: list[tuple[tuple[int, int, int], ...]] = field(default_factory=list)
    materials: list[int] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    libraries: list[str] = field(default_factory=list)


def read_wavefront(text: str, beside: Reader, known: Mapping[str, Material] | None = None) -> Mesh:
    """A mesh in the file's own frame and unit, its object ids 0.

    beside: gives the MTL files and pictures that the model names. known: materials by name that need no MTL file,
    and stand before its own. Polygons are triangulated; missing normals are computed; missing uv are 0; a material
    without a definition is light grey. InvalidInput where there is no face.
    """
    corners = _read_obj(text)
    if not corners.faces:
        raise InvalidInput("expected an OBJ model with faces; it has none")
    library: dict[str, Material | None] = {}
    for name in corners.libraries:
        found = beside(name)
        if found is not None:
            library.update(_read_mtl(found.decode("latin-1"), beside))
    return _mesh(corners, {**library, **(known or {})})


def _read_obj(text: str) -> _Corners:
    read = _Corners()
    current = 0
    indices: dict[str, int] = {}
    for line in text.replace("\\\r\n", " ").replace("\\\n", " ").split("\n"):
        word, _, rest = line.strip().partition(" ")
        if word == "v":
            read.points.append(_floats(rest, 3))
        elif word == "vt":
            read.pictures.append(_floats(rest, 2))
        elif word == "vn":
            read.normals.append(_floats(rest, 3))
        elif word == "f":
            _add_polygon(read, rest.split(), current)
        elif word == "usemtl":
            current = indices.setdefault(rest.strip(), len(indices))
        elif word == "mtllib":
            read.libraries.append(rest.strip())
    if not indices or max(read.materials, default=0) >= len(indices):
        indices.setdefault("", len(indices))
    read.names = list(indices)
    return read


def _floats(text: str, count: int) -> tuple[float, ...]:
    values = tuple(float(value) for value in text.split()[:count])
    return values + (0.0,) * (count - len(values))


def _add_polygon(read: _Corners, words: list[str], material: int) -> None:
    counts = (len(read.points), len(read.pictures), len(read.normals))
    ring = [_indices(word, counts) for word in words]
    if len(ring) < 3:
        return
    if len(ring) < 5:
        fans = [(0, i, i + 1) for i in range(1, len(ring) - 1)]
    else:
        fans = triangulated(np.array([read.points[i] for i, _, _ in ring]))
    for a, b, c in fans:
        read.faces.append((ring[a], ring[b], ring[c]))
        read.materials.append(material)


def _indices(word: str, counts: tuple[int, int, int]) -> tuple[int, int, int]:
    parts = (*word.split("/"), "", "")[:3]
    point, picture, normal = (
        -1 if not part else int(part) - 1 if int(part) > 0 else count + int(part)
        for part, count in zip(parts, counts, strict=True)
    )
    return point, picture, normal


def _mesh(read: _Corners, library: Mapping[str, Material | None]) -> Mesh:
    corners = np.asarray(read.faces, np.int64)
    materials = np.asarray(read.materials, np.int32)
    points = np.asarray(read.points, np.float64)
    a, b, c = np.moveaxis(points[corners[:, :, 0]], 1, 0)
    flat = np.cross(b - a, c - a)
    area = np.linalg.norm(flat, axis=1)
    hidden = [i for i, name in enumerate(read.names) if name in library and library[name] is None]
    keep = (area > 0) & ~np.isin(materials, hidden)
    if not keep.any():
        raise InvalidInput("expected an OBJ model with faces that can be seen; it has none")
    corners, materials, flat = corners[keep], materials[keep], flat[keep]
    used, vertices = np.unique(corners[:, :, 0], return_inverse=True)
    triangles = vertices.reshape(-1, 3).astype(np.int32)
    gray = Material(np.array([200, 200, 200], np.uint8))
    kept, ids = np.unique(materials, return_inverse=True)
    return Mesh(
        vertices=points[used].astype(np.float32),
        triangles=triangles,
        normals=_normals(corners[:, :, 2], np.asarray(read.normals, np.float64), triangles, flat),
        uv=_looked_up(corners[:, :, 1], np.asarray(read.pictures, np.float32).reshape(-1, 2)),
        material_ids=ids.astype(np.int32),
        materials=tuple(library.get(read.names[i]) or gray for i in kept),
        object_ids=np.zeros(len(triangles), np.uint16),
    )


def _looked_up(indices: np.ndarray[tuple[int, ...], np.dtype[np.int64]], values: F32) -> F32:
    if not len(values):
        return np.zeros((*indices.shape, 2), np.float32)
    return np.where((indices >= 0)[..., None], values[indices], 0).astype(np.float32)


def _normals(
    indices: np.ndarray[tuple[int, ...], np.dtype[np.int64]], given: F64, triangles: I32, flat: F64
) -> F32:
    """Of each corner `(T, 3, 3)`: the file's, else the mean of its faces where they meet smoothly."""
    own = _unit(flat)
    shared = np.zeros((int(triangles.max()) + 1, 3))
    for i in range(3):
        np.add.at(shared, triangles[:, i], flat)
    smooth = _unit(shared)[triangles]
    blends = np.einsum("tij,tj->ti", smooth, own) > CREASE
    normals = np.where(blends[..., None], smooth, own[:, None, :])
    if len(given):
        named = _unit(given)[indices]
        normals = np.where(((indices >= 0) & (np.abs(named).sum(axis=2) > 0))[..., None], named, normals)
    return normals.astype(np.float32)


def _unit(vectors: F64) -> F64:
    unit: F64 = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)
    return unit


def _read_mtl(text: str, beside: Reader) -> dict[str, Material | None]:
    """Materials by name; None for one that is clear."""
    found: dict[str, dict[str, str]] = {}
    values: dict[str, str] = {}
    for line in text.split("\n"):
        word, _, rest = line.strip().partition(" ")
        if word == "newmtl":
            values = found.setdefault(rest.strip(), {})
        else:
            values[word] = rest.strip()
    return {name: _material(values, beside) for name, values in found.items()}


def _material(values: Mapping[str, str], beside: Reader) -> Material | None:
    opacity = float(values["d"].split()[-1]) if values.get("d") else 1.0
    if opacity < CLEAR:
        return None
    shade = _floats(values["Kd"], 3) if values.get("Kd") else (0.8, 0.8, 0.8)
    color = np.clip(np.asarray(shade) * 255 * opacity + GLASS * (1 - opacity), 0, 255).astype(np.uint8)
    name = _file_name(values.get("map_Kd", ""))
    content = beside(name) if name else None
    texture = _picture(content) if content else None
    if texture is None:
        return Material(color)
    return Material(texture.mean(axis=(0, 1)).astype(np.uint8), texture)


def _file_name(value: str) -> str:
    """The last part of a path, whoever's disk it was on; options before it are dropped."""
    words = value.split()
    while words and words[0].startswith("-"):
        words = words[2:]
        while words and words[0].replace(".", "").replace("-", "").isdigit():
            words = words[1:]
    return " ".join(words).replace("\\", "/").rsplit("/", 1)[-1].strip()


def _picture(content: bytes) -> U8 | None:
    """RGB, no larger than `LARGEST_TEXTURE`; where it is see-through, its mean opaque colour. None if unreadable."""
    image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    if image is None:
        return None
    if image.ndim == 2:
        image = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    colors = image[..., :3].astype(np.float64)
    if image.shape[2] == 4:
        solid = image[..., 3:] / 255.0
        mean = (colors * solid).sum(axis=(0, 1)) / max(float(solid.sum()), 1e-6)
        colors = colors * solid + mean * (1 - solid)
    scale = LARGEST_TEXTURE / max(image.shape[:2])
    if scale < 1:
        width, height = (max(1, round(side * scale)) for side in (image.shape[1], image.shape[0]))
        colors = cv2.resize(colors, (width, height), interpolation=cv2.INTER_AREA)
    texture: U8 = np.ascontiguousarray(np.clip(colors[..., ::-1], 0, 255).astype(np.uint8))
    return texture
