"""Every service as a process of its own gives the same map and the same answers as the stack in one process."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ovip.healthcheck import is_well
from ovip.store.embedded import server_binary
from tests.e2e.conftest import Cli, Stack

pytestmark = pytest.mark.models
SERVICES = ("vlm_gateway", "mapper", "perception", "regions", "retrieval", "api")
QUESTIONS = ("red mug", "where is the laptop?", "piano")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextlib.contextmanager
def deployed_apart(cli: Cli, folder: Path) -> Iterator[dict[str, str]]:
    """A store server and six services, each its own process; yields the environment to reach them."""
    ports = {name: free_port() for name in (*SERVICES, "store")}
    environment = {
        **cli.environment,
        "OVIP_REDIS_URL": f"redis://127.0.0.1:{ports['store']}/0",
        "OVIP_DATA_DIR": str(folder / "data"),
        "OVIP_API_KEY": "a-key-for-this-test",
        "OVIP_LOG_LEVEL": "warning",
        **{f"OVIP_{name.upper()}_PORT": str(ports[name]) for name in SERVICES},
        **{f"OVIP_{name.upper()}_ADDRESS": f"127.0.0.1:{ports[name]}" for name in SERVICES},
    }
    store = [
        server_binary(),
        "--port",
        str(ports["store"]),
        "--bind",
        "127.0.0.1",
        "--dir",
        str(folder),
        "--save",
        "",
    ]
    processes = [subprocess.Popen(store, stdout=subprocess.DEVNULL)]
    try:
        for name in SERVICES:
            processes.append(subprocess.Popen([sys.executable, "-m", f"services.{name}"], env=environment))
        targets = [f"127.0.0.1:{ports[name]}" for name in SERVICES[:-1]]
        wait_until_well([*targets, f"http://127.0.0.1:{ports['api']}/healthz"])
        yield environment
    finally:
        for process in reversed(processes):
            process.terminate()
        for process in processes:
            process.wait(30)


def wait_until_well(targets: list[str]) -> None:
    deadline = time.monotonic() + 90
    for target in targets:
        while not is_well(target):
            assert time.monotonic() < deadline, f"{target} is not well after 90 s"
            time.sleep(0.2)


def essence(answer: Any) -> Any:
    """An answer without what differs from run to run: times and the search's id."""
    kept = {
        name: value
        for name, value in answer.items()
        if name not in {"search_id", "tiers", "regions_revision"}
    }
    return {**kept, "tiers": [(t["tier"], t["result"]) for t in answer["tiers"]]}


def test_apart_or_together_the_same_frames_give_the_same_map_and_answers(
    cli: Cli, room_recording: Path, tmp_path: Path
) -> None:
    replay = ("replay", room_recording, "--scene", "home")
    with Stack(cli, tmp_path / "together") as stack:
        together = cli.json(*replay, "--data-dir", stack.data)
        answers = [cli.json("find", q, "--scene", "home", "--data-dir", stack.data) for q in QUESTIONS]
    (tmp_path / "apart").mkdir()
    with deployed_apart(cli, tmp_path / "apart") as environment:
        remote = Cli({**os.environ, **environment})
        apart = remote.json(*replay)
        assert apart["state_hash"] == together["state_hash"]
        assert apart["regions"] == together["regions"]
        for question, expected in zip(QUESTIONS, answers, strict=True):
            answer = remote.json("find", question, "--scene", "home")
            assert essence(answer) == essence(expected), question
