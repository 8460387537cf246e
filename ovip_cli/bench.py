"""`ovip bench`: measures what the system costs on this machine."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
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
    LIFTING = "lifting"
    MAPPER = "mapper"
    CIRCLE = "circle"
    REPLAY = "replay"
    TIER1 = "tier1"
    START = "start"
    REGIONS = "regions"
    RENDERING = "rendering"


_MOST_COLUMNS = 24


@dataclass(frozen=True, slots=True)
class Options:
    """How large a bench is; None: as large as it is by default. rate: frames a second of all robots together."""

    robots: int
    kilobytes: int
    duration: float
    rate: float
    frames: int | None
    objects: list[int] | None
    detections: list[int] | None
    dim: list[int] | None
    areas: list[int] | None
    recording: Path | None
    layout: str


def bench(
    name: Annotated[Bench | None, typer.Argument(help="what to measure; all where left out")] = None,
    robots: Annotated[int, typer.Option(min=1, help="ingest: robots that stream at once")] = 16,
    kilobytes: Annotated[int, typer.Option(min=100, help="ingest: size of a frame")] = 300,
    duration: Annotated[float, typer.Option(min=0.1, help="ingest: seconds each way")] = 6.0,
    rate: Annotated[float, typer.Option(min=1.0, help="ingest: frames a second of the paced row")] = 250.0,
    frames: Annotated[
        int | None,
        typer.Option(
            min=1, help="perception, rendering (12), mapper (50 a row), circle (10000), replay (all): frames"
        ),
    ] = None,
    objects: Annotated[str | None, typer.Option(help="mapper: sizes of map, like 100,1000")] = None,
    detections: Annotated[
        str | None, typer.Option(help="lifting, mapper, replay: detections a frame, like 20,40")
    ] = None,
    dim: Annotated[str | None, typer.Option(help="mapper: numbers a feature has, like 512,1024")] = None,
    areas: Annotated[
        str | None, typer.Option(help="regions: sizes of floor in square metres, like 200,10000")
    ] = None,
    recording: Annotated[
        Path | None, typer.Option(help="perception, replay: a recording instead of the simulated home")
    ] = None,
    layout: Annotated[
        str, typer.Option(help=f"perception, replay: its layout: {', '.join(LAYOUTS)}")
    ] = "ovip",
    json: Json = False,
) -> None:
    """Measure durable ingest, perception, the mapper, a replay, tier 1's answers, a start, regions, rendering."""
    configure_logging("warning", as_json=False)
    options = Options(
        robots,
        kilobytes,
        duration,
        rate,
        frames,
        _numbers(objects),
        _numbers(detections),
        _numbers(dim),
        _numbers(areas),
        recording,
        layout,
    )
    began = time.perf_counter()
    every: list[Row] = []
    for which in [name] if name else Bench:
        rows = MEASURES[which](options)
        every += [{"bench": which.value, **row} for row in rows]
        if not json:
            _print_table(which.value, rows)
    if json:
        print_json({"rows": every, "seconds": round(time.perf_counter() - began, 2)})


def _numbers(text: str | None) -> list[int] | None:
    """Whole numbers above 0 with commas between them."""
    if text is None:
        return None
    words = text.split(",")
    if not all(word.strip().isdecimal() and int(word) > 0 for word in words):
        raise typer.BadParameter(f"expected whole numbers above 0 with commas between them, got {text!r}")
    return [int(word) for word in words]


# A bench brings the models and services that it measures only when it runs.


def _ingest(options: Options) -> list[Row]:
    from lab.bench.ingesting import measure_ingest

    return asyncio.run(measure_ingest(options.robots, options.kilobytes, options.duration, options.rate))


def _perception(options: Options) -> list[Row]:
    from lab.bench.perceiving import measure_perception

    return asyncio.run(measure_perception(options.frames or 12, options.recording, options.layout))


def _lifting(options: Options) -> list[Row]:
    from lab.bench.lifting import measure_lifting

    return [measure_lifting(masks) for masks in options.detections or (20, 40)]


def _mapper(options: Options) -> list[Row]:
    from lab.bench.mapping_alone import measure_mapper_alone

    return measure_mapper_alone(options.objects, options.detections, options.dim, options.frames)


def _circle(options: Options) -> list[Row]:
    from lab.bench.mapping_circle import FRAMES, measure_circle

    return measure_circle(options.frames or FRAMES)


def _replay(options: Options) -> list[Row]:
    from lab.bench.replaying import DETECTIONS, TOUR, measure_replay

    return asyncio.run(
        measure_replay(
            options.recording or TOUR, options.layout, options.frames, options.detections or DETECTIONS
        )
    )


def _tier1(_: Options) -> list[Row]:
    from lab.bench.tier1 import measure_tier1

    return asyncio.run(measure_tier1())


def _start(_: Options) -> list[Row]:
    from lab.bench.starting import measure_start

    return measure_start()


def _regions(options: Options) -> list[Row]:
    from lab.bench.regions import SIZES, measure_regions

    return measure_regions(options.areas or SIZES)


def _rendering(options: Options) -> list[Row]:
    from lab.bench.rendering import measure_rendering

    return measure_rendering(options.frames or 12)


MEASURES: dict[Bench, Callable[[Options], list[Row]]] = {
    Bench.INGEST: _ingest,
    Bench.PERCEPTION: _perception,
    Bench.LIFTING: _lifting,
    Bench.MAPPER: _mapper,
    Bench.CIRCLE: _circle,
    Bench.REPLAY: _replay,
    Bench.TIER1: _tier1,
    Bench.START: _start,
    Bench.REGIONS: _regions,
    Bench.RENDERING: _rendering,
}


def _print_table(name: str, rows: list[Row]) -> None:
    """A line for each row; a line for each column where there are more than a person's screen holds."""
    lines = [[str(row[column]) for column in rows[0]] for row in rows]
    table = [list(rows[0]), *lines]
    if len(rows[0]) > _MOST_COLUMNS:
        table = [list(column) for column in zip(*table, strict=True)]
    widths = [max(len(line[i]) for line in table) for i in range(len(table[0]))]
    print(f"\n{name}")
    for line in table:
        print("  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)))
