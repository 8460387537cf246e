from __future__ import annotations

from pathlib import Path

import pytest

from lab.evaluation.asking.questions import Kind, Question
from lab.evaluation.asking.worlds import WorldSpec
from lab.evaluation.experiments.absence import Searched, draw, rows_of

MUG = Question("mug", Kind.CLASS, "mug", (1,))
PIANO = Question("piano", Kind.CLASS, "piano")


def searched(
    question: Question,
    found_at: int | None,
    miss: float = float("inf"),
    absent: bool = False,
    visited: int = 20,
) -> Searched:
    return Searched(
        scene="room 1",
        question=question,
        planned=20,
        visited=found_at or visited,
        unreachable=20 - visited,
        found_at=found_at,
        miss=miss,
        declared_absent=absent,
        travelled=3.0,
        needs="" if found_at or absent else "a grounder that is known to see 'piano'",
    )


ALL = (
    searched(MUG, found_at=4, miss=0.3),
    searched(MUG, found_at=15, miss=0.2),
    searched(MUG, found_at=3, miss=4.0),
    searched(MUG, found_at=None),
    searched(PIANO, found_at=None, absent=True),
    searched(PIANO, found_at=None, visited=14),
    searched(PIANO, found_at=11),
)


def counts(row: dict[str, object]) -> tuple[object, ...]:
    return tuple(row[name] for name in ("TP", "FN", "TN", "FP"))


def test_all_decisions_of_the_whole_plan_are_counted() -> None:
    full, _ = rows_of(ALL)
    assert full["config"] == "full"
    assert counts(full) == (3, 1, 2, 1)
    assert full["loc_1m"] == 0.5
    assert full["viewpoints"] == (4 + 15 + 3 + 20 + 20 + 14 + 11) / 7
    assert full["unreachable"] == 6


def test_half_the_plan_is_its_first_half() -> None:
    _, half = rows_of(ALL)
    assert half["config"] == "half"
    assert counts(half) == (2, 2, 3, 0)  # found at 15 and at 11 of 20: too late
    assert half["loc_1m"] == 0.25
    assert half["viewpoints"] == (4 + 10 + 3 + 10 + 10 + 10 + 10) / 7


def test_strictly_a_find_must_be_right_and_an_absence_declared() -> None:
    full, half = rows_of(ALL)
    assert counts(full["strict"]) == (2, 2, 1, 2)
    # half a plan proves no absence
    assert counts(half["strict"]) == (1, 3, 0, 3)


def test_no_searches_no_rates() -> None:
    assert [row["balanced_accuracy"] for row in rows_of(())] == [0.0, 0.0]


def test_a_picture_of_each_place_shows_one_search_of_either_kind(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="pictures need matplotlib")
    bed = Question("bed", Kind.CLASS, "bed", (23,))
    drawn = draw(
        tmp_path, (WorldSpec("room", 1),), (searched(bed, found_at=4), searched(PIANO, found_at=None))
    )
    assert [path.name for path in drawn] == ["absence-room-1.png"]
    assert drawn[0].stat().st_size > 1000
