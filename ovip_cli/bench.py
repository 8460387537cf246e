"""`ovip bench`: measures what the system costs on this machine."""

from __future__ import annotations

import asyncio
import time
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from lab.bench.rows import Row
from ovip.recordings import LAYOUTS
from ovip.telemetry import configure_logging
from ovip_cli.stacks import Json, print_json


class Bench(StrEnum):
    INGEST = "ingest"
    PERCEPTION = "perception"
    TIER1 = "tier1"
    START = "start"


def bench(
    name: Annotated[Bench | None, typer.Argument(help="what to measure; all where left out")] = None,
    robots: Annotated[int, typer.Option(min=1, help="ingest: robots that stream at once")] = 16,
    kilobytes: Annotated[int, typer.Option(min=100, help="ingest: size of a frame")] = 300,
    duration: Annotated[float, typer.Option(min=1.0, help="ingest: seconds each way")] = 6.0,
    frames: Annotated[int, typer.Option(min=1, help="perception: frames to look at")] = 12,
    recording: Annotated[
        Path | None, typer.Option(help="perception: a recording instead of the simulated home")
    ] = None,
    layout: Annotated[str, typer.Option(help=f"perception: its layout: {', '.join(LAYOUTS)}")] = "ovip",
    json: Json = False,
) -> None:
    """Measure durable ingest, perception's steps, tier 1's answers, the start of a stack."""
    # the services that are measured: seconds that the other commands need not wait
    from lab.bench.ingesting import measure_ingest
    from lab.bench.perceiving import measure_perception
    from lab.bench.starting import measure_start
    from lab.bench.tier1 import measure_tier1

    configure_logging("warning", as_json=False)
    measures = {
        Bench.INGEST: lambda: asyncio.run(measure_ingest(robots, kilobytes, duration)),
        Bench.PERCEPTION: lambda: asyncio.run(measure_perception(frames, recording, layout)),
        Bench.TIER1: lambda: asyncio.run(measure_tier1()),
        Bench.START: measure_start,
    }
    began = time.perf_counter()
    every: list[Row] = []
    for which in [name] if name else Bench:
        rows = measures[which]()
        every += [{"bench": which.value, **row} for row in rows]
        if not json:
            _print_table(which.value, rows)
    if json:
        print_json({"rows": every, "seconds": round(time.perf_counter() - began, 2)})


def _print_table(name: str, rows: list[Row]) -> None:
    widths = {column: max(len(column), *(len(str(row[column])) for row in rows)) for column in rows[0]}
    print(f"\n{name}")
    print("  ".join(f"{column:>{width}}" for column, width in widths.items()))
    for row in rows:
        print("  ".join(f"{row[column]!s:>{width}}" for column, width in widths.items()))
