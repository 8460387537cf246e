"""Generated homes: their truth agrees with their mesh, nothing floats, nothing meets, and a robot gets everywhere."""

from __future__ import annotations

import hashlib
from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.simulation.catalogue import Catalogue, open_catalogue
from lab.simulation.generate import STYLES, make_home
from lab.simulation.home import (
    STRUCTURE,
    Home,
    HomeObject,
    Mesh,
    RelationKind,
    inside_polygon,
    polygon_area,
    surface_points,
    triangle_areas,
)
from ovip.scene.types import F32, Bools

CONTACT = 0.01  # metres that a thing may sink into what carries it, or a leg into a rug
SMALL = 0.35


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    return open_catalogue(Path("no furniture here"))


@pytest.fixture(scope="module")
def homes(catalogue: Catalogue) -> list[Home]:
    return [make_home(seed, catalogue=catalogue) for seed in range(6)]


def test_six_seeds_in_a_row_show_every_style(homes: list[Home]) -> None:
    assert {home.style for home in homes} == set(STYLES)
    assert [len(home.storeys) for home in homes] == [2 if "two" in home.style else 1 for home in homes]


def test_homes_hold_sixty_to_four_hundred_things_and_many_are_small(homes: list[Home]) -> None:
    for home in homes:
        sides = np.array([np.ptp(thing.box.reshape(2, 3), axis=0).max() for thing in home.things])
        assert 60 <= len(sides) <= 400
        assert (sides < SMALL).mean() >= 0.4
        assert 4 <= len(home.areas) <= 12


def test_ids_are_counted_from_one_and_every_face_has_one(homes: list[Home]) -> None:
    for home in homes:
        ids = [thing.object_id for thing in home.objects]
        assert ids == list(range(1, len(ids) + 1))
        assert home.mesh.object_ids.dtype == np.uint16
        assert set(np.unique(home.mesh.object_ids).tolist()) == set(ids)
        assert all(thing.structural == (thing.label in STRUCTURE) for thing in home.objects)


def test_boxes_and_surfaces_are_those_of_the_mesh(homes: list[Home]) -> None:
    for home in homes:
        areas = np.bincount(home.mesh.object_ids, triangle_areas(home.mesh))
        for thing in home.objects:
            points = _points_of(home, thing)
            assert np.array_equal(thing.box, np.concatenate([points.min(axis=0), points.max(axis=0)]))
            assert thing.surface_area == pytest.approx(areas[thing.object_id], rel=1e-6)


def test_normals_are_unit_and_indices_valid(homes: list[Home]) -> None:
    for home in homes:
        mesh = home.mesh
        assert np.allclose(np.linalg.norm(mesh.normals, axis=2), 1, atol=1e-3)
        assert mesh.triangles.min() >= 0 and mesh.triangles.max() < len(mesh.vertices)
        assert mesh.material_ids.max() < len(mesh.materials)
        assert mesh.uv.shape == (len(mesh.triangles), 3, 2)
        assert len(mesh.triangles) < 1_200_000


def test_a_material_is_held_once(homes: list[Home]) -> None:
    for home in homes:
        assert len({id(material) for material in home.mesh.materials}) == len(home.mesh.materials)


def test_things_are_in_the_area_that_holds_their_middle(homes: list[Home]) -> None:
    for home in homes:
        for thing in home.things:
            area = home.area_at(thing.floor, (thing.box[:2] + thing.box[3:5]) / 2)
            assert area is not None and area.area_id == thing.area_id


def test_areas_sum_to_their_rooms(homes: list[Home]) -> None:
    for home in homes:
        for room in home.rooms:
            own = [polygon_area(area.polygon) for area in home.areas if area.room_id == room.room_id]
            assert sum(own) == pytest.approx(polygon_area(room.polygon), abs=1e-9)


def test_each_thing_is_carried_by_just_one_other(homes: list[Home]) -> None:
    for home in homes:
        carried = Counter(r.subject for r in home.relations if r.kind is not RelationKind.NEXT)
        assert carried == Counter(thing.object_id for thing in home.things)


def test_nothing_floats(homes: list[Home]) -> None:
    for home in homes:
        points, ids = surface_points(_of_carrying_things(home), 0.012)
        order = np.argsort(ids, kind="stable")
        starts = np.searchsorted(ids[order], np.arange(len(home.objects) + 2))
        for relation in home.relations:
            thing, other = home.object_with(relation.subject), home.object_with(relation.object)
            if relation.kind is RelationKind.ATTACHED:
                apart = np.maximum(other.box[:3] - thing.box[3:], thing.box[:3] - other.box[3:]).max()
                assert apart < 1e-3, (home.name, thing.label, other.label)
            elif relation.kind is RelationKind.NEXT:
                continue
            elif other.label == "floor":
                assert thing.box[2] == pytest.approx(other.box[5], abs=1e-3)
            else:
                own = points[order[starts[relation.object] : starts[relation.object + 1]]]
                foot = _highest_below(thing, own)
                assert abs(thing.box[2] - foot) < CONTACT, (home.name, thing.label, other.label)


