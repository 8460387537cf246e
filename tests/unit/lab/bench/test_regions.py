"""The regions' bench runs, small, on the real steps, and its floor is one that can be cut up."""

from __future__ import annotations

import numpy as np
import pytest

from lab.bench.regions import judged, measure_regions, units_of
from lab.bench.regions_alone import partitioned
from lab.bench.regions_burst import Paced, paced
from lab.bench.regions_steps import STEPS, Stopwatch, stopwatch
from lab.bench.regions_tiles import Tile
from lab.bench.regions_units import KINDS, UNIT
from lab.bench.regions_world import Office, OfficeParams
from lab.bench.rows import Row
from services.regions.domain import partition
from services.regions.domain.assembly import Cut
from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.pace import PaceParams
from services.regions.domain.survey import survey

SMALL = OfficeParams(frames=24, points=2500, things=8)


@pytest.fixture(scope="module")
def office() -> Office:
    return Office(params=SMALL)


@pytest.fixture(scope="module")
def evidence(office: Office) -> FloorEvidence:
    return office.evidence(3, 1)


@pytest.mark.parametrize(
    ("m2", "units"), [(50, (1, 1)), (200, (2, 2)), (1_000, (4, 5)), (10_000, (10, 20)), (350, (7, 1))]
)
def test_a_floor_is_as_square_as_its_units_allow(m2: int, units: tuple[int, int]) -> None:
    assert units_of(m2) == units
    assert units[0] * units[1] * UNIT[0] * UNIT[1] == m2


def test_a_floor_is_walled_rooms_an_open_hall_and_a_corridor_on_one_storey(
    office: Office, evidence: FloorEvidence
) -> None:
    (here,) = survey(evidence)
    free_m2 = here.space.free.sum() * here.space.resolution**2
    assert 0.8 * 150 < free_m2 < 150
    objects = office.objects(3, 1)
    assert len(objects.ids) == SMALL.things * sum(map(len, KINDS)) == 56
    cut = partitioned(evidence, objects, Cut.none())
    assert 5 <= len(cut.partition.regions) <= 14
    assert {region.function for region in cut.partition.regions} >= {"bedroom", "bathroom", "office"}


def test_the_same_seed_makes_the_same_floor_and_another_one_another(
    office: Office, evidence: FloorEvidence
) -> None:
    again, other = Office(params=SMALL), Office(1, SMALL)
    assert again.evidence(3, 1).to_bytes() == evidence.to_bytes() != other.evidence(3, 1).to_bytes()
    ours, same, others = office.objects(3, 1), again.objects(3, 1), other.objects(3, 1)
    assert ours.labels == same.labels != others.labels
    assert np.array_equal(ours.centres, same.centres)


def test_a_tile_laid_elsewhere_is_the_evidence_of_the_walk_made_there() -> None:
    by, rng = np.array([*UNIT, 0.0]), np.random.default_rng(0)
    here, walked, laid = FloorEvidence(), FloorEvidence(), FloorEvidence()
    for number in range(3):
        cubes = rng.integers((0, 0, 0), (80, 80, 50), (400, 3))
        surface, camera = (cubes + 0.5) * CELL, np.array([2.01, 2.01, 1.21])
        here.add(f"f{number}", surface.astype(np.float32), camera)
        walked.add(f"u1-f{number}", (surface + by).astype(np.float32), camera + by)
    Tile.of(here).lay(laid, UNIT, "u1-")
    assert laid.cameras.keys() == walked.cameras.keys() == laid.views.keys()
    assert all(laid.cameras[i] == pytest.approx(walked.cameras[i]) for i in laid.cameras)
    assert all(np.array_equal(laid.views[i], walked.views[i]) for i in laid.views)
    for stream in ("hits", "stood", "heights_below", "heights_above"):
        ours, theirs = getattr(laid, stream).items(), getattr(walked, stream).items()
        assert all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))


def test_every_step_is_timed_once_and_the_functions_are_left_as_they_were(
    office: Office, evidence: FloorEvidence
) -> None:
    before = partition.seed_groups
    with stopwatch() as watch:
        assert partition.seed_groups is not before
        partitioned(evidence, office.objects(3, 1), Cut.none())
    assert partition.seed_groups is before
    assert watch.seconds.keys() <= {step for step, _, _ in STEPS}
    for step in (
        "floors",
        "free_space",
        "functions",
        "cores",
        "first_watershed",
        "final_watershed",
        "outlines",
    ):
        assert watch.seconds[step] > 0


def test_a_step_inside_another_one_is_the_outer_ones() -> None:
    watch = Stopwatch()
    inner = watch.timing("inner", lambda: 1)
    outer = watch.timing("outer", lambda: inner() + 1)
    assert outer() == 2
    assert set(watch.seconds) == {"outer"}
    assert inner() == 1
    assert set(watch.seconds) == {"outer", "inner"}


def test_a_row_holds_the_whole_each_steps_share_and_what_it_is_compared_with() -> None:
    (row,) = measure_regions((50,), repeats=1, params=SMALL)
    shares = [float(value) for name, value in row.items() if name.endswith("_share")]
    assert sum(shares) == pytest.approx(1.0, abs=0.02)
    assert len(shares) == len(STEPS) + 1
    assert row["m2"] == 50
    assert row["objects"] == 16
    for name in ("total_ms", "peak_mb", "evidence_mb", "hovsg_ms", "sysnav_ms", "changed_ms", "kept_ms"):
        assert float(row[name]) > 0
    assert row["burst_partitions"] == 1


@pytest.mark.parametrize(
    ("m2", "total_ms", "peak_mb", "judgement"),
    [
        (200, 150.0, 20.0, (150.0, True, True)),
        (200, 150.1, 20.0, (150.0, False, True)),
        (10_000, 3_999.0, 1_000.0, (4_000.0, True, False)),
        (1_000, 9_999.0, 999.0, ("", "", True)),
    ],
)
def test_a_budget_is_met_or_missed_or_there_is_none(
    m2: int, total_ms: float, peak_mb: float, judgement: tuple[object, ...]
) -> None:
    told = judged({"m2": m2, "total_ms": total_ms, "peak_mb": peak_mb}, None)
    assert (told["budget_ms"], told["budget_met"], told["memory_met"]) == judgement
    assert told["growth"] == 1.0


def test_growth_is_time_a_square_metre_over_the_smaller_floors() -> None:
    small: Row = {"m2": 50, "total_ms": 10.0, "peak_mb": 1.0}
    assert judged({"m2": 200, "total_ms": 40.0, "peak_mb": 1.0}, small)["growth"] == 1.0
    assert judged({"m2": 200, "total_ms": 80.0, "peak_mb": 1.0}, small)["growth"] == 2.0


def test_a_burst_is_one_partition_and_a_stream_one_an_interval() -> None:
    pace = PaceParams(quiet_s=2.0, min_interval_s=5.0)
    assert paced([0.001 * number for number in range(1_000)], 0.5, pace).partitions == 1
    stream = paced([0.1 * number for number in range(600)], 0.5, pace)
    assert 9 <= stream.partitions <= 12
    assert stream.busy == pytest.approx(0.5 / 5.5, abs=0.02)
    assert paced([], 0.5, pace) == Paced(0, 0.0)
