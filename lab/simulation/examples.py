"""The nine furnished homes that come with Sweet Home 3D, as truth that nobody here drew."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from lab.simulation.catalogue.config import cache_folder
from lab.simulation.examples_models import PieceModels
from lab.simulation.examples_plan import Piece, Plan, Room, read_plan
from lab.simulation.examples_structure import (
    GROUND,
    PAINT,
    SEAM,
    footprint,
    openings_of,
    slab_mesh,
    thresholds,
    wall_mesh,
)
from lab.simulation.examples_words import OTHER, function_of_room, label_of_group, label_of_piece
from lab.simulation.home import (
    STRUCTURE,
    Area,
    Home,
    HomeObject,
    Mesh,
    Relation,
    RelationKind,
    Storey,
    inside_polygon,
    joined,
    polygon_area,
    triangle_areas,
)
from ovip.errors import NotConfigured, NotFound
from ovip.scene.types import F64

EXAMPLES: tuple[str, ...] = (
    "1BedroomApartmentWithRoundWall",
    "2BedroomApartment",
    "2BedroomApartmentWithBowWindow",
    "2BedroomHouseWithBasement",
    "3BedroomApartment",
    "3BedroomHouseWithAttic",
    "3BedroomHouseWithMezzanine",
    "4BedroomHouse",
    "Studio",
)
OPEN_LEAVES = frozenset({"door", "roundedDoor"})
"""Doors whose closed leaf is left out, so that one can pass through the home."""
REACH = 0.04
"""Metres that a thing's foot may be from the surface it stands on."""

Part = tuple[str, int, Mesh, float | None]
"""Label, floor, mesh, and the height in the world of what carries things."""


def load_example(name: str, folder: Path | None = None) -> Home:
    """One of `EXAMPLES`, from a folder with `examples/NAME.xml` and `resources`, None = where the set-up puts it.

    Lowest floor at z = 0. Walls have their openings cut; inner doors stand open (their leaf is left out); hidden
    pieces and levels without rooms (roofs) are left out; shapes that are nothing in particular are structure,
    labelled "other". A room is its own functional area, "unknown" where its name says nothing. NotFound for
    another name; NotConfigured where the files are not there.
    """
    if name not in EXAMPLES:
        raise NotFound(f"no example home {name!r}; there are {', '.join(EXAMPLES)}")
    where = cache_folder() / "sweethome3d" if folder is None else folder
    path = where / "examples" / f"{name}.xml"
    if not path.is_file():
        raise NotConfigured(f"the example homes are not in {where}; scripts/lab.sh brings them there")
    plan = _with_storeys(read_plan(path.read_text(encoding="utf-8")))
    floors = {level: floor for floor, level in enumerate(plan.levels)}
    areas = _areas(plan, floors)
    parts = [*_structure(plan, floors), *_furniture(plan, floors, PieceModels(where))]
    objects = [_object(number, part, areas) for number, part in enumerate(parts, start=1)]
    return Home(
        name=name,
        seed=0,
        style="sweet home 3d example",
        mesh=joined(_numbered(part[2], number) for number, part in enumerate(parts, start=1)),
        storeys=tuple(
            Storey(floor, level.z, level.z + level.height)
            for floor, level in zip(floors.values(), plan.levels.values(), strict=True)
        ),
        rooms=areas,
        areas=areas,
        objects=tuple(objects),
        relations=tuple(_carried(objects, [part[3] for part in parts])),
        furniture="Sweet Home 3D example home",
        attributions=(f"{name} by {plan.author}, {plan.license} (Sweet Home 3D example home)",),
    )


def _with_storeys(plan: Plan) -> Plan:
    """The plan without the levels that have no room, the lowest of the others at z = 0."""
    rooms = tuple(room for room in plan.rooms if not re.match(r"roof|toit|dach", room.name.lower()))
    used = {room.level for room in rooms if room.floor}
    kept = {key: level for key, level in plan.levels.items() if key in used}
    ground = min(level.z for level in kept.values())
    ordered = sorted(kept.items(), key=lambda item: item[1].z)
    return replace(
        plan,
        levels={key: replace(level, z=level.z - ground) for key, level in ordered},
        rooms=tuple(room for room in rooms if room.level in kept),
        walls=tuple(wall for wall in plan.walls if wall.level in kept),
        pieces=tuple(piece for piece in plan.pieces if piece.level in kept),
    )