def test_no_two_things_meet(homes: list[Home]) -> None:
    for home in homes:
        carrier = {r.subject: r.object for r in home.relations if r.kind is not RelationKind.NEXT}
        hulls = {thing.object_id: _hull(_points_of(home, thing)) for thing in home.objects}
        boxes = np.array([thing.box for thing in home.objects])
        for thing in home.things:
            shared = np.minimum(thing.box[3:], boxes[:, 3:]) - np.maximum(thing.box[:3], boxes[:, :3])
            for index in np.flatnonzero((shared > [1e-3, 1e-3, CONTACT + 1e-4]).all(axis=1)):
                other = home.objects[index]
                one, two = thing.object_id, other.object_id
                if one == two or carrier.get(one) == two or carrier.get(two) == one:
                    continue
                if other.label == "wall" and _in_its_openings(home, thing, other):
                    continue
                area, _ = cv2.intersectConvexConvex(hulls[one], hulls[two])
                assert area < 1e-4, (home.name, thing.label, other.label)


def test_next_to_is_near_and_said_both_ways_and_on_the_same_carrier(homes: list[Home]) -> None:
    for home in homes:
        carrier = {r.subject: r.object for r in home.relations if r.kind is not RelationKind.NEXT}
        next_to = {(r.subject, r.object) for r in home.relations if r.kind is RelationKind.NEXT}
        assert next_to
        for one, other in next_to:
            a, b = home.object_with(one).box, home.object_with(other).box
            apart = np.maximum(np.maximum(a[:2] - b[3:5], b[:2] - a[3:5]), 0)
            assert np.linalg.norm(apart) <= 0.3 + 1e-3
            assert carrier[one] == carrier[other]
            assert (other, one) in next_to


def test_a_robot_reaches_every_room_of_a_storey(homes: list[Home]) -> None:
    for home in homes:
        for storey in home.storeys:
            open_, cell = _open_floor(home, storey.floor)
            count, pieces = cv2.connectedComponents(open_.astype(np.uint8), connectivity=4)
            assert count > 1
            main = 1 + int(np.bincount(pieces.ravel())[1:].argmax())
            for room in (room for room in home.rooms if room.floor == storey.floor):
                centres = cell[pieces == main]
                assert inside_polygon(room.polygon, centres).sum() * 0.05**2 > 0.3, (home.name, room.name)


def test_alike_things_differ_by_an_attribute(homes: list[Home]) -> None:
    for home in homes:
        looks: dict[tuple[str, int], list[tuple[str, ...]]] = {}
        for thing in home.things:
            if thing.attributes:
                looks.setdefault((thing.label, thing.area_id), []).append(thing.attributes)
        pairs = [label for (label, _), seen in looks.items() if len(set(seen)) > 1]
        assert len(set(pairs)) >= 3


def test_every_kind_of_relation_and_the_attached_and_small_things_occur(homes: list[Home]) -> None:
    kinds = Counter(relation.kind for home in homes for relation in home.relations)
    assert set(kinds) == set(RelationKind)
    labels = Counter(thing.label for home in homes for thing in home.things)
    wanted = """mug, bottle, book, remote control, vase, cushion, switch, wall plug, picture frame, towel, pot,
        knife block, clock, plate, laptop, lamp, plant, pillow, towel rack, mirror, smoke detector, rug"""
    assert not [label for word in wanted.split(",") if not labels[label := word.strip()]]


def test_switches_plugs_and_pictures_hang_at_their_heights(homes: list[Home]) -> None:
    for home in homes:
        for thing in home.things:
            z = home.storeys[thing.floor].z
            if thing.label == "switch":
                assert thing.box[2] - z == pytest.approx(1.1, abs=1e-3)
            if thing.label == "wall plug":
                assert thing.box[2] - z == pytest.approx(0.3, abs=1e-3)
            if thing.label == "smoke detector":
                assert thing.box[5] == pytest.approx(home.storeys[thing.floor].ceiling_z, abs=1e-3)


def test_the_same_seed_gives_the_same_bits_from_a_fresh_catalogue(homes: list[Home]) -> None:
    again = make_home(1, catalogue=open_catalogue(Path("no furniture here")))
    assert _hash(again.mesh) == _hash(homes[1].mesh)
    assert again.relations == homes[1].relations
    assert [thing.label for thing in again.objects] == [thing.label for thing in homes[1].objects]


