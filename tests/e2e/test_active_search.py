"""A robot in the loop: the fourth tier sends it to look, and its fresh frames decide."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lab.simulation import SimulatedRobot, SimulatedRoom
from ovip.client import Addresses, AsyncClient
from ovip.scene.answers import Answer, Observation, Outcome, Query, TierResult, Viewpoint
from tests.e2e.conftest import Cli, Stack

pytestmark = pytest.mark.models
SCENE = "home"


@pytest.fixture(scope="module")
def stack(cli: Cli, room_recording: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    """A stack that has mapped the simulated home."""
    with Stack(cli, tmp_path_factory.mktemp("search")) as running:
        cli.json("replay", room_recording, "--scene", SCENE, "--data-dir", running.data)
        yield running


@pytest.fixture
async def client(stack: Stack) -> AsyncIterator[AsyncClient]:
    async with AsyncClient(Addresses.of_stack(stack.running)) as open_client:
        yield open_client


async def search(client: AsyncClient, text: str, **limits: Any) -> tuple[str, Answer]:
    robot = SimulatedRobot(SimulatedRoom(seed=0), client, SCENE, robot_id=text.replace(" ", "-"))
    query = Query(SCENE, text, robot_pose=robot.pose, robot_radius=0.2, **limits)
    return await client.search(query, robot.look)


async def test_what_is_there_is_found_by_fresh_frames(client: AsyncClient) -> None:
    truth = next(o for o in SimulatedRoom(seed=0).objects if o.label == "refrigerator")
    _, answer = await search(client, "refrigerator", min_tier=4)
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 4)
    assert answer.object is not None
    assert answer.coverage is not None
    middle = (truth.box[:3] + truth.box[3:]) / 2
    assert np.linalg.norm(answer.object.position - middle) < 0.6
    assert [t.result for t in answer.tiers[:3]] == [TierResult.SKIPPED] * 3
    assert 0 < answer.coverage.visited < answer.coverage.planned


async def test_a_budget_that_runs_out_is_no_absence(client: AsyncClient) -> None:
    _, answer = await search(client, "blue mug", max_viewpoints=6)
    assert answer.outcome is Outcome.UNRESOLVED
    assert answer.coverage is not None
    assert answer.coverage.visited + answer.coverage.unreachable == 6
    assert not answer.coverage.complete
    assert answer.needs


async def test_a_stored_search_goes_on_after_the_robot_was_lost(client: AsyncClient) -> None:
    robot = SimulatedRobot(SimulatedRoom(seed=0), client, SCENE, robot_id="lost")
    query = Query(SCENE, "refrigerator", robot_pose=robot.pose, robot_radius=0.2, min_tier=4)

    class LostError(Exception):
        pass

    looks = 0

    async def look_twice(viewpoint: Viewpoint) -> Observation:
        nonlocal looks
        looks += 1
        if looks > 2:
            raise LostError
        return await robot.look(viewpoint)

    ids = []
    with pytest.raises(LostError):
        async for search_id, _ in client.retrieval.search(query, look_twice):  # type: ignore[arg-type]
            ids.append(search_id)
    search_id = ids[-1]
    resumed_id, answer = await client.search(f"{SCENE}/{search_id}", robot.look)
    assert resumed_id == search_id
    assert answer.outcome is Outcome.FOUND


async def test_what_is_nowhere_is_absent_once_everything_was_looked_at(client: AsyncClient) -> None:
    _, answer = await search(client, "blue mug")
    assert (answer.outcome, answer.tier) == (Outcome.ABSENT, 4)
    assert answer.object is None
    assert answer.coverage is not None
    assert answer.coverage.complete
    assert answer.coverage.visited == answer.coverage.planned
    assert 0.0 <= answer.coverage.posterior_present < 0.5
    assert min(region.seen for region in answer.coverage.regions) > 0.5
