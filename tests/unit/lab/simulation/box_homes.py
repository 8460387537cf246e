"""A home of plain boxes whose every number can be checked by hand.

Ground floor: living room x 0..4, bedroom x 4.1..10.1, both y 0..3, with a doorway y 0.5..1.5 in the wall between. In
the living room a table with a red mug; in the bedroom a bed. With two storeys, a stair of 14 steps rises from x 5 to
8.5 along y 2..3 to z 2.8, where one room lies over both.
"""

from __future__ import annotations

import numpy as np

from lab.simulation.home import Area, Home, HomeObject, Material, Mesh, Relation, RelationKind, Storey, joined

WHITE, RED, BROWN, BLUE = (235, 235, 230), (200, 30, 30), (120, 80, 40), (40, 60, 180)
UPPER = 2.8
TABLE, MUG, BED = 5, 6, 7

Corners = tuple[float, float, float, float, float, float]


def box_mesh(corners: Corners, color: tuple[int, int, int], object_id: int) -> Mesh:
    """A box from `low` to `high` corner, its faces looking outwards."""
    low, high = np.array(corners[:3]), np.array(corners[3:])
    vertices = np.array(
        [[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i, j, k in np.ndindex(2, 2, 2)]
    )
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    p = vertices[triangles]
    normals = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(
        vertices=vertices.astype(np.float32),
        triangles=triangles,
        normals=np.repeat(normals[:, None], 3, axis=1).astype(np.float32),
        uv=np.zeros((12, 3, 2), dtype=np.float32),
        material_ids=np.zeros(12, dtype=np.int32),
        materials=(Material(np.array(color, dtype=np.uint8)),),
        object_ids=np.full(12, object_id, dtype=np.uint16),
    )


def box_home(storeys: int = 1) -> Home:
    """The home described above."""
    parts: list[tuple[int, str, Corners, tuple[int, int, int]]] = [
        (1, "floor", (-0.1, -0.1, -0.1, 10.2, 3.1, 0), BROWN),
        (3, "wall", (-0.1, -0.1, 0, 0, 3.1, 2.6), WHITE),
        (3, "wall", (10.1, -0.1, 0, 10.2, 3.1, 2.6), WHITE),
        (3, "wall", (0, -0.1, 0, 10.1, 0, 2.6), WHITE),
        (3, "wall", (0, 3, 0, 10.1, 3.1, 2.6), WHITE),
        (4, "wall", (4, 0, 0, 4.1, 0.5, 2.6), WHITE),
        (4, "wall", (4, 1.5, 0, 4.1, 3, 2.6), WHITE),
        (4, "wall", (4, 0.5, 2.0, 4.1, 1.5, 2.6), WHITE),
        (TABLE, "table", (1.5, 2.0, 0, 2.5, 2.8, 0.75), BROWN),
        (MUG, "mug", (1.95, 2.3, 0.75, 2.05, 2.4, 0.87), RED),
        (BED, "bed", (8.5, 0, 0, 10.1, 1.0, 0.5), BLUE),
    ]
    if storeys == 1:
        parts.append((2, "ceiling", (-0.1, -0.1, 2.6, 10.2, 3.1, 2.7), WHITE))
    else:
        parts += _upstairs()
    mesh = joined(box_mesh(corners, color, object_id) for object_id, _, corners, color in parts)
    return Home(
        name="boxes",
        seed=0,
        style="walled-elongated",
        mesh=mesh,
        storeys=(Storey(0, 0.0, 2.6), Storey(1, UPPER, UPPER + 2.5))[:storeys],
        rooms=tuple(_areas(storeys)),
        areas=tuple(_areas(storeys)),
        objects=tuple(_objects(parts)),
        relations=(Relation(MUG, RelationKind.ON, TABLE),),
        furniture="boxes",
        attributions=("nobody's work",),
    )


def _upstairs() -> list[tuple[int, str, Corners, tuple[int, int, int]]]:
    rise, run = UPPER / 14, 3.5 / 14
    steps: list[tuple[int, str, Corners, tuple[int, int, int]]] = [
        (8, "stairs", (5 + i * run, 2, 0, 5 + (i + 1) * run, 3, (i + 1) * rise), BROWN) for i in range(14)
    ]
    top = UPPER + 2.5
    return [
        *steps,
        (9, "floor", (-0.1, -0.1, 2.6, 10.2, 2, UPPER), BROWN),
        (9, "floor", (-0.1, 2, 2.6, 5, 3.1, UPPER), BROWN),
        (9, "floor", (8.5, 2, 2.6, 10.2, 3.1, UPPER), BROWN),
        (10, "wall", (-0.1, -0.1, UPPER, 0, 3.1, top), WHITE),
        (10, "wall", (10.1, -0.1, UPPER, 10.2, 3.1, top), WHITE),
        (10, "wall", (0, -0.1, UPPER, 10.1, 0, top), WHITE),
        (10, "wall", (0, 3, UPPER, 10.1, 3.1, top), WHITE),
        (11, "ceiling", (-0.1, -0.1, top, 10.2, 3.1, top + 0.1), WHITE),
    ]


def _areas(storeys: int) -> list[Area]:
    areas = [_area(1, 0, "living room", 0, 4), _area(2, 0, "bedroom", 4.1, 10.1)]
    return areas if storeys == 1 else [*areas, _area(3, 1, "office", 0, 10.1)]


def _area(area_id: int, floor: int, function: str, x0: float, x1: float) -> Area:
    ring = np.array([[x0, 0], [x1, 0], [x1, 3], [x0, 3]], dtype=np.float64)
    return Area(area_id, floor, function, function, ring, area_id)


def _objects(parts: list[tuple[int, str, Corners, tuple[int, int, int]]]) -> list[HomeObject]:
    objects = []
    for object_id in sorted({part[0] for part in parts}):
        own = [part for part in parts if part[0] == object_id]
        corners = np.array([part[2] for part in own])
        box = np.concatenate([corners[:, :3].min(axis=0), corners[:, 3:].max(axis=0)])
        sizes = corners[:, 3:] - corners[:, :3]
        surface = 2 * (sizes * np.roll(sizes, 1, axis=1)).sum()
        label = own[0][1]
        attributes = ("red",) if label == "mug" else ()
        area = {TABLE: 1, MUG: 1, BED: 2}.get(object_id, 0)
        structural = object_id not in (TABLE, MUG, BED)
        objects.append(HomeObject(object_id, label, attributes, structural, box, float(surface), 0, area))
    return objects
