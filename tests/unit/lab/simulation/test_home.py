"""A home's truth: points spread over faces, areas found by place, meshes joined."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.simulation.home import (
    Area,
    Home,
    HomeObject,
    Material,
    Mesh,
    Storey,
    inside_polygon,
    joined,
    polygon_area,
    surface_points,
    triangle_areas,
)

L_SHAPE = np.array([[0.0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
GREY = Material(np.array([128, 128, 128], np.uint8))


def plate(side: float, object_id: int, z: float = 0.0) -> Mesh:
    """A horizontal square of two triangles."""
    corners = np.array([[0, 0, z], [side, 0, z], [side, side, z], [0, side, z]], np.float32)
    return Mesh(
        vertices=corners,
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        normals=np.tile(np.array([0, 0, 1], np.float32), (2, 3, 1)),
        uv=np.zeros((2, 3, 2), np.float32),
        material_ids=np.zeros(2, np.int32),
        materials=(GREY,),
        object_ids=np.full(2, object_id, np.uint16),
    )


def thing(object_id: int, label: str, structural: bool = False) -> HomeObject:
    return HomeObject(object_id, label, (), structural, np.zeros(6), 1.0, 0, 1)


def test_polygons_by_hand() -> None:
    """4 x 1 and 1 x 2: six square metres; the notch is outside."""
    assert polygon_area(L_SHAPE) == pytest.approx(6.0)
    points = np.array([[0.5, 2.5], [3.5, 0.5], [2.0, 2.0], [-0.1, 0.5], [0.5, 0.5]])
    assert inside_polygon(L_SHAPE, points).tolist() == [True, True, False, False, True]


@given(st.integers(0, 5))
def test_a_polygon_holds_the_same_points_from_whichever_corner_it_starts(start: int) -> None:
    points = np.random.default_rng(3).uniform(-1, 5, (200, 2))

    turned = np.roll(L_SHAPE, start, axis=0)

    assert inside_polygon(turned, points).tolist() == inside_polygon(L_SHAPE, points).tolist()
    assert inside_polygon(turned[::-1], points).tolist() == inside_polygon(L_SHAPE, points).tolist()


def test_points_are_as_dense_on_a_large_face_as_on_a_small_one() -> None:
    """3 x 3 m and 1 x 1 m at 0.05 m: 3,600 and 400 points."""
    mesh = joined([plate(3.0, 7), plate(1.0, 9, z=1.0)])

    points, ids = surface_points(mesh, 0.05)

    assert (ids == 7).sum() == pytest.approx(3600, abs=2)
    assert (ids == 9).sum() == pytest.approx(400, abs=2)
    assert (points[ids == 9][:, 2] == 1.0).all()
    assert (points[ids == 9][:, :2].min() >= 0) and (points[ids == 9][:, :2].max() <= 1)


def test_a_thing_smaller_than_the_spacing_still_has_a_point() -> None:
    _, ids = surface_points(joined([plate(3.0, 7), plate(0.01, 9)]), 0.5)

    assert (ids == 9).sum() == 1


def test_the_same_mesh_gives_the_same_points() -> None:
    mesh = joined([plate(3.0, 7), plate(1.0, 9)])

    np.testing.assert_array_equal(surface_points(mesh, 0.1)[0], surface_points(mesh, 0.1)[0])
    assert (surface_points(mesh, 0.1, seed=1)[0] != surface_points(mesh, 0.1)[0]).any()


def test_joined_meshes_keep_their_faces_and_materials() -> None:
    red = Material(np.array([255, 0, 0], np.uint8))
    one, other = plate(2.0, 1), plate(1.0, 2, z=0.5)
    both = joined([one, Mesh(*(getattr(other, name) for name in MESH_FIELDS[:5]), (red,), other.object_ids)])

    assert triangle_areas(both) == pytest.approx([2, 2, 0.5, 0.5])
    assert both.material_ids.tolist() == [0, 0, 1, 1]
    assert both.materials[1] is red
    assert both.vertices[both.triangles[2:]][..., 2].min() == 0.5


MESH_FIELDS = ("vertices", "triangles", "normals", "uv", "material_ids", "materials", "object_ids")


def test_a_home_finds_its_objects_and_areas() -> None:
    kitchen = Area(1, 0, "kitchen", "kitchen", L_SHAPE, 1)
    home = Home(
        "h", 0, "test", plate(1, 1), (Storey(0, 0.0, 2.6),), (kitchen,), (kitchen,),
        (thing(1, "floor", structural=True), thing(5, "mug")),
    )  # fmt: skip

    assert home.object_with(5).label == "mug"
    assert [t.label for t in home.things] == ["mug"]
    assert home.area_at(0, np.array([0.5, 0.5])) is kitchen
    assert home.area_at(0, np.array([3.0, 3.0])) is None
    assert home.area_at(1, np.array([0.5, 0.5])) is None
