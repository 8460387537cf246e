"""A plan as solid structure: floors, ceilings, walls, doors, windows and stairs, each a mesh of its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lab.simulation.home import Material, Mesh
from lab.simulation.plans.faces import Faces, box_faces, extruded, faces_mesh
from lab.simulation.plans.finishes import Finishes
from lab.simulation.plans.plan import FloorPlan, Plan
from lab.simulation.plans.rectilinear import region
from lab.simulation.plans.walls import LEAF_GAP, LEAF_THICKNESS, Opening, OpeningKind, Wall, leaf_box
from ovip.scene.types import I32

_SLAB = 0.1  # thickness of the lowest floor and the highest ceiling, metres
_FRAME = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """One structural object of a storey. mesh: with object ids 0.

    number: of its room (floors, ceilings) or its wall (walls) on the storey, -1 for others.
    """

    label: str
    floor: int
    mesh: Mesh
    number: int = -1


def structure_of(plan: Plan, finish: Finishes) -> Iterator[Structure]:
    """All structure of a home, storey by storey."""
    for index, floor in enumerate(plan.floors):
        below = plan.floors[index - 1] if index else None
        above = plan.floors[index + 1] if index + 1 < len(plan.floors) else None
        yield from _slabs(floor, below, above, finish)
        for number, wall in enumerate(floor.walls):
            yield from _wall(wall, number, floor, finish)
        yield from _rails(floor, finish)
        yield from _flight(floor, above, finish)


def _slabs(
    floor: FloorPlan, below: FloorPlan | None, above: FloorPlan | None, finish: Finishes
) -> Iterator[Structure]:
    """Slabs between storeys meet half way, so that a stair's hole has sides."""
    z, ceiling = floor.storey.z, floor.storey.ceiling_z
    bottom = z - _SLAB if below is None else (z + below.storey.ceiling_z) / 2
    top = ceiling + _SLAB if above is None else (ceiling + above.storey.z) / 2
    for number, room in enumerate(floor.rooms):
        cells = floor.cells_of[room.room_id]
        ground = region(cells, [floor.hole] if floor.hole else [])
        faces = extruded(ground.xs, ground.ys, ground.filled, (bottom, z))
        yield Structure(
            "floor",
            floor.storey.floor,
            _mesh(faces, finish.floor(room.function, number), finish.grain),
            number,
        )
        if room.function == "balcony":
            continue
        cover = region(cells, [above.hole] if above and above.hole else [])
        faces = extruded(cover.xs, cover.ys, cover.filled, (ceiling, top))
        yield Structure("ceiling", floor.storey.floor, _mesh(faces, finish.white), number)


def _wall(wall: Wall, number: int, floor: FloorPlan, finish: Finishes) -> Iterator[Structure]:
    z = floor.storey.z
    us = np.unique([wall.low, wall.high, *(end for o in wall.openings for end in (o.low, o.high))])
    vs = np.unique([0.0, wall.height, *(end for o in wall.openings for end in (o.bottom, o.top))])
    filled = np.ones((len(us) - 1, len(vs) - 1), dtype=bool)
    for opening in wall.openings:
        i, j = (
            np.searchsorted(us, (opening.low, opening.high)),
            np.searchsorted(vs, (opening.bottom, opening.top)),
        )
        filled[i[0] : i[1], j[0] : j[1]] = False
    half = wall.thickness / 2
    axes = (0, 2, 1) if wall.axis == 0 else (1, 2, 0)
    faces = extruded(us, vs + z, filled, (wall.at - half, wall.at + half), axes)
    outside = finish.paint(7)
    paints = [finish.paint(side) if side >= 0 else outside for side in wall.sides]
    side = faces.outward[:, axes[2]]
    ids = np.select([side < 0, side > 0], [0, 1], 2).astype(np.int32)
    mesh = faces_mesh([faces], [*paints, finish.white], ids, 0)
    yield Structure("wall", floor.storey.floor, mesh, number)
    for opening in wall.openings:
        yield from _filling(wall, opening, floor, finish)


