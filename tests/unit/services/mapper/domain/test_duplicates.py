"""Which objects upkeep takes for one, and what keeps it from doing so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from ovip.scene.types import F32, Detection
from services.mapper.domain.duplicates import merge_duplicates
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.domain.records import Changes, ObjectRecord
from services.mapper.domain.upkeep import UpkeepParams
from tests.builders import axis, batch, detection, leaning

PATIENT = MapParams(upkeep=UpkeepParams(confirm_frames=1, eager=False))


def _part(low: float, high: float, label: str = "table", second: F32 | None = None) -> Detection:
    made = detection(label, (low, 0, 0), (high, 0.6, 0.04))
    return made if second is None else replace(made, second_feature=second)


def _halves(first: Detection, second: Detection) -> tuple[ObjectMap, ObjectRecord, ObjectRecord]:
    """A map of two objects; seen in one frame, so that neither joined the other."""
    made = ObjectMap(PATIENT)
    made.integrate(batch(1, first, second))
    one, other = made.table
    return made, one, other


def _left(made: ObjectMap) -> list[str]:
    made.table.changes = Changes(made.version + 1)  # a step of its own
    merge_duplicates(made.table, made.table.dirty.copy(), PATIENT.upkeep)
    return [r.object_id for r in made.table]


def test_two_parts_of_one_name_that_overlap_are_one_thing() -> None:
    made, _, _ = _halves(_part(0, 1), _part(0.5, 1.5))

    assert _left(made) == ["o000001"]


@pytest.mark.parametrize(("cosine", "left"), [(0.31, ["o000001"]), (0.29, ["o000001", "o000002"])])
def test_the_second_encoder_vetoes_what_it_sees_as_different(cosine: float, left: Sequence[str]) -> None:
    """The veto is at a cosine of 0.3 (SPEC 2.6)."""
    made, _, _ = _halves(_part(0, 1, second=axis(0)), _part(0.5, 1.5, second=leaning(0, 1, cosine)))

    assert _left(made) == left


def test_where_only_one_has_a_second_feature_there_is_no_veto() -> None:
    made, _, _ = _halves(_part(0, 1, second=axis(0)), _part(0.5, 1.5))

    assert _left(made) == ["o000001"]


def test_the_one_seen_by_more_frames_stays_unless_the_other_is_pinned() -> None:
    for pinned, left in ((False, "o000001"), (True, "o000002")):
        made, one, other = _halves(_part(0, 1), _part(0.5, 1.5))
        one.frames, other.pinned = 5, pinned

        assert _left(made) == [left]
        assert made.table.resolve("o000001") == made.table.resolve("o000002") == left


def test_two_pinned_objects_never_merge() -> None:
    made, one, other = _halves(_part(0, 1), _part(0.5, 1.5))
    one.pinned = other.pinned = True

    assert len(_left(made)) == 2


def test_what_an_operator_told_apart_stays_apart() -> None:
    made, one, other = _halves(_part(0, 1), _part(0.5, 1.5))
    one.apart = frozenset({other.object_id})

    assert len(_left(made)) == 2


def test_what_is_told_apart_stays_apart_when_one_of_them_takes_in_a_third() -> None:
    """The third was told apart from the second; the first takes over its word."""
    made = ObjectMap(PATIENT)
    made.integrate(batch(1, _part(0, 1), _part(3, 4), _part(0.5, 1.5)))
    one, two, three = made.table
    three.apart, two.apart = frozenset({"o000002"}), frozenset({"o000003"})
    made.table.merge(one, three)

    made.table.set_cloud(two, one.cloud)

    assert _left(made) == ["o000001", "o000002"]


def test_under_two_names_a_part_does_not_merge_with_the_whole() -> None:
    """All of the part lies on the whole, a fifth of the whole on the part."""
    made, _, _ = _halves(_part(0, 1), _part(0.4, 0.6, label="desk"))

    assert len(_left(made)) == 2


def test_under_two_names_what_covers_the_same_merges() -> None:
    made, _, _ = _halves(_part(0, 1), _part(0.1, 1.1, label="desk"))

    assert len(_left(made)) == 1


def test_a_thing_that_is_gone_does_not_merge_with_what_stands_there_now() -> None:
    made, one, _ = _halves(_part(0, 1), _part(0.5, 1.5))
    one.presence = type(one.presence)("moved_or_removed")

    assert len(_left(made)) == 2
