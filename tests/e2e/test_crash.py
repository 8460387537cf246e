"""kill -9 of the whole stack in mid-replay loses nothing and changes nothing."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from ovip.client import Addresses, AsyncClient
from tests.e2e.conftest import Cli

pytestmark = pytest.mark.models


def start_stack(cli: Cli, data: Path) -> tuple[subprocess.Popen[str], dict[str, Any]]:
    environment = {**cli.environment, "OVIP_DATA_DIR": str(data), "OVIP_FREE_PORTS": "true"}
    stack = subprocess.Popen(
        [sys.executable, "-m", "services.standalone"], env=environment, stdout=subprocess.PIPE, text=True
    )
    assert stack.stdout is not None
    return stack, json.loads(stack.stdout.readline())


def kill_nine(stack: subprocess.Popen[str]) -> None:
    os.kill(stack.pid, signal.SIGKILL)
    stack.wait()


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
        stack, running = start_stack(cli, data)
        replaying = cli.start(*words, "--data-dir", data, "--json")
        wait_for_progress(running, frames=8 * (nth + 1))
        kill_nine(stack)
        replaying.kill()
        replaying.communicate()
    resumed = uninterrupted(cli, data, words)
    assert resumed["resumed_after"] > 0
    assert resumed["sent"] < expected["sent"]
    for same in ("frames", "detections", "objects", "map_version", "state_hash"):
        assert resumed[same] == expected[same], same


@pytest.mark.recording
def test_real_perception_killed_midway_ends_in_the_same_map(cli: Cli, kitchen: Path, tmp_path: Path) -> None:
    words = replay(kitchen, "7scenes", 24)
    expected = uninterrupted(cli, tmp_path / "whole", words)
    data = tmp_path / "killed"
    stack, running = start_stack(cli, data)
    replaying = cli.start(*words, "--data-dir", data, "--json")
    wait_for_progress(running, frames=3)
    kill_nine(stack)
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
    stack, first = start_stack(cli, data)
    replaying = cli.start(*words, "--data-dir", data, "--json")
    wait_for_progress(first, frames=8)
    kill_nine(stack)
    fixed = {
        f"OVIP_{name.upper()}_PORT": address.rpartition(":")[2]
        for name, address in first["addresses"].items()
    }
    environment = {**cli.environment, **fixed, "OVIP_DATA_DIR": str(data)}
    second = subprocess.Popen(
        [sys.executable, "-m", "services.standalone"], env=environment, stdout=subprocess.PIPE, text=True
    )
    try:
        output, errors = replaying.communicate(timeout=240)
        assert replaying.returncode == 0, errors[-2000:]
        assert json.loads(output)["state_hash"] == expected["state_hash"]
    finally:
        second.terminate()
        second.wait(30)


def wait_for_progress(running: dict[str, Any], frames: int) -> None:
    """Returns once the scene's map holds so many frames."""
    asyncio.run(_wait_for_progress(Addresses.of_stack(running), frames))


async def _wait_for_progress(addresses: Addresses, frames: int) -> None:
    deadline = time.monotonic() + 120
    async with AsyncClient(addresses) as client:
        while time.monotonic() < deadline:
            if any(s.frames >= frames for s in await client.mapper.list_scenes()):
                return
            await asyncio.sleep(0.05)
    raise AssertionError(f"fewer than {frames} frames were mapped in two minutes")