def _areas(plan: Plan, floors: dict[str, int]) -> tuple[Area, ...]:
    """Small rooms first, so that a room drawn inside another one is found before it."""
    rooms = sorted((room for room in plan.rooms if room.floor), key=lambda room: polygon_area(room.polygon))
    rooms.sort(key=lambda room: floors[room.level])
    return tuple(
        Area(number, floors[room.level], function_of_room(room.name), room.name, room.polygon, number)
        for number, room in enumerate(rooms, start=1)
    )


def _structure(plan: Plan, floors: dict[str, int]) -> Iterator[Part]:
    openings = [piece for piece in plan.pieces if piece.opening]
    for room in plan.rooms:
        yield from _slabs(plan, room, floors[room.level])
    for wall in plan.walls:
        level = plan.levels[wall.level]
        cuts = openings_of(wall, openings)
        mesh = wall_mesh(wall, cuts, level.z)
        if mesh is not None:
            yield "wall", floors[wall.level], mesh, None
        for ring in thresholds(wall, cuts):
            slab = slab_mesh(ring, level.z - SEAM, (), GROUND)
            if slab is not None:
                yield "floor", floors[wall.level], slab, None


def _slabs(plan: Plan, room: Room, floor: int) -> Iterator[Part]:
    """Floor and ceiling of a room, open where stairs go through them."""
    level = plan.levels[room.level]
    stairs = [piece for piece in plan.pieces if piece.stairs]
    under = [p for p in stairs if _top(plan, p) > level.z - 0.3 and plan.levels[p.level].z < level.z - 0.3]
    own = [footprint(piece) for piece in stairs if piece.level == room.level]
    color = GROUND if room.color is None else room.color
    if room.floor:
        slab = slab_mesh(room.polygon, level.z, [footprint(piece) for piece in under], color)
        if slab is not None:
            yield "floor", floor, slab, None
    if room.ceiling:
        slab = slab_mesh(room.polygon, level.z + level.height, own, PAINT, upward=False)
        if slab is not None:
            yield "ceiling", floor, slab, None


def _top(plan: Plan, piece: Piece) -> float:
    return plan.levels[piece.level].z + float(piece.position[2]) + piece.size[2]


def _furniture(plan: Plan, floors: dict[str, int], models: PieceModels) -> Iterator[Part]:
    groups: dict[str, list[Piece]] = {}
    for piece in plan.pieces:
        model = Path(piece.model).stem
        z = plan.levels[piece.level].z
        whole = label_of_group(piece.group.partition("#")[0])
        if piece.opening:
            if model not in OPEN_LEAVES:
                label = "door" if "door" in model.lower() else "window"
                yield label, floors[piece.level], models.placed(piece, z), None
        elif whole is not None:
            groups.setdefault(piece.group, []).append(piece)
        else:
            label = "stairs" if piece.stairs else label_of_piece(model, piece.name)
            top = None if piece.top is None else z + float(piece.position[2]) + piece.top
            yield label, floors[piece.level], models.placed(piece, z), top
    for group, pieces in groups.items():
        mesh = joined(models.placed(piece, plan.levels[piece.level].z) for piece in pieces)
        yield label_of_group(group.partition("#")[0]) or OTHER, floors[pieces[0].level], mesh, None


def _numbered(mesh: Mesh, number: int) -> Mesh:
    return replace(mesh, object_ids=np.full(len(mesh.triangles), number, np.uint16))


def _object(number: int, part: Part, areas: tuple[Area, ...]) -> HomeObject:
    label, floor, mesh, _ = part
    box = np.concatenate([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)]).astype(np.float64)
    middle: F64 = (box[:2] + box[3:5])[None] / 2
    inside = (a.area_id for a in areas if a.floor == floor and inside_polygon(a.polygon, middle)[0])
    return HomeObject(
        object_id=number,
        label=label,
        attributes=(),
        structural=label in STRUCTURE or label == OTHER,
        box=box,
        surface_area=float(triangle_areas(mesh).sum()),
        floor=floor,
        area_id=next(inside, 0),
    )


def _carried(objects: list[HomeObject], tops: list[float | None]) -> Iterator[Relation]:
    """Which thing stands on which: its foot at the other's surface, its middle above the other."""
    for thing in objects:
        if thing.structural:
            continue
        middle = (thing.box[:2] + thing.box[3:5]) / 2
        for carrier, top in zip(objects, tops, strict=True):
            if top is None or carrier.structural or carrier is thing or abs(thing.box[2] - top) > REACH:
                continue
            if np.all((carrier.box[:2] <= middle) & (middle <= carrier.box[3:5])):
                yield Relation(thing.object_id, RelationKind.ON, carrier.object_id)
                break
