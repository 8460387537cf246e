"""Example homes: a drawn plan with y down and centimetres, as a home with z up and metres."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lab.simulation.catalogue.config import cache_folder
from lab.simulation.examples import EXAMPLES, load_example
from lab.simulation.examples_plan import Wall
from lab.simulation.examples_structure import SEAM, slab_mesh, wall_mesh
from lab.simulation.examples_words import OTHER, function_of_room, label_of_piece
from lab.simulation.home import Home, HomeObject, RelationKind, inside_polygon, polygon_area, triangle_areas
from ovip.errors import NotConfigured, NotFound
from tests.unit.lab.simulation import sweet_home_files as files

brought = pytest.mark.skipif(
    not (cache_folder() / "sweethome3d" / "examples").is_dir(),
    reason="scripts/lab.sh has not brought the homes",
)


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Home:
    monkeypatch.setenv("OVIP_LAB_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "homes"
    folder.mkdir()
    return load_example("Studio", files.write_example(folder))


def the(home: Home, label: str) -> HomeObject:
    (thing,) = (thing for thing in home.objects if thing.label == label)
    return thing


def test_rooms_are_in_metres_with_y_up_and_named_by_function(home: Home) -> None:
    unnamed, kitchen = home.areas
    assert (unnamed.function, kitchen.function) == ("unknown", "kitchen")
    assert polygon_area(kitchen.polygon) == pytest.approx(12)
    np.testing.assert_allclose(kitchen.polygon.min(axis=0), (0, -3))
    np.testing.assert_allclose(kitchen.polygon.max(axis=0), (4, 0))
    assert home.rooms == home.areas


def test_the_lowest_level_lies_at_zero_and_a_level_without_rooms_is_left_out(home: Home) -> None:
    (storey,) = home.storeys
    assert (storey.floor, storey.z, storey.ceiling_z) == (0, 0.0, 2.5)
    floors = [thing for thing in home.objects if thing.label == "floor"]
    assert max(thing.box[2] for thing in floors) == 0
    assert min(thing.box[2] for thing in floors) == pytest.approx(-SEAM)


def test_a_piece_is_turned_placed_and_sized(home: Home) -> None:
    """80 x 40 cm, turned by a quarter: 40 x 80 cm around (1, -0.5)."""
    table = the(home, "table")
    np.testing.assert_allclose(table.box, (0.8, -0.9, 0, 1.2, -0.1, 0.7), atol=1e-5)
    assert table.area_id == next(a.area_id for a in home.areas if a.function == "kitchen")
    color = home.mesh.materials[int(home.mesh.material_ids[home.mesh.object_ids == table.object_id][0])].color
    assert color.tolist() == [0x10, 0x20, 0x30]


def test_hidden_pieces_are_left_out(home: Home) -> None:
    assert [thing.label for thing in home.things].count("plant") == 1


def test_what_stands_on_a_table_is_on_it(home: Home) -> None:
    (relation,) = home.relations
    assert relation.kind is RelationKind.ON
    assert (relation.subject, relation.object) == (the(home, "plant").object_id, the(home, "table").object_id)


def test_a_piece_is_what_it_is_called_and_a_nameless_box_is_structure(home: Home) -> None:
    rug = the(home, "rug")
    assert not rug.structural
    color = home.mesh.materials[int(home.mesh.material_ids[home.mesh.object_ids == rug.object_id][0])].color
    assert color.tolist() == [255, 0, 0]
    assert the(home, OTHER).structural


def test_a_group_that_is_one_thing_is_one_object(home: Home) -> None:
    fireplace = the(home, "fireplace")
    np.testing.assert_allclose(fireplace.box[5], 1.0, atol=1e-6)
    assert fireplace.surface_area == pytest.approx(
        2 * (0.4 * 0.1 + 0.1 * 0.9 + 0.9 * 0.4) + 2 * (0.6 * 0.2 + 0.2 * 0.1 + 0.1 * 0.6), rel=1e-4
    )


def test_a_door_is_cut_out_of_its_wall_and_its_leaf_left_out(home: Home) -> None:
    wall = the(home, "wall")
    assert not any(thing.label == "door" for thing in home.objects)
    mesh = home.mesh
    own = mesh.triangles[mesh.object_ids == wall.object_id]
    middles = mesh.vertices[own].mean(axis=1)
    doorway = (np.abs(middles[:, 0] - 2) < 0.44) & (middles[:, 2] < 1.99)
    assert not doorway.any()
    np.testing.assert_allclose(wall.box, (0, -3.05, 0, 4, -2.95, 2.5), atol=1e-5)


def test_the_floor_goes_on_under_a_door(home: Home) -> None:
    mesh = home.mesh
    floors = [thing.object_id for thing in home.objects if thing.label == "floor"]
    corners = mesh.vertices[mesh.triangles[np.isin(mesh.object_ids, floors)]][..., :2].astype(np.float64)
    at = np.array([[2.0, -3.04]])
    assert any(inside_polygon(ring, at)[0] for ring in corners)


def test_every_face_is_of_an_object_and_boxes_hold_their_faces(home: Home) -> None:
    mesh = home.mesh
    assert set(np.unique(mesh.object_ids)) == {thing.object_id for thing in home.objects}
    for thing in home.objects:
        corners = mesh.vertices[mesh.triangles[mesh.object_ids == thing.object_id]].reshape(-1, 3)
        np.testing.assert_allclose(
            np.concatenate([corners.min(axis=0), corners.max(axis=0)]), thing.box, atol=1e-6
        )


def test_attribution_names_author_and_licence(home: Home) -> None:
    assert home.attributions == ("Studio by Somebody, CC-BY (Sweet Home 3D example home)",)


def test_absent_files_say_what_brings_them(tmp_path: Path) -> None:
    with pytest.raises(NotConfigured, match=r"scripts/lab\.sh"):
        load_example("Studio", tmp_path)


def test_another_name_is_not_found() -> None:
    with pytest.raises(NotFound, match="Castle"):
        load_example("Castle")


def wall_of(length: float, **changes: object) -> Wall:
    values: dict[str, object] = {
        "level": "",
        "start": np.zeros(2),
        "end": np.array([length, 0.0]),
        "thickness": 0.2,
        "heights": (2.5, 2.5),
        "sides": (None, None),
        "joined": (False, False),
    }
    return Wall(**{**values, **changes})  # type: ignore[arg-type]


def upright_area(wall: Wall, openings: list[tuple[float, float, float, float]]) -> float:
    """Of the faces that look along +y."""
    mesh = wall_mesh(wall, openings, 0.0)
    assert mesh is not None
    return float(triangle_areas(mesh)[mesh.normals[:, 0, 1] > 0.99].sum())


def test_a_wall_loses_exactly_its_openings() -> None:
    door, window = (1.0, 1.9, 0.0, 2.1), (2.5, 3.5, 0.9, 2.0)
    assert upright_area(wall_of(4.0), []) == pytest.approx(10)
    assert upright_area(wall_of(4.0), [door, window]) == pytest.approx(10 - 0.9 * 2.1 - 1.0 * 1.1)


def test_an_opening_over_the_end_of_a_wall_is_cut_there() -> None:
    assert upright_area(wall_of(4.0), [(3.5, 4.5, 0.0, 3.0)]) == pytest.approx(3.5 * 2.5)


def test_a_wall_may_slope() -> None:
    assert upright_area(wall_of(4.0, heights=(1.0, 3.0)), []) == pytest.approx(8)


def test_the_left_side_of_a_wall_has_its_own_colour() -> None:
    red, blue = np.array([255, 0, 0], np.uint8), np.array([0, 0, 255], np.uint8)
    mesh = wall_mesh(wall_of(1.0, sides=(red, blue)), [], 0.0)
    assert mesh is not None
    left = mesh.material_ids[mesh.normals[:, 0, 1] > 0.99]
    right = mesh.material_ids[mesh.normals[:, 0, 1] < -0.99]
    assert {tuple(mesh.materials[i].color) for i in left} == {(255, 0, 0)}
    assert {tuple(mesh.materials[i].color) for i in right} == {(0, 0, 255)}


def test_a_floor_is_open_where_stairs_go_through() -> None:
    room = np.array([[0, 0], [4, 0], [4, 3], [0, 3]], float)
    stair = np.array([[1, 1], [2, 1], [2, 5], [1, 5]], float)
    mesh = slab_mesh(room, 2.0, [stair], np.array([9, 9, 9], np.uint8))
    assert mesh is not None
    assert triangle_areas(mesh).sum() == pytest.approx(12 - 2)
    assert (mesh.normals[..., 2] == 1).all()


@pytest.mark.parametrize(
    ("name", "function"),
    [
        ("Bedroom #2", "bedroom"),
        ("Chambre", "bedroom"),
        ("Küche", "kitchen"),
        ("Living Room", "living room"),
        ("Salle de bain", "bathroom"),
        ("Corridor", "entryway"),
        ("Terrace", "balcony"),
        ("", "unknown"),
        ("Room 7", "unknown"),
    ],
)
def test_room_names_of_several_languages_say_a_function(name: str, function: str) -> None:
    assert function_of_room(name) == function


def test_a_box_called_mirror_is_a_mirror() -> None:
    assert label_of_piece("texturableBox", "Mirror") == "mirror"
    assert label_of_piece("cornerSofa", "Where we sit") == "sofa"
    assert label_of_piece("texturableBox", "Box") == OTHER


@brought
def test_a_real_home_is_whole() -> None:
    home = load_example("Studio")
    assert sorted(a.function for a in home.areas) == ["balcony", "bathroom", "bedroom", "entryway", "kitchen"]
    assert len(home.things) == 40
    assert all(thing.area_id for thing in home.things)
    assert {"refrigerator", "bed", "toilet", "tv"} <= {thing.label for thing in home.things}
    kitchen = next(a.area_id for a in home.areas if a.function == "kitchen")
    assert next(t for t in home.things if t.label == "refrigerator").area_id == kitchen


@brought
def test_every_real_home_is_in_its_place() -> None:
    assert {path.stem for path in (cache_folder() / "sweethome3d" / "examples").glob("*.xml")} == set(
        EXAMPLES
    )
