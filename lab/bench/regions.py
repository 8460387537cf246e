"""What a partition costs, over floors of growing size: each step, memory, a change, and the baselines beside it."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from lab.bench.regions_world import Office, OfficeParams
from lab.bench.rows import Row

SIZES = (50, 200, 1_000, 10_000)
"""Square metres."""

BUDGETS_MS = {200: 150.0, 10_000: 4_000.0}
"""Milliseconds that a whole partition of so many square metres may take."""

BUDGET_MB = 1_000.0
"""Memory that any of them may take."""

_UNIT_M2 = 50
_ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def measure_regions(
    sizes: Sequence[int] = SIZES, repeats: int | None = None, params: OfficeParams | None = None
) -> list[Row]:
    """A row for each size, in square metres, each measured in a process of its own; the best of `repeats`.

    repeats: None = as many as take a few seconds.
    """
    office = Office(params=params or OfficeParams())
    rows: list[Row] = []
    for m2 in sizes:
        row = _measured(office, m2, repeats or max(3, min(20, 4_000 // m2)))
        rows.append({**row, **judged(row, rows[-1] if rows else None)})
    return rows


def units_of(m2: int) -> tuple[int, int]:
    """Columns and rows of units that make so many square metres, as square as they come."""
    units = max(1, round(m2 / _UNIT_M2))
    rows = next(rows for rows in range(math.isqrt(2 * units), 0, -1) if units % rows == 0)
    return units // rows, rows


def judged(row: Row, before: Row | None) -> Row:
    """The budgets, and whether each is met ("" where there is none); growth: time a square metre over that of the row
    before."""
    budget, total = BUDGETS_MS.get(int(row["m2"])), float(row["total_ms"])
    growth = 1.0
    if before is not None:
        growth = total / float(before["total_ms"]) * float(before["m2"]) / float(row["m2"])
    return {
        "budget_ms": "" if budget is None else budget,
        "budget_met": "" if budget is None else total <= budget,
        "memory_met": float(row["peak_mb"]) < BUDGET_MB,
        "growth": round(growth, 2),
    }


def _measured(office: Office, m2: int, repeats: int) -> Row:
    """One floor's row, from a process that has done nothing before."""
    units = units_of(m2)
    with tempfile.TemporaryDirectory() as folder:
        evidence = Path(folder, "evidence")
        evidence.write_bytes(office.evidence(*units).to_bytes())
        told = {
            "evidence": str(evidence),
            "units": units,
            "params": asdict(office.params),
            "repeats": repeats,
        }
        done = subprocess.run(
            [sys.executable, "-m", "lab.bench.regions_alone", json.dumps(told)],
            env={**os.environ, **_ONE_THREAD},
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
    row: Row = json.loads(done.stdout.splitlines()[-1])
    return {"m2": m2, **row}
