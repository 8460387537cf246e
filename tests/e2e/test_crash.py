"""kill -9 of the whole stack in mid-replay loses nothing and changes nothing."""

from __future__ import annotations

import asyncio
import json
import time
from pathlib import Path
from typing import Any

import pytest

from ovip.client import Addresses, AsyncClient
from tests.e2e.conftest import Cli, Stack

pytestmark = pytest.mark.models


def replay(recording: Path, layout: str, stride: int) -> tuple[str | Path, ...]:
    return ("replay", recording, "--layout", layout, "--scene", "place", "--stride", str(stride))


@pytest.fixture(scope="module")
def whole_room(cli: Cli, room_recording: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """What the simulated home's replay ends in when nobody disturbs it."""
    return uninterrupted(cli, tmp_path_factory.mktemp("whole"), replay(room_recording, "ovip", 1))


def uninterrupted(cli: Cli, data: Path, words: tuple[str | Path, ...]) -> Any:
    return cli.json(*words, "--standalone", "--data-dir", data, timeout=500)


def test_a_replay_killed_twice_midway_ends_in_the_same_map(
    cli: Cli, room_recording: Path, whole_room: Any, tmp_path: Path
) -> None:
    words, expected = replay(room_recording, "ovip", 1), whole_room
    data = tmp_path / "killed"
    for nth in range(2):
        stack = Stack(cli, data)
        replaying = cli.start(*words, "--data-dir", data, "--json")
        wait_for_progress(stack, frames=8 * (nth + 1))
        stack.kill_nine()
        replaying.kill()
        replaying.communicate()
    resumed = uninterrupted(cli, data, words)
    assert resumed["resumed_after"] > 0
    assert resumed["sent"] < expected["sent"]
    for same in ("frames", "detections", "objects", "map_version", "state_hash"):
        assert resumed[same] == expected[same], same


@pytest.mark.recording
def test_real_perception_killed_midway_ends_in_the_same_map(cli: Cli, kitchen: Path, tmp_path: Path) -> None:
    words = replay(kitchen, "7scenes", 35)
    expected = uninterrupted(cli, tmp_path / "whole", words)
    data = tmp_path / "killed"
    stack = Stack(cli, data)
    replaying = cli.start(*words, "--data-dir", data, "--json")
    wait_for_progress(stack, frames=2)
    stack.kill_nine()
    replaying.kill()
    replaying.communicate()
    resumed = uninterrupted(cli, data, words)
    assert resumed["resumed_after"] > 0
    assert resumed["state_hash"] == expected["state_hash"]


def test_a_replay_outlives_the_stack_and_goes_on_with_the_next_one(
    cli: Cli, room_recording: Path, whole_room: Any, tmp_path: Path
) -> None:
    """The client reconnects by itself where the stack comes back at the same addresses."""
    words, expected = replay(room_recording, "ovip", 1), whole_room
    data = tmp_path / "killed"
    stack = Stack(cli, data)
    replaying = cli.start(*words, "--data-dir", data, "--json")
    wait_for_progress(stack, frames=8)
    stack.kill_nine()
    same_ports = {
        f"OVIP_{name.upper()}_PORT": address.rpartition(":")[2]
        for name, address in stack.running["addresses"].items()
    }
    with Stack(cli, data, same_ports):
        output, errors = replaying.communicate(timeout=240)
    assert replaying.returncode == 0, errors[-2000:]
    assert json.loads(output)["state_hash"] == expected["state_hash"]


def wait_for_progress(stack: Stack, frames: int) -> None:
    """Returns once the scene's map holds so many frames."""
    asyncio.run(_wait_for_progress(Addresses.of_stack(stack.running), frames))


async def _wait_for_progress(addresses: Addresses, frames: int) -> None:
    deadline = time.monotonic() + 120
    async with AsyncClient(addresses) as client:
        while time.monotonic() < deadline:
            if any(s.frames >= frames for s in await client.mapper.list_scenes()):
                return
            await asyncio.sleep(0.05)
    raise AssertionError(f"fewer than {frames} frames were mapped in two minutes")
