"""kill -9 of the whole stack in mid-replay loses nothing and changes nothing."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

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


def uninterrupted(cli: Cli, data: Path, words: tuple[str | Path, ...]) -> Any:
    return cli.json(*words, "--standalone", "--data-dir", data, timeout=500)


@pytest.mark.parametrize("kills", [1, 3])
def test_a_replay_killed_midway_ends_in_the_same_map(
    cli: Cli, room_recording: Path, tmp_path: Path, kills: int
) -> None:
    words = replay(room_recording, "ovip", 1)
    expected = uninterrupted(cli, tmp_path / "whole", words)
    data = tmp_path / "killed"
    for nth in range(kills):
        stack, _ = start_stack(cli, data)
        replaying = cli.start(*words, "--data-dir", data, "--json")
        wait_for_progress(cli, data, frames=8 * (nth + 1))
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
    words = replay(kitchen, "7scenes", 16)
    expected = uninterrupted(cli, tmp_path / "whole", words)
    data = tmp_path / "killed"
    stack, _ = start_stack(cli, data)
    replaying = cli.start(*words, "--data-dir", data, "--json")
    wait_for_progress(cli, data, frames=4)
    kill_nine(stack)
    replaying.kill()
    replaying.communicate()
    resumed = uninterrupted(cli, data, words)
    assert resumed["resumed_after"] > 0
    assert resumed["state_hash"] == expected["state_hash"]


def test_a_replay_outlives_the_stack_and_goes_on_with_the_next_one(
    cli: Cli, room_recording: Path, tmp_path: Path
) -> None:
    """The client reconnects by itself where the stack comes back at the same addresses."""
    words = replay(room_recording, "ovip", 1)
    expected = uninterrupted(cli, tmp_path / "whole", words)
    data = tmp_path / "killed"
    stack, first = start_stack(cli, data)
    replaying = cli.start(*words, "--data-dir", data, "--json")
    wait_for_progress(cli, data, frames=8)
    kill_nine(stack)
    fixed = {
        f"OVIP_{name.upper()}_PORT": address.rpartition(":")[2] for name, address in first["addresses"].items()
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


def wait_for_progress(cli: Cli, data: Path, frames: int) -> None:
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        scenes = cli.json("scenes", "--data-dir", data)["scenes"]
        if scenes and scenes[0]["frames"] >= frames:
            return
        time.sleep(0.05)
    raise AssertionError(f"fewer than {frames} frames were mapped in two minutes")
