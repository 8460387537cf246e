"""Which stack a command speaks to: a running one, or one started for this command alone."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from ovip.client import Addresses
from ovip.config import KernelSettings
from ovip.errors import InvalidInput, Unavailable

Json = Annotated[bool, typer.Option("--json", help="print JSON and nothing else")]
Standalone = Annotated[
    bool,
    typer.Option("--standalone", help="start a stack for this command alone; its state stays in --data-dir"),
]
DataDir = Annotated[
    Path | None,
    typer.Option("--data-dir", help="where the stack keeps its state (else OVIP_DATA_DIR)", file_okay=False),
]
Scene = Annotated[str, typer.Option("--scene", help="name of the scene")]

_START_SECONDS = 120.0


@contextlib.contextmanager
def stack_for(standalone: bool, data_dir: Path | None) -> Iterator[Addresses]:
    """Addresses of the stack to use; a standalone one is stopped gently at the end."""
    if not standalone:
        settings = KernelSettings() if data_dir is None else KernelSettings(data_dir=data_dir)
        yield Addresses.discover(settings)
        return
    if data_dir is None:
        raise InvalidInput("--standalone: expected --data-dir DIR as well, where its state stays")
    process = start_stack(data_dir, free_ports=True)
    try:
        yield Addresses.of_stack(read_ready(process))
    finally:
        stop_stack(process)


def start_stack(data_dir: Path, free_ports: bool, log_level: str = "warning") -> subprocess.Popen[str]:
    """A stack in a process of its own, which ends when this one does."""
    environment = {
        **os.environ,
        "OVIP_DATA_DIR": str(data_dir.absolute()),
        "OVIP_FREE_PORTS": "true" if free_ports else "false",
        "OVIP_LOG_LEVEL": os.environ.get("OVIP_LOG_LEVEL", log_level),
    }
    return subprocess.Popen(
        [sys.executable, "-m", "services.standalone"],
        stdout=subprocess.PIPE,
        text=True,
        env=environment,
        preexec_fn=_end_with_parent if sys.platform == "linux" else None,
    )


def read_ready(process: subprocess.Popen[str]) -> dict[str, Any]:
    """What the stack says of itself once everything answers; Unavailable where it ends before that."""
    assert process.stdout is not None
    deadline = time.monotonic() + _START_SECONDS
    while time.monotonic() < deadline:
        ready, _, _ = select.select([process.stdout], [], [], 0.2)
        line = process.stdout.readline() if ready else ""
        if line.startswith("{"):
            stack: dict[str, Any] = json.loads(line)
            return stack
        if process.poll() is not None:
            raise Unavailable("the stack did not start; its last words are above")
    stop_stack(process)
    raise Unavailable(f"the stack was not ready after {_START_SECONDS:.0f} s")


def stop_stack(process: subprocess.Popen[str]) -> None:
    """Asks it to stop, waits, and only then insists."""
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def print_json(value: Any) -> None:
    """One JSON value on standard output."""
    print(json.dumps(value))


def _end_with_parent() -> None:
    ctypes.CDLL("libc.so.6", use_errno=True).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG
