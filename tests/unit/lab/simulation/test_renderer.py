"""Ray-cast pictures of a home: exact where they can be worked out by hand, and one with the next."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("open3d", reason="rendering needs Open3D")

from lab.simulation import HOME_CAMERA, Renderer, RenderParams, pose_looking
from lab.simulation.home import Home, Material
from lab.simulation.shading import ShadingParams
from lab.simulation.textures import TextureAtlas
from ovip.scene.camera import backproject, project
from ovip.scene.types import Intrinsics
from tests.unit.lab.simulation.box_homes import BED, MUG, box_home

SMALL = Intrinsics(fx=115.0, fy=115.0, cx=79.5, cy=59.5, width=160, height=120)


@pytest.fixture(scope="module")
def home() -> Home:
    return box_home()


@pytest.fixture(scope="module")
def renderer(home: Home) -> Renderer:
    return Renderer(home, SMALL)


def test_depth_is_along_the_axis_not_along_the_ray(renderer: Renderer) -> None:
    seen = renderer.render(pose_looking((1.0, 0.9, 1.0), yaw=np.pi / 2, pitch=0.0))  # faces the wall y = 3
    wall = seen.ids == 3
    assert wall.sum() > 1000
    np.testing.assert_allclose(seen.depth[wall & (np.arange(160) > 40)], 2.1, atol=1e-4)


def test_the_pixel_of_a_known_point_shows_its_object_in_its_colour(renderer: Renderer) -> None:
    pose = pose_looking((2.0, 0.8, 1.3), yaw=np.pi / 2, pitch=-0.3)
    seen = renderer.render(pose)
    uv, z = project(np.array([[2.0, 2.3, 0.81]]), SMALL, pose)
    u, v = np.rint(uv[0]).astype(int)
    assert seen.ids[v, u] == MUG
    assert seen.depth[v, u] == pytest.approx(z[0], abs=0.03)
    red, green, blue = seen.rgb[v, u].astype(int)
    assert red > 3 * max(green, blue)


def test_one_frames_depth_lands_on_the_same_things_in_the_next(renderer: Renderer) -> None:
    first, second = (pose_looking((1.0 + d, 0.8, 1.3), 1.0 + d, -0.25) for d in (0.0, 0.15))
    depth, ids = renderer.depth_and_ids(first)
    next_depth, next_ids = renderer.depth_and_ids(second)
    points, index = backproject(depth, SMALL, first)
    uv, z = project(points, SMALL, second)
    u, v = uv.round().astype(int).T
    inside = (z > 0) & (u >= 0) & (u < 160) & (v >= 0) & (v < 120)
    u, v, z, here = u[inside], v[inside], z[inside], ids.ravel()[index][inside]
    visible = np.abs(next_depth[v, u] - z) < 0.03 * z
    assert visible.mean() > 0.9
    assert (next_depth[v, u] > 1.05 * z).mean() < 0.02  # nothing is seen through
    assert (next_ids[v, u][visible] == here[visible]).mean() > 0.99


def test_depth_and_ids_are_those_of_the_picture(renderer: Renderer) -> None:
    pose = pose_looking((6.0, 0.6, 1.3), yaw=0.3, pitch=-0.3)
    seen = renderer.render(pose)
    depth, ids = renderer.depth_and_ids(pose)
    np.testing.assert_array_equal(depth, seen.depth)
    np.testing.assert_array_equal(ids, seen.ids)
    assert (seen.rgb.dtype, depth.dtype, ids.dtype) == (np.uint8, np.float32, np.uint16)
    assert BED in ids


def test_every_seen_point_lies_in_the_box_of_its_object(home: Home, renderer: Renderer) -> None:
    for yaw in np.arange(0, 6, 0.8):
        pose = pose_looking((1.0, 1.2, 1.3), float(yaw), -0.3)
        depth, ids = renderer.depth_and_ids(pose)
        points, index = backproject(depth, SMALL, pose)
        for object_id in np.unique(ids[ids > 0]):
            own = points[ids.ravel()[index] == object_id]
            box = home.object_with(int(object_id)).box
            assert (own >= box[:3] - 1e-3).all()
            assert (own <= box[3:] + 1e-3).all()


def test_the_same_pose_gives_the_same_bits(home: Home, renderer: Renderer) -> None:
    pose = pose_looking((1.0, 1.0, 1.3), yaw=0.8, pitch=-0.3)
    np.testing.assert_array_equal(renderer.render(pose).rgb, Renderer(home, SMALL).render(pose).rgb)


def test_the_floor_behind_the_table_lies_in_its_shadow(home: Home) -> None:
    # the lamp hangs near (2, 1.5, 2.3): it lights the floor along y = 0, and along y = 3 all but x 1.5..2.5
    renderer = Renderer(home, SMALL, RenderParams(shading=ShadingParams(adaption=0.0)))
    lit, hidden = (_floor_brightness(renderer, y, 1.6, 2.4) for y in (0.1, 2.9))
    assert hidden < 0.75 * lit
    beside, same = (_floor_brightness(renderer, y, 3.0, 3.5) for y in (0.1, 2.9))
    assert same == pytest.approx(beside, rel=0.1)


def _floor_brightness(renderer: Renderer, y: float, x0: float, x1: float) -> float:
    """Mean brightness of the floor near the wall, seen along it."""
    pose = pose_looking((3.9, y, 1.0), yaw=np.pi, pitch=-0.5)
    seen = renderer.render(pose)
    points, index = backproject(seen.depth, SMALL, pose)
    there = (seen.ids.ravel()[index] == 1) & (points[:, 0] > x0) & (points[:, 0] < x1)
    there &= np.abs(points[:, 1] - y) < 0.05
    assert there.sum() > 10
    return float(seen.rgb.reshape(-1, 3)[index][there].mean())


def test_walls_are_darker_in_their_corners(renderer: Renderer) -> None:
    pose = pose_looking((0.7, 1.5, 0.6), yaw=np.pi / 2, pitch=-0.2)
    seen = renderer.render(pose)
    points, index = backproject(seen.depth, SMALL, pose)
    wall = (seen.ids.ravel()[index] == 3) & (np.abs(points[:, 1] - 3) < 1e-3)
    z, shade = points[wall, 2], seen.rgb.reshape(-1, 3)[index][wall].mean(axis=1)
    assert shade[z < 0.05].mean() < 0.9 * shade[(z > 0.5) & (z < 0.8)].mean()


def test_outside_there_is_sky_without_depth(renderer: Renderer) -> None:
    seen = renderer.render(pose_looking((-5.0, 1.0, 1.0), yaw=np.pi, pitch=0.2))
    assert (seen.depth == 0).all()
    assert (seen.ids == 0).all()
    assert np.ptp(seen.rgb.reshape(-1, 3), axis=0).max() == 0


def test_supersampling_smooths_edges_and_leaves_depth_and_ids(home: Home, renderer: Renderer) -> None:
    pose = pose_looking((2.0, 0.8, 1.3), yaw=np.pi / 2, pitch=-0.3)
    plain, fine = renderer.render(pose), Renderer(home, SMALL, RenderParams(supersample=2)).render(pose)
    np.testing.assert_array_equal(plain.ids, fine.ids)
    np.testing.assert_array_equal(plain.depth, fine.depth)
    assert fine.rgb.shape == plain.rgb.shape
    assert len(np.unique(fine.rgb.reshape(-1, 3), axis=0)) > len(np.unique(plain.rgb.reshape(-1, 3), axis=0))
    assert np.abs(fine.rgb.astype(int) - plain.rgb).mean() < 6


def test_a_texture_lies_upright_and_repeats() -> None:
    texture = np.zeros((4, 4, 3), dtype=np.uint8)
    texture[:2] = (250, 0, 0)  # the upper half is red
    texture[2:] = (0, 0, 250)
    atlas = TextureAtlas.of([Material(np.array([9, 9, 9], np.uint8), texture)])
    u = np.array([[0.5, 0.5, 7.5, -0.5]], dtype=np.float32)
    v = np.array([[0.75, 0.25, 3.75, -0.75]], dtype=np.float32)
    colors = atlas.colors(np.zeros((1, 4), np.int32), u, v, np.ones((1, 4), np.float32))
    np.testing.assert_array_equal(colors[0], [[250, 0, 0], [0, 0, 250], [250, 0, 0], [0, 0, 250]])


def test_a_texture_far_away_is_its_mean() -> None:
    checks = np.zeros((64, 64, 3), dtype=np.uint8)
    checks[::2, ::2] = checks[1::2, 1::2] = 200
    atlas = TextureAtlas.of([Material(np.array([9, 9, 9], np.uint8), checks)])
    u = np.linspace(0, 1, 40, dtype=np.float32)[None]
    far = atlas.colors(np.zeros((1, 40), np.int32), u, u, np.full((1, 40), 64, np.float32))
    np.testing.assert_allclose(far, 100, atol=2)


def test_the_home_camera_sees_seventy_degrees() -> None:
    assert np.degrees(2 * np.arctan(320 / HOME_CAMERA.fx)) == pytest.approx(70, abs=0.5)
