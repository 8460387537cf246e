"""`python -m lab.bench.regions_alone FLOOR`: one floor partitioned in a process and a memory of its own."""

from __future__ import annotations

import gc
import json
import os
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from lab.bench.regions_burst import burst_columns
from lab.bench.regions_steps import STEPS, Stopwatch, stopwatch
from lab.bench.regions_world import Office, OfficeParams
from lab.bench.rows import Row
from ovip.scene.types import F32, F64
from services.regions.config import Settings
from services.regions.domain import functions, survey
from services.regions.domain.assembly import Cut, PlacedObjects, assemble
from services.regions.domain.baselines.hovsg import hovsg_rooms
from services.regions.domain.baselines.sysnav import sysnav_rooms
from services.regions.domain.evidence import FloorEvidence


def measure_floor(evidence_file: Path, units: tuple[int, int], params: OfficeParams, repeats: int) -> Row:
    """The row of an office floor of columns x rows units whose evidence lies in a file; the best of `repeats`.

    peak_mb: of the process while it reads the evidence and partitions it once, less what it held before.
    total_ms: survey, functions by the table, and assembly. changed_ms: the same after one more frame, with the last
    partition to keep ids from. kept_ms: with every floor found unchanged. X_ms, X_share: a step's part of the total.
    burst_partitions, stream_partitions: of a thousand changes at once and of ten a second for a minute.
    """
    office = Office(params=params)
    objects, one_more = office.objects(*units), office.look(0, params.frames)
    held = _peak_mb()
    evidence = FloorEvidence.from_bytes(evidence_file.read_bytes())
    partitioned(evidence, objects, Cut.none())
    peak = _peak_mb() - held
    total, watch, cut = _best(lambda: partitioned(evidence, objects, Cut.none()), repeats)
    return {
        "free_m2": round(sum(floor.area for floor in cut.partition.floors)),
        "objects": len(objects.ids),
        "frames": len(evidence.cameras),
        "regions": len(cut.partition.regions),
        "edges": len(cut.partition.edges),
        "evidence_mb": round(evidence_file.stat().st_size / 1e6, 2),
        "peak_mb": round(peak, 1),
        "total_ms": _ms(total),
        **_steps(watch, total),
        **_baselines(evidence, max(1, repeats // 3)),
        **_again(evidence, objects, cut, one_more, repeats),
        "load": round(os.getloadavg()[0], 1),
    }


def partitioned(
    evidence: FloorEvidence, objects: PlacedObjects, before: Cut, kept: frozenset[int] = frozenset()
) -> Cut:
    """What the stage does for a partition, with the table's functions and its own settings' numbers."""
    surveyed = survey.survey(evidence)
    named = functions.functions_of(objects.labels, objects.centres[:, :2], {})
    return assemble(surveyed, objects, named, evidence, before, Settings.model_construct().partition, kept)


def _best(action: Callable[[], Cut], repeats: int) -> tuple[float, Stopwatch, Cut]:
    """Seconds of the fastest of several runs, its steps', and what it gave."""
    runs: list[tuple[float, Stopwatch, Cut]] = []
    for _ in range(repeats):
        gc.collect()
        with stopwatch() as watch:
            began = time.perf_counter()
            cut = action()
            runs.append((time.perf_counter() - began, watch, cut))
    return min(runs, key=lambda run: run[0])


def _steps(watch: Stopwatch, total: float) -> Row:
    seconds: dict[str, float] = {step: watch.seconds[step] for step, _, _ in STEPS}
    seconds["rest"] = total - sum(seconds.values())
    row: Row = {f"{step}_ms": _ms(spent) for step, spent in seconds.items()}
    return row | {f"{step}_share": round(spent / total, 3) for step, spent in seconds.items()}


def _baselines(evidence: FloorEvidence, repeats: int) -> Row:
    """The baselines' rooms of the same storeys, which they are given."""
    surveyed = survey.survey(evidence)
    row: Row = {}
    for name, rooms in (("hovsg_ms", hovsg_rooms), ("sysnav_ms", sysnav_rooms)):
        spent = []
        for _ in range(repeats):
            began = time.perf_counter()
            for here in surveyed:
                rooms(evidence, here.storey, here.space)
            spent.append(time.perf_counter() - began)
        row[name] = _ms(min(spent))
    return row


def _again(
    evidence: FloorEvidence, objects: PlacedObjects, cut: Cut, frame: tuple[F32, F64], repeats: int
) -> Row:
    """What one more frame and one moved object cost, and what it costs to find that a floor may stay as it is."""
    began = time.perf_counter()
    evidence.add("one more", *frame)
    added = time.perf_counter() - began
    moved = replace(objects, centres=np.vstack([objects.centres[:1] + 0.5, objects.centres[1:]]))
    changed, _, after = _best(lambda: partitioned(evidence, moved, cut), repeats)
    floors = frozenset(range(len(after.grids)))
    kept, _, _ = _best(lambda: partitioned(evidence, moved, after, floors), repeats)
    spent = {"frame_ms": _ms(added), "changed_ms": _ms(changed), "kept_ms": _ms(kept)}
    return {**spent, **burst_columns(changed, Settings.model_construct().pace)}


def _peak_mb() -> float:
    """The most memory that this process has held: without what its parent held, which getrusage counts on Linux."""
    status = Path("/proc/self/status")
    if status.exists():
        (kilobytes,) = (
            line.split()[1] for line in status.read_text().splitlines() if line.startswith("VmHWM")
        )
        return int(kilobytes) * 1024 / 1e6
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def _ms(seconds: float) -> float:
    return round(seconds * 1e3, 2)


def main() -> None:
    """Prints the row of the floor that the first argument tells of in JSON, as one line of JSON."""
    told = json.loads(sys.argv[1])
    params = OfficeParams(**told["params"])
    row = measure_floor(Path(told["evidence"]), tuple(told["units"]), params, told["repeats"])
    print(json.dumps(row))


if __name__ == "__main__":
    main()
