"""What carries what, and what is next to what, as it was placed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations

import cv2
import numpy as np

from lab.simulation.furnishing.footprints import gap_between
from lab.simulation.furnishing.placing import Carrier, Placed, Stead
from lab.simulation.home import Relation, RelationKind, inside_polygon
from ovip.scene.types import F32

NEXT_TO = 0.3
"""Metres, seen from above and in height, that two things on one supporter may be apart to be next to each other."""

StructureIds = Mapping[tuple[str, int], int]
"""Object ids of a storey's structure: by label, and its room's or its wall's number."""


def relations_between(
    stead: Stead, numbers: Mapping[int, int], structure: StructureIds
) -> Iterator[Relation]:
    """All relations on a storey. numbers: object ids by `id` of the placed things.

    Being next to is said both ways.
    """
    groups: dict[int, list[Placed]] = {}
    for thing in stead.placed:
        carrier = _carrier(thing, stead, numbers, structure)
        groups.setdefault(carrier, []).append(thing)
        yield Relation(numbers[id(thing)], thing.kind, carrier)
    for things in groups.values():
        for one, other in combinations(things, 2):
            if _near(one, other):
                yield Relation(numbers[id(one)], RelationKind.NEXT, numbers[id(other)])
                yield Relation(numbers[id(other)], RelationKind.NEXT, numbers[id(one)])


def _carrier(thing: Placed, stead: Stead, numbers: Mapping[int, int], structure: StructureIds) -> int:
    if isinstance(thing.by, Placed):
        return numbers[id(thing.by)]
    if thing.by is Carrier.WALL:
        return structure["wall", thing.wall]
    point = np.array([[thing.x, thing.y]])
    room = next(i for i, room in enumerate(stead.plan.rooms) if inside_polygon(room.polygon, point)[0])
    return structure["floor" if thing.by is Carrier.FLOOR else "ceiling", room]


def _near(one: Placed, other: Placed) -> bool:
    a, b = one.footprint, other.footprint
    if (
        np.hypot(a.x - b.x, a.y - b.y)
        > NEXT_TO + np.hypot(a.width, a.depth) / 2 + np.hypot(b.width, b.depth) / 2
    ):
        return False
    apart = max(a.bottom, b.bottom) - min(a.top, b.top)
    return apart <= NEXT_TO and gap_between(a, b) <= NEXT_TO and _outline_gap(one, other) <= NEXT_TO


def _outline_gap(one: Placed, other: Placed) -> float:
    """Metres between the convex outlines of two things seen from above; 0 where they meet."""
    a, b = _outline(one), _outline(other)
    if cv2.intersectConvexConvex(a, b)[0] > 0:
        return 0.0
    return min(_to_edges(a, b), _to_edges(b, a))


def _outline(thing: Placed) -> F32:
    mesh = thing.ware.model.mesh
    corners = mesh.vertices[np.unique(mesh.triangles)]
    own = cv2.convexHull(corners[:, :2].copy())[:, 0].astype(np.float64)
    return thing.world(own).astype(np.float32)


def _to_edges(points: F32, ring: F32) -> float:
    """From the nearest of `(N, 2)` points to the edges of a ring `(M, 2)`."""
    start, along = ring, np.roll(ring, -1, axis=0) - ring
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    offset = points[:, None] - start[None]
    share = np.clip((offset * along).sum(axis=2) / length, 0, 1)
    return float(np.linalg.norm(offset - share[..., None] * along, axis=2).min())