def _filling(wall: Wall, opening: Opening, floor: FloorPlan, finish: Finishes) -> Iterator[Structure]:
    z, number = floor.storey.z, floor.storey.floor
    if opening.kind is OpeningKind.WINDOW:
        yield Structure("window", number, _window(wall, opening, z, finish))
    elif opening.kind is OpeningKind.ENTRANCE:
        x0, y0, x1, y1 = wall.rect_between(
            opening.low + LEAF_GAP, opening.high - LEAF_GAP, LEAF_THICKNESS / 2
        )
        leaf = box_faces((x0, y0, z + LEAF_GAP), (x1, y1, z + opening.top - LEAF_GAP))
        yield Structure("door", number, _with_handles(leaf, wall.axis, z, finish))
    elif opening.leaf_side:
        x0, y0, x1, y1 = leaf_box(wall, opening)
        leaf = box_faces((x0, y0, z + 2 * LEAF_GAP), (x1, y1, z + opening.top - 2 * LEAF_GAP))
        yield Structure("door", number, _mesh(leaf, finish.leaf))


def _with_handles(leaf: Faces, axis: int, z: float, finish: Finishes) -> Mesh:
    """A closed leaf with a bar on both sides at handle height."""
    corners = leaf.corners.reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    across = 1 - axis
    a, b = low.copy(), high.copy()
    a[axis], b[axis] = high[axis] - 0.18, high[axis] - 0.06
    a[2], b[2] = z + 1.0, z + 1.02
    a[across], b[across] = low[across] - 0.04, high[across] + 0.04
    faces = [leaf, box_faces(a, b)]
    ids = np.repeat([0, 1], [len(part.corners) for part in faces]).astype(np.int32)
    return faces_mesh(faces, [finish.leaf, finish.white], ids, 0)


def _window(wall: Wall, opening: Opening, z: float, finish: Finishes) -> Mesh:
    """A frame with a post in its middle, and panes."""
    low, high, bottom, top = opening.low, opening.high, z + opening.bottom, z + opening.top
    middle = (low + high) / 2

    def box(u0: float, u1: float, v0: float, v1: float, reach: float) -> Faces:
        x0, y0, x1, y1 = wall.rect_between(u0, u1, reach)
        return box_faces((x0, y0, v0), (x1, y1, v1))

    frame = [
        box(low, low + _FRAME, bottom, top, 0.03),
        box(high - _FRAME, high, bottom, top, 0.03),
        box(low + _FRAME, high - _FRAME, bottom, bottom + _FRAME, 0.03),
        box(low + _FRAME, high - _FRAME, top - _FRAME, top, 0.03),
        box(middle - _FRAME / 2, middle + _FRAME / 2, bottom + _FRAME, top - _FRAME, 0.03),
    ]
    pane = box(low + _FRAME, high - _FRAME, bottom + _FRAME, top - _FRAME, 0.008)
    faces = [*frame, pane]
    ids = np.repeat([0, 0, 0, 0, 0, 1], [len(part.corners) for part in faces]).astype(np.int32)
    return faces_mesh(faces, [finish.white, finish.glass], ids, 0)


def _rails(floor: FloorPlan, finish: Finishes) -> Iterator[Structure]:
    z = floor.storey.z
    for x0, y0, x1, y1 in floor.rails:
        faces = box_faces((x0, y0, z), (x1, y1, z + floor.parapet))
        yield Structure("wall", floor.storey.floor, _mesh(faces, finish.white))


def _flight(floor: FloorPlan, above: FloorPlan | None, finish: Finishes) -> Iterator[Structure]:
    """Solid steps, the last one lower than the floor above by a step."""
    if floor.flight is None or above is None:
        return
    x0, y0, x1, y1 = floor.flight.rect
    axis = 0 if floor.flight.up[0] else 1
    low, high = (x0, x1) if axis == 0 else (y0, y1)
    count = round((high - low) / 0.25)
    places = np.linspace(low, high, count + 1)
    heights = floor.storey.z + (above.storey.z - floor.storey.z) * np.arange(count + 1) / (count + 1)
    filled = np.tri(count, dtype=bool)
    if floor.flight.up[axis] < 0:
        filled = filled[::-1]
    across = (y0, y1) if axis == 0 else (x0, x1)
    axes = (0, 2, 1) if axis == 0 else (1, 2, 0)
    faces = extruded(places, heights, filled, across, axes)
    yield Structure("stairs", floor.storey.floor, _mesh(faces, finish.wood, finish.grain))


def _mesh(faces: Faces, material: Material, grain: float = 1.0) -> Mesh:
    ids: I32 = np.zeros(len(faces.corners), dtype=np.int32)
    return faces_mesh([faces], [material], ids, 0, grain)
