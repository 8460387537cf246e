"""A home as a robot's world: ways that are clear, sights that agree with the truth, several robots at once."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import pytest_asyncio

pytest.importorskip("open3d", reason="a home's world is rendered by Open3D")

from lab.simulation import HomeWorld, HomeWorldParams, SensorParams, SimulatedRobot, SimulatedRoom, World
from lab.simulation.camera import EYE_HEIGHT, pose_looking
from ovip.client import Addresses, AsyncClient
from ovip.scene.answers import Viewpoint
from ovip.scene.types import F64, Intrinsics
from ovip.store import Store
from services.perception.__main__ import serve
from services.perception.config import Settings
from tests.unit.lab.simulation.box_homes import BED, TABLE, UPPER, box_home

SMALL = Intrinsics(fx=115.0, fy=115.0, cx=79.5, cy=59.5, width=160, height=120)
EXACT = HomeWorldParams(onboard=True, frames=12)


@pytest.fixture(scope="module")
def world() -> HomeWorld:
    return HomeWorld(box_home(storeys=2), SMALL, 0, EXACT)


@pytest_asyncio.fixture
async def client(store: Store, models_dir: Path) -> AsyncIterator[AsyncClient]:
    """A client of a perception service that takes detections made on board."""
    settings = Settings(_env_file=None, models="given", models_dir=models_dir, perception_port=0)
    async with (
        serve(settings, store) as port,
        AsyncClient(Addresses(perception=f"127.0.0.1:{port}")) as client,
    ):
        yield client


def place(x: float, y: float, z: float = 0.0) -> F64:
    return np.array([x, y, z])


def test_a_room_and_a_home_are_both_worlds(world: HomeWorld) -> None:
    worlds: list[World] = [world, SimulatedRoom()]
    for one in worlds:
        sight = one.observe(one.walk()[3], 3, one.walk()[2])
        shape = (one.intrinsics.height, one.intrinsics.width)
        assert sight.rgb.shape == (*shape, 3)
        assert sight.depth.shape == sight.ids.shape == shape
        assert sight.onboard is not None


def test_a_clear_way_is_straight(world: HomeWorld) -> None:
    way = world.way(place(1.0, 1.0), place(3.0, 1.0)[None], 0.2)
    assert way is not None
    np.testing.assert_allclose(way, [[1, 1, 0], [3, 1, 0]])


def test_a_way_leads_round_what_is_in_it(world: HomeWorld) -> None:
    way = world.way(place(3.5, 2.5), place(4.6, 2.5)[None], 0.2)  # the wall is between
    assert way is not None
    np.testing.assert_allclose(way[[0, -1]], [[3.5, 2.5, 0], [4.6, 2.5, 0]])
    assert way[:, 1].min() < 1.35
    for a, b in pairwise(way):
        assert all(world.is_free(p, 0.15) for p in np.linspace(a, b, 20))


def test_there_is_no_way_into_things_or_out_of_the_house(world: HomeWorld) -> None:
    for goal in (place(2.0, 2.4), place(9.0, 0.5), place(30.0, 0.0), place(0.05, 1.0)):
        assert world.way(place(1.0, 1.0), goal[None], 0.2) is None


def test_a_way_to_the_storey_above_takes_the_stairs_and_back(world: HomeWorld) -> None:
    up = world.way(place(1.0, 1.0), place(1.0, 1.0, UPPER)[None], 0.2)
    down = world.way(place(1.0, 1.0, UPPER), place(1.0, 1.0)[None], 0.2)
    assert up is not None and down is not None
    assert (up[0, 2], up[-1, 2]) == (0, UPPER)
    assert (down[0, 2], down[-1, 2]) == (UPPER, 0)
    stair = up[np.flatnonzero(np.diff(up[:, 2]) > 0)[0]]
    assert 4.9 < stair[0] < 5.5
    assert stair[1] == pytest.approx(2.5)


def test_what_it_detects_on_board_is_what_is_in_view(world: HomeWorld) -> None:
    poses = [pose_looking((2.0, 0.8, 1.3), np.pi / 2, -0.3), pose_looking((7.0, 0.8, 1.3), 0.0, -0.3)]
    sights = [world.observe(pose, i) for i, pose in enumerate([*world.walk(), *poses])]
    for sight in sights:
        assert sight.onboard is not None
        for detection in sight.onboard:
            (object_id,) = np.unique(sight.ids[detection.mask])
            assert world.home.object_with(int(object_id)).label == detection.label
    assert {"table", "bed"} <= {d.label for sight in sights for d in sight.onboard or ()}
    assert not {"wall", "floor", "stairs"} & {d.label for sight in sights for d in sight.onboard or ()}
    assert {TABLE, BED} <= set(np.unique([sight.ids for sight in sights]).tolist())


def test_without_detections_on_board_there_are_none() -> None:
    blind = HomeWorld(box_home(), SMALL, 0, HomeWorldParams(frames=3))
    assert blind.observe(blind.walk()[0], 0).onboard is None


def test_noise_leaves_the_true_ids_and_moves_the_pose() -> None:
    noisy = HomeWorld(box_home(), SMALL, 4, HomeWorldParams(sensor=SensorParams(), frames=5))
    pose = noisy.walk()[2]
    sight, again = noisy.observe(pose, 2), noisy.observe(pose, 2)
    exact = noisy.render(pose)
    np.testing.assert_array_equal(sight.ids, exact[2])
    np.testing.assert_array_equal(sight.depth, again.depth)
    assert 0 < np.linalg.norm(sight.pose[:3, 3] - pose[:3, 3]) < 0.1
    assert (sight.depth != exact[1]).any()


def test_robots_beside_each_other_walk_differently_through_the_same_home(world: HomeWorld) -> None:
    other = world.beside(7)
    assert other.home is world.home
    assert other.seed == 7
    assert not np.allclose(other.walk()[0], world.walk()[0])
    np.testing.assert_array_equal(other.render(world.walk()[0])[1], world.render(world.walk()[0])[1])


@pytest.mark.models
async def test_several_robots_stream_into_one_scene_at_once(world: HomeWorld, client: AsyncClient) -> None:
    robots = [
        SimulatedRobot(world.beside(seed), client, "home", robot_id=f"robot-{seed}") for seed in range(3)
    ]
    reports = await asyncio.gather(*(robot.walk() for robot in robots))
    assert [report.durable for report in reports] == [12, 12, 12]
    assert (await client.perception.status("home")).frames_durable == 36
    looks = await asyncio.gather(
        *(
            robot.look(Viewpoint("v", place(x, 1.2), 1.2, "r", 1, 1, np.zeros((0, 3))))
            for robot, x in zip(robots, (0.8, 2.0, 3.2), strict=True)
        )
    )
    assert not any(look.unreachable for look in looks)
    for robot, look, x in zip(robots, looks, (0.8, 2.0, 3.2), strict=True):
        record = await client.perception.get_frame_record("home", look.frame_id)
        assert record.world_from_camera[:3, 3] == pytest.approx([x, 1.2, EYE_HEIGHT])
        assert robot.pose[:2, 3] == pytest.approx([x, 1.2])
        assert robot.travelled > 0


@pytest.mark.models
async def test_a_robot_takes_the_stairs_to_a_viewpoint_above(world: HomeWorld, client: AsyncClient) -> None:
    robot = SimulatedRobot(world, client, "home", walk=[world.walk()[0]])
    seen = await robot.look(Viewpoint("v", place(2.0, 1.0, UPPER - 0.03), 0.0, "r", 1, 1, np.zeros((0, 3))))
    assert not seen.unreachable
    assert robot.pose[2, 3] == pytest.approx(UPPER + EYE_HEIGHT)
