"""Homes from a seed: a floor plan of some style, furnished by rules, with the exact truth about all of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from lab.simulation.catalogue import Catalogue, open_catalogue
from lab.simulation.furnishing import Placed, Stead, furnish, relations_between
from lab.simulation.home import (
    Area,
    Home,
    HomeObject,
    Material,
    Mesh,
    inside_polygon,
    joined,
    triangle_areas,
)
from lab.simulation.plans import STYLES, make_plan
from lab.simulation.plans.finishes import finishes
from lab.simulation.plans.structure import Structure, structure_of
from ovip.scene.types import F64

__all__ = ["STYLES", "make_home"]


def make_home(seed: int, style: str | None = None, catalogue: Catalogue | None = None) -> Home:
    """The home of a seed. style: one of `STYLES`, None = by the seed, so that six seeds in a row show all.

    The same seed and catalogue give the same bits. ValueError for an unknown style.
    """
    chosen = STYLES[seed % len(STYLES)] if style is None else style
    if chosen not in STYLES:
        raise ValueError(f"expected a style of {', '.join(STYLES)}, not {chosen!r}")
    models = open_catalogue() if catalogue is None else catalogue
    rng = np.random.default_rng([seed, STYLES.index(chosen)])
    plan = make_plan(rng, chosen)
    structure = list(structure_of(plan, finishes(rng)))
    steads = furnish(plan, models, rng)
    things = [(stead, thing) for stead in steads for thing in stead.placed]
    numbers = {id(thing): len(structure) + 1 + index for index, (_, thing) in enumerate(things)}
    meshes = [_numbered(part.mesh, index + 1) for index, part in enumerate(structure)]
    meshes += [_placed_mesh(thing, stead.plan.storey.z, numbers[id(thing)]) for stead, thing in things]
    objects = [_structural(part, mesh, plan.areas) for part, mesh in zip(structure, meshes, strict=False)]
    objects += [
        _furniture(thing, mesh, stead, numbers[id(thing)])
        for (stead, thing), mesh in zip(things, meshes[len(structure) :], strict=True)
    ]
    return Home(
        name=f"{chosen} {seed}",
        seed=seed,
        style=chosen,
        mesh=_sharing_materials(joined(meshes)),
        storeys=tuple(floor.storey for floor in plan.floors),
        rooms=plan.rooms,
        areas=plan.areas,
        objects=tuple(objects),
        relations=tuple(
            relation
            for stead in steads
            for relation in relations_between(stead, numbers, _ids(structure, stead.plan.storey.floor))
        ),
        furniture=models.source,
        attributions=tuple(sorted({thing.ware.model.attribution for _, thing in things})),
    )


def _numbered(mesh: Mesh, object_id: int) -> Mesh:
    return replace(mesh, object_ids=np.full(len(mesh.triangles), object_id, dtype=np.uint16))


def _placed_mesh(thing: Placed, floor_z: float, object_id: int) -> Mesh:
    """Its model turned and moved to where it is."""
    mesh = thing.ware.model.mesh
    c, s = np.cos(thing.yaw), np.sin(thing.yaw)
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    moved = mesh.vertices @ turn + [thing.x, thing.y, thing.z + floor_z]
    return replace(
        _numbered(mesh, object_id),
        vertices=moved.astype(np.float32),
        normals=(mesh.normals @ turn).astype(np.float32),
    )


def _structural(part: Structure, mesh: Mesh, areas: Sequence[Area]) -> HomeObject:
    number, box = int(mesh.object_ids[0]), _box(mesh)
    area = _area_of(box, [area for area in areas if area.floor == part.floor])
    return HomeObject(number, part.label, (), True, box, _surface(mesh), part.floor, area)


def _furniture(thing: Placed, mesh: Mesh, stead: Stead, object_id: int) -> HomeObject:
    box = _box(mesh)
    area = _area_of(box, stead.plan.areas)
    return HomeObject(
        object_id,
        thing.ware.label,
        thing.ware.attributes,
        False,
        box,
        _surface(mesh),
        stead.plan.storey.floor,
        area,
    )


def _box(mesh: Mesh) -> F64:
    corners = mesh.vertices[mesh.triangles].reshape(-1, 3)
    return np.concatenate([corners.min(axis=0), corners.max(axis=0)]).astype(np.float64)


def _surface(mesh: Mesh) -> float:
    return float(triangle_areas(mesh).sum())


def _area_of(box: F64, areas: Iterable[Area]) -> int:
    """The area that holds the middle of a box `(6,)`, 0 for none."""
    middle = ((box[:2] + box[3:5]) / 2)[None]
    return next((area.area_id for area in areas if inside_polygon(area.polygon, middle)[0]), 0)


def _ids(structure: Sequence[Structure], floor: int) -> dict[tuple[str, int], int]:
    """Object ids of what can carry things on a storey."""
    return {
        (part.label, part.number): index
        for index, part in enumerate(structure, start=1)
        if part.floor == floor and part.number >= 0
    }


def _sharing_materials(mesh: Mesh) -> Mesh:
    """Each material once, however many things are made of it."""
    place: dict[int, int] = {}
    kept: list[Material] = []
    for material in mesh.materials:
        if id(material) not in place:
            place[id(material)] = len(kept)
            kept.append(material)
    to = np.array([place[id(material)] for material in mesh.materials], dtype=np.int32)
    return replace(mesh, material_ids=to[mesh.material_ids], materials=tuple(kept))