def test_other_seeds_and_styles_give_other_homes(homes: list[Home], catalogue: Catalogue) -> None:
    other = make_home(7, catalogue=catalogue)
    assert other.style == homes[1].style
    assert _hash(other.mesh) != _hash(homes[1].mesh)
    assert make_home(1, "open-compact", catalogue).style == "open-compact"


def test_an_unknown_style_is_refused_with_those_that_are(catalogue: Catalogue) -> None:
    with pytest.raises(ValueError, match="walled-compact"):
        make_home(0, "castle", catalogue)


def _hash(mesh: Mesh) -> str:
    parts = (mesh.vertices, mesh.triangles, mesh.normals, mesh.uv, mesh.material_ids, mesh.object_ids)
    return hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest()


def _points_of(home: Home, thing: HomeObject) -> F32:
    return home.mesh.vertices[np.unique(home.mesh.triangles[home.mesh.object_ids == thing.object_id])]


def _hull(points: F32) -> F32:
    return np.asarray(cv2.convexHull(points[:, :2].copy())[:, 0], np.float32)


def _of_carrying_things(home: Home) -> Mesh:
    """The faces of all things that other things are on or in."""
    carriers = [r.object for r in home.relations if r.kind in (RelationKind.ON, RelationKind.IN)]
    structure = [thing.object_id for thing in home.objects if thing.structural]
    own = np.isin(home.mesh.object_ids, np.setdiff1d(carriers, structure))
    mesh = home.mesh
    return Mesh(
        mesh.vertices,
        mesh.triangles[own],
        mesh.normals[own],
        mesh.uv[own],
        mesh.material_ids[own],
        mesh.materials,
        mesh.object_ids[own],
    )


def _highest_below(thing: HomeObject, points: F32) -> float:
    """The highest of a carrier's points under the thing's box, give or take what counts as contact."""
    under = ((points[:, :2] > thing.box[:2]) & (points[:, :2] < thing.box[3:5])).all(axis=1)
    under &= points[:, 2] < thing.box[2] + CONTACT
    return float(points[under, 2].max(initial=-np.inf))


def _in_its_openings(home: Home, thing: HomeObject, wall: HomeObject) -> bool:
    """Whether none of the wall's own points are inside the thing's box."""
    points = _points_of(home, wall)
    return not ((points > thing.box[:3] + 1e-3) & (points < thing.box[3:] - 1e-3)).all(axis=1).any()


def _open_floor(home: Home, floor: int) -> tuple[Bools, F32]:
    """Where a robot of radius 0.2 m can stand on a 0.05 m grid, read off the mesh; and the cells' middles."""
    rings = np.concatenate([room.polygon for room in home.rooms if room.floor == floor])
    low, step = rings.min(axis=0) - 0.5, 0.05
    shape = np.ceil((rings.max(axis=0) + 0.5 - low) / step).astype(int)
    grid = np.zeros(shape[::-1], np.uint8)

    def cells(points: F32) -> np.ndarray[tuple[int, ...], np.dtype[np.int32]]:
        return np.round((points - low) / step - 0.5).astype(np.int32)

    z = home.storeys[floor].z
    for thing in home.objects:
        if thing.floor == floor and thing.label == "floor":
            x0, y0, x1, y1 = thing.box[[0, 1, 3, 4]]
            cv2.rectangle(grid, *(tuple(map(int, cells(np.array(p)))) for p in ((x0, y0), (x1, y1))), 1, -1)
    vertices, triangles = home.mesh.vertices, home.mesh.triangles
    corner = vertices[triangles]
    floor_of = np.array([0, *(thing.floor for thing in home.objects)])
    near = (corner[:, :, 2].min(axis=1) < z + 1.4) & (corner[:, :, 2].max(axis=1) > z + 0.03)
    for triangle in corner[near & (floor_of[home.mesh.object_ids] == floor)]:
        cv2.fillConvexPoly(grid, cells(triangle[:, :2]), 0)
    if floor:
        stairs = next(thing for thing in home.objects if thing.label == "stairs")
        x0, y0, x1, y1 = stairs.box[[0, 1, 3, 4]]
        cv2.rectangle(grid, *(tuple(map(int, cells(np.array(p)))) for p in ((x0, y0), (x1, y1))), 0, -1)
    clear = cv2.distanceTransform(grid, cv2.DIST_L2, 5) * step
    rows, columns = np.indices(grid.shape)
    return clear > 0.2, np.stack([columns, rows], axis=-1).astype(np.float32) * step + (low + step / 2)
