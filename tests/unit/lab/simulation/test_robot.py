"""The simulated robot against a real perception service."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest
import pytest_asyncio

from lab.simulation import SimulatedRobot, SimulatedRoom
from ovip.client import Addresses, AsyncClient
from ovip.scene.answers import Viewpoint
from ovip.store import Store
from services.perception.__main__ import serve
from services.perception.config import Settings

pytestmark = pytest.mark.models
ROOM = SimulatedRoom()


@pytest_asyncio.fixture
async def client(store: Store, models_dir: Path) -> AsyncIterator[AsyncClient]:
    """A client of a perception service that takes detections made on board."""
    settings = Settings(_env_file=None, models="given", models_dir=models_dir, perception_port=0)
    async with (
        serve(settings, store) as port,
        AsyncClient(Addresses(perception=f"127.0.0.1:{port}")) as client,
    ):
        yield client


async def test_the_frame_of_a_viewpoint_is_taken_there_and_that_way(client: AsyncClient) -> None:
    robot = SimulatedRobot(ROOM, client, "home")
    seen = await robot.look(viewpoint((3.1, 3.3), yaw=0.5))
    assert (seen.viewpoint_id, seen.unreachable) == ("v", False)
    record = await client.perception.get_frame_record("home", seen.frame_id)
    assert record.world_from_camera[:2, 3] == pytest.approx([3.1, 3.3])
    forward = record.world_from_camera[:3, 2]
    assert np.arctan2(forward[1], forward[0]) == pytest.approx(0.5)


async def test_what_it_detects_on_board_goes_along(client: AsyncClient) -> None:
    robot = SimulatedRobot(ROOM, client, "home")
    seen = await robot.look(viewpoint((3.1, 3.3), yaw=-0.6))  # towards the table
    found, _ = await client.perception.ground("home", [seen.frame_id], ["table"])
    assert [d.label for d in found[seen.frame_id]] == ["table"]


async def test_a_viewpoint_beyond_furniture_is_unreachable_and_nothing_is_sent(client: AsyncClient) -> None:
    robot = SimulatedRobot(ROOM, client, "home")
    await robot.look(viewpoint((3.0, 2.4), yaw=0.0))
    through_the_table = await robot.look(viewpoint((6.2, 2.4), yaw=0.0))
    on_the_bed = await robot.look(viewpoint((9.7, 3.9), yaw=0.0))
    assert through_the_table.unreachable
    assert on_the_bed.unreachable
    assert through_the_table.frame_id == ""
    assert robot.pose[:2, 3] == pytest.approx([3.0, 2.4])
    assert (await client.perception.status("home")).frames_durable == 1


async def test_the_path_of_a_viewpoint_is_driven(client: AsyncClient) -> None:
    robot = SimulatedRobot(ROOM, client, "home")
    await robot.look(viewpoint((3.0, 1.0), yaw=0.0))
    around = [(3.0, 1.0, 0.0), (6.2, 1.0, 0.0), (6.2, 2.4, 0.0)]
    before = robot.travelled
    seen = await robot.look(viewpoint((6.2, 2.4), yaw=0.0, path=around))
    assert not seen.unreachable
    assert robot.travelled - before == pytest.approx(3.2 + 1.4)


async def test_a_robot_started_again_goes_on_after_its_last_frame(client: AsyncClient) -> None:
    first = await SimulatedRobot(ROOM, client, "home").look(viewpoint((3.1, 3.3), yaw=0.0))
    again = await SimulatedRobot(ROOM, client, "home").look(viewpoint((3.1, 3.3), yaw=1.0))
    assert first.frame_id < again.frame_id
    assert (await client.perception.status("home")).frames_durable == 2


async def test_a_walk_streamed_twice_is_sent_once(
    client: AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    short = SimulatedRoom()
    monkeypatch.setattr(short, "walk", lambda: ROOM.walk()[::40])
    robot = SimulatedRobot(short, client, "home")
    assert (await robot.walk()).durable == robot.walk_length == 3
    assert (await robot.walk()).sent == 0
    assert robot.pose == pytest.approx(ROOM.walk()[80])


def viewpoint(
    place: tuple[float, float], yaw: float, path: list[tuple[float, float, float]] | None = None
) -> Viewpoint:
    """One viewpoint on the floor of the home."""
    way = np.array(path) if path else np.zeros((0, 3))
    return Viewpoint("v", np.array([*place, 0.0]), yaw, "region", 1, 1, way)
