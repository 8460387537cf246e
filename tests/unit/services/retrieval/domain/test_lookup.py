from __future__ import annotations

from ovip.scene.answers import TierResult
from services.retrieval.domain.lookup import look_up, unsettled
from services.retrieval.domain.query import parse
from tests.unit.services.retrieval.builders import box_at, mapped

CUP = mapped("o1", "cup", box_at(0, 0, 1))


def test_one_instance_and_no_attribute_is_found() -> None:
    lookup = look_up(parse("mug"), [CUP, mapped("o2", "chair", box_at(1, 0, 0))])
    assert lookup.result is TierResult.FOUND
    assert [match.object.object_id for match in lookup.matches] == ["o1"]
    assert "'cup'" in lookup.why
    assert "'mug'" in lookup.why


def test_an_attribute_goes_to_judgement_though_there_is_one_instance() -> None:
    lookup = look_up(parse("white mug"), [CUP])
    assert lookup.result is TierResult.AMBIGUOUS
    assert "'white'" in lookup.why


def test_a_relation_goes_to_judgement() -> None:
    assert look_up(parse("mug on the table"), [CUP]).result is TierResult.AMBIGUOUS


def test_equal_instances_go_to_judgement_best_seen_first() -> None:
    seen = [
        mapped(f"o{k}", "chair", box_at(k, 0, 0), frames=frames) for k, frames in enumerate([3, 40, 12, 5])
    ]
    lookup = look_up(parse("chair"), seen)
    assert lookup.result is TierResult.AMBIGUOUS
    assert [match.object.object_id for match in lookup.matches] == ["o1", "o2", "o3", "o0"]
    assert "4 objects" in lookup.why


def test_a_missing_class_names_what_came_nearest() -> None:
    lookup = look_up(parse("piano"), [CUP])
    assert lookup.result is TierResult.MISSING
    assert "'piano'" in lookup.why


def test_an_empty_map_is_missing_not_an_error() -> None:
    assert look_up(parse("mug"), []).result is TierResult.MISSING


def test_words_that_the_name_lacks_are_left_to_be_judged() -> None:
    lookup = look_up(parse("high chair"), [mapped("o1", "chair", box_at(0, 0, 0))])
    assert lookup.result is TierResult.AMBIGUOUS
    assert [attribute.word for attribute in unsettled(parse("high chair"), lookup.matches[0])] == ["high"]


def test_equal_scores_are_ordered_by_id() -> None:
    lookup = look_up(parse("chair"), [mapped(i, "chair", box_at(0, 0, 0)) for i in ("b", "a", "c")])
    assert [match.object.object_id for match in lookup.matches] == ["a", "b", "c"]
