"""Steps as entries of the map log, and back, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import F64, MapDelta, StepKind
from ovip.store import Entry
from services.mapper.journal import (
    EditInput,
    FrameInput,
    JoinInput,
    SettingsInput,
    Step,
    StepInput,
    UpkeepInput,
    entry_id,
    matrix_of,
    matrix_text,
    step_of,
)
from tests.builders import same

POSE: F64 = np.linspace(0, 1 / 3, 16).reshape(4, 4)
INPUTS: list[tuple[StepKind, StepInput]] = [
    (StepKind.FRAME, FrameInput("17-3", "a" * 64)),
    (StepKind.FRAME, FrameInput("17-3", "a" * 64, "features of 7 numbers")),
    (StepKind.UPKEEP, UpkeepInput()),
    (StepKind.EDIT, EditInput("17-4", b"\x00\xff")),
    (StepKind.JOIN, JoinInput("17-5", "b" * 64, POSE)),
    (StepKind.SETTINGS, SettingsInput('{"voxel": 0.02}')),
]


def written(step: Step, at: str = "") -> Entry:
    """The entry as the store gives it back: every value as bytes."""
    fields = {
        name: value if isinstance(value, bytes) else str(value).encode()
        for name, value in step.fields().items()
    }
    return Entry(at or entry_id(step.delta.version), fields)


@pytest.mark.parametrize(("kind", "source"), INPUTS)
def test_a_step_is_read_back_as_it_was_written(kind: StepKind, source: StepInput) -> None:
    delta = MapDelta(
        12, "r.s.00000003" if kind is StepKind.FRAME else "", kind, ("o000001",), aliases={"a": "b"}
    )
    step = Step(source, delta, {"o000001": "o000004"} if kind is StepKind.JOIN else {})

    assert same(step_of(written(step)), step)


def test_versions_stand_in_the_log_by_number() -> None:
    assert entry_id(12) == "12-0"


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=16, max_size=16))
def test_a_matrix_is_written_to_the_last_bit(numbers: list[float]) -> None:
    matrix = np.array(numbers).reshape(4, 4)

    assert matrix_of(matrix_text(matrix)).tobytes() == matrix.tobytes()


def test_an_entry_at_the_wrong_place_is_corrupt() -> None:
    step = Step(UpkeepInput(), MapDelta(12, "", StepKind.UPKEEP))

    with pytest.raises(Corrupt, match="entry 13-0 is no step of a map .*version 12"):
        step_of(written(step, "13-0"))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("kind", b"dance"),
        ("kind", b"upkeep"),
        ("delta", b"\xff"),
        ("batch", None),
        ("log_id", b"\xff\xfe"),
        ("ids", b"{"),
    ],
)
def test_an_entry_that_is_no_step_is_corrupt_and_named(name: str, value: bytes | None) -> None:
    entry = written(Step(FrameInput("17-3", "a" * 64), MapDelta(12, "f", StepKind.FRAME)))
    changed = {**entry.fields, name: value} if value is not None else entry.fields
    fields = {key: one for key, one in changed.items() if value is not None or key != name}

    with pytest.raises(Corrupt, match="map log: entry 12-0 is no step of a map"):
        step_of(Entry(entry.id, fields))


def test_an_entry_of_an_older_mapper_is_refused_in_words() -> None:
    with pytest.raises(InvalidInput, match="written by an older version of the mapper"):
        step_of(Entry("1763800000000-0", {"version": b"12", "frame_id": b"f", "delta": b""}))


@pytest.mark.parametrize("numbers", ["[1, 2]", "{}", "[[", '["a"]'])
def test_a_transform_that_is_none_is_corrupt(numbers: str) -> None:
    entry = written(Step(JoinInput("17-5", "b" * 64, POSE), MapDelta(12, "", StepKind.JOIN)))

    with pytest.raises(Corrupt, match="entry 12-0"):
        step_of(Entry(entry.id, {**entry.fields, "world_from_other": numbers.encode()}))
