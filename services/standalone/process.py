"""A stack in a process of its own: start it, wait until everything answers, stop it."""

from __future__ import annotations

import ctypes
import json
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from ovip.errors import Unavailable

_START_SECONDS = 120.0
_STOP_SECONDS = 30.0


def start_stack(
    data_dir: Path, free_ports: bool, log_level: str = "warning", module: str = "services.standalone"
) -> subprocess.Popen[str]:
    """A stack in a process of its own, which ends when this one does. module: what `python -m` runs."""
    environment = {
        **os.environ,
        "OVIP_DATA_DIR": str(data_dir.absolute()),
        "OVIP_FREE_PORTS": "true" if free_ports else "false",
        "OVIP_LOG_LEVEL": os.environ.get("OVIP_LOG_LEVEL", log_level),
    }
    return subprocess.Popen(
        [sys.executable, "-m", module],
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
            process.wait(_STOP_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _end_with_parent() -> None:
    ctypes.CDLL("libc.so.6", use_errno=True).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG
