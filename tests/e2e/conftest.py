"""What the end-to-end tests share: a simulated recording on disk, and the command line as a person runs it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from lab.simulation import SimulatedRoom, write_recording
from services.perception.adapters import model_cache
from services.perception.config import Settings
from services.standalone.process import read_ready, stop_stack

ROOT = Path(__file__).resolve().parents[2]
KITCHEN = ROOT.parent / "shared" / "data" / "kitchen"


@pytest.fixture(scope="session")
def embedded_models() -> Path:
    folder = Settings().models_dir
    if model_cache.missing(folder):
        pytest.skip(f"the embedded models are not in {folder}: run `ovip models pull embedded`")
    return folder


@pytest.fixture(scope="session")
def kitchen() -> Path:
    if not KITCHEN.is_dir():
        pytest.skip("the kitchen recording is not at ../shared/data/kitchen")
    return KITCHEN


@pytest.fixture(scope="session")
def room_recording(tmp_path_factory: pytest.TempPathFactory, embedded_models: Path) -> Path:
    """The simulated home's walk, every second frame of it, with what its robot detected on board."""
    folder = tmp_path_factory.mktemp("room") / "recording"
    room = SimulatedRoom(seed=0)
    write_recording(folder, room, room.walk()[::2])
    return folder


class Stack:
    """A whole stack in a process of its own, on free ports, that a test may ask, stop or kill."""

    def __init__(self, cli: Cli, data: Path, settings: dict[str, str] | None = None) -> None:
        chosen = settings or {"OVIP_FREE_PORTS": "true"}
        environment = {**cli.environment, "OVIP_LOG_LEVEL": "warning", **chosen, "OVIP_DATA_DIR": str(data)}
        self.data = data
        self.process = subprocess.Popen(
            [sys.executable, "-m", "services.standalone"], env=environment, stdout=subprocess.PIPE, text=True
        )
        self.running = read_ready(self.process)

    def __enter__(self) -> Stack:
        return self

    def __exit__(self, *_: object) -> None:
        stop_stack(self.process)

    def kill_nine(self) -> None:
        self.process.kill()
        self.process.wait()


class Cli:
    """`ovip ...` in a process of its own; JSON answers parsed."""

    def __init__(self, environment: dict[str, str]) -> None:
        self.environment = environment

    def run(self, *words: str | Path, timeout: float = 300) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            self.command(*words),
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )

    def json(self, *words: str | Path, timeout: float = 300) -> Any:
        done = self.run(*words, "--json", timeout=timeout)
        assert done.returncode == 0, f"ovip {' '.join(map(str, words))} failed:\n{done.stderr[-3000:]}"
        return json.loads(done.stdout)

    def start(self, *words: str | Path) -> subprocess.Popen[str]:
        return subprocess.Popen(
            self.command(*words),
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    @staticmethod
    def command(*words: str | Path) -> list[str]:
        return [sys.executable, "-m", "ovip_cli.app", *map(str, words)]


@pytest.fixture(scope="session")
def cli(embedded_models: Path) -> Cli:
    kept = {name: value for name, value in os.environ.items() if not name.startswith("OVIP_")}
    return Cli({**kept, "OVIP_MODELS_DIR": str(embedded_models), "PYTHONPATH": str(ROOT)})
