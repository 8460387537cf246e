"""How long a stack takes from process start to answering, and how much memory it holds then."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from lab.bench.rows import Row
from services.standalone.process import read_ready, start_stack, stop_stack


def measure_start() -> list[Row]:
    """Two starts of `python -m services.standalone` on one data directory: new, then as the first left it."""
    with tempfile.TemporaryDirectory() as folder:
        return [_start(Path(folder), data) for data in ("new", "as left")]


def _start(folder: Path, data: str) -> Row:
    began = time.perf_counter()
    process = start_stack(folder, free_ports=True)
    try:
        read_ready(process)
        ready = time.perf_counter()
        memory = sum(_resident_mb(pid) for pid in _with_children(process.pid))
    finally:
        stopping = time.perf_counter()
        stop_stack(process)
    stopped = time.perf_counter()
    return {
        "data": data,
        "ready_s": round(ready - began, 2),
        "memory_mb": round(memory),
        "stop_s": round(stopped - stopping, 2),
    }


def _with_children(pid: int) -> list[int]:
    """The process and what it started (Linux)."""
    lists = Path(f"/proc/{pid}/task").glob("*/children")
    children = [int(child) for path in lists for child in path.read_text().split()]
    return [pid, *(deep for child in children for deep in _with_children(child))]


def _resident_mb(pid: int) -> float:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS:"))
