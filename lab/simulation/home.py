"""A home as exact truth: its mesh with an object id per face, its objects, their relations, rooms and areas.

World: z up, metres, the ground floor's surface at z = 0. Whoever makes a home (generated, a Sweet Home 3D
example, the small house) returns this value; renderer, robot and protocols know nothing else of it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from ovip.scene.types import F32, F64, I32, U8, U16, Bools

STRUCTURE = frozenset({"floor", "wall", "ceiling", "door", "window", "stairs"})
"""Labels that are no instances to any protocol."""


class RelationKind(StrEnum):
    """How one object is placed with regard to another; the first three say what carries it."""

    ON = "on"
    IN = "in"
    ATTACHED = "attached to"
    NEXT = "next to"


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """color: `(3,)` uint8 RGB, what an untextured face shows. texture: `(H, W, 3)` uint8 RGB, None for none."""

    color: U8
    texture: U8 | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles of everything in a home, or of one model.

    vertices: `(V, 3)` float32 metres. triangles: `(T, 3)` int32 rows of `vertices`. normals: `(T, 3, 3)`
    float32, unit, at each triangle's corners. uv: `(T, 3, 2)` float32, v up, repeating outside 0..1.
    material_ids: `(T,)` int32 into `materials`. object_ids: `(T,)` uint16, 0 = of no object.
    """

    vertices: F32
    triangles: I32
    normals: F32
    uv: F32
    material_ids: I32
    materials: tuple[Material, ...]
    object_ids: U16


@dataclass(frozen=True, slots=True)
class Storey:
    """One floor of a home, counted from 0; heights in metres."""

    floor: int
    z: float
    ceiling_z: float


@dataclass(frozen=True, slots=True, eq=False)
class Area:
    """A piece of a storey. polygon: `(N, 2)` world metres, open ring, no holes.

    function: one of the words that regions gives (kitchen, dining area, living room, ...). room_id: the walled
    room that a functional area is part of; a room's own is itself.
    """

    area_id: int
    floor: int
    function: str
    name: str
    polygon: F64
    room_id: int


@dataclass(frozen=True, slots=True, eq=False)
class HomeObject:
    """One thing. object_id: from 1, as in rendered ids. label: its class, a normalised word.

    attributes: words that tell it from its like ("red", "floral"). box: `(6,)` low, high corner, metres.
    surface_area: square metres of its faces. area_id: the functional area it is in, 0 = none.
    """

    object_id: int
    label: str
    attributes: tuple[str, ...]
    structural: bool
    box: F64
    surface_area: float
    floor: int
    area_id: int


@dataclass(frozen=True, slots=True)
class Relation:
    """`subject` is `kind` `object` (object ids): the mug (subject) is on the table (object)."""

    subject: int
    kind: RelationKind
    object: int


@dataclass(frozen=True, slots=True, eq=False)
class Home:
    """A home and the truth about it.

    rooms: walled spaces. areas: functional areas; together they tile the rooms' floor. furniture: where its
    models come from, in a few words. attributions: who made what, under which licence, a line each.
    """

    name: str
    seed: int
    style: str
    mesh: Mesh
    storeys: tuple[Storey, ...]
    rooms: tuple[Area, ...]
    areas: tuple[Area, ...]
    objects: tuple[HomeObject, ...]
    relations: tuple[Relation, ...] = ()
    furniture: str = ""
    attributions: tuple[str, ...] = ()
    _by_id: dict[int, HomeObject] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_by_id", {thing.object_id: thing for thing in self.objects})

    @property
    def things(self) -> tuple[HomeObject, ...]:
        """The objects that are not structure."""
        return tuple(thing for thing in self.objects if not thing.structural)

    def object_with(self, object_id: int) -> HomeObject:
        """The object with this id, as in rendered ids. KeyError for none."""
        return self._by_id[object_id]

    def area_at(self, floor: int, xy: F64) -> Area | None:
        """The functional area of a storey that holds a floor point `(2,)`; the first one on a border."""
        point = np.asarray(xy, np.float64).reshape(1, 2)
        return next((a for a in self.areas if a.floor == floor and inside_polygon(a.polygon, point)[0]), None)


def inside_polygon(polygon: F64, points: F64) -> Bools:
    """Which of `(N, 2)` points lie in an open ring `(M, 2)` -> `(N,)`; even-odd rule."""
    x, y = points[:, 0], points[:, 1]
    inside = np.zeros(len(points), dtype=bool)
    ahead = np.roll(polygon, -1, axis=0)
    for (x0, y0), (x1, y1) in zip(polygon, ahead, strict=True):
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        inside ^= crosses & (x < (x1 - x0) * (y - y0) / (y1 - y0) + x0)
    return inside


def polygon_area(polygon: F64) -> float:
    """Square metres of an open ring `(M, 2)`."""
    x, y = polygon[:, 0], polygon[:, 1]
    return float(abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2)


def triangle_areas(mesh: Mesh) -> F64:
    """Square metres of each triangle -> `(T,)`."""
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas: F64 = np.linalg.norm(cross, axis=1) / 2
    return areas


def surface_points(mesh: Mesh, spacing: float, seed: int = 0) -> tuple[F32, U16]:
    """Points `(P, 3)` spread evenly over all faces, one per `spacing`² square metres, and their object ids `(P,)`.

    Stratified by face area in the order of the faces, so equal meshes give equal points; each face of an object
    whose whole surface is under `spacing`² still gives the object one point.
    """
    areas = triangle_areas(mesh)
    rng = np.random.default_rng(seed)
    total = np.cumsum(areas)
    count = int(np.ceil(total[-1] / spacing**2)) if len(total) else 0
    at = (np.arange(count) + rng.random(count)) * (total[-1] / max(count, 1)) if count else np.zeros(0)
    chosen = np.minimum(np.searchsorted(total, at, side="right"), len(areas) - 1)
    missed = np.setdiff1d(np.unique(mesh.object_ids), np.unique(mesh.object_ids[chosen]))
    first = [int(np.flatnonzero(mesh.object_ids == object_id)[0]) for object_id in missed]
    chosen = np.concatenate([chosen, np.asarray(first, dtype=chosen.dtype)])
    u, v = rng.random((2, len(chosen)))
    flip = u + v > 1
    u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles[chosen]].astype(np.float64), 1, 0)
    points = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    return points.astype(np.float32), mesh.object_ids[chosen]


def joined(parts: Iterable[Mesh]) -> Mesh:
    """Several meshes as one; materials are kept apart."""
    meshes = list(parts)
    vertex_at = np.cumsum([0, *(len(m.vertices) for m in meshes)])
    material_at = np.cumsum([0, *(len(m.materials) for m in meshes)])
    return Mesh(
        vertices=np.concatenate([m.vertices for m in meshes]),
        triangles=np.concatenate([m.triangles + vertex_at[i] for i, m in enumerate(meshes)]).astype(np.int32),
        normals=np.concatenate([m.normals for m in meshes]),
        uv=np.concatenate([m.uv for m in meshes]),
        material_ids=np.concatenate([m.material_ids + material_at[i] for i, m in enumerate(meshes)]).astype(
            np.int32
        ),
        materials=tuple(material for m in meshes for material in m.materials),
        object_ids=np.concatenate([m.object_ids for m in meshes]),
    )
