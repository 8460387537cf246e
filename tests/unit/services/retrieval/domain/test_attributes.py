from __future__ import annotations

import numpy as np

from services.retrieval.domain.attributes import Subject, can_judge, judge_attributes
from services.retrieval.domain.judgement import Verdict
from services.retrieval.domain.query import parse
from tests.unit.services.retrieval.builders import RED, WHITE, box_at


def subject(color: tuple[int, int, int] = WHITE, side: float = 0.1, likeness: float = 0.0) -> Subject:
    return Subject(np.array(color, float), box_at(0, 0, 0, side), likeness)


def test_without_attributes_everything_is_accepted() -> None:
    assert [j.verdict for j in judge_attributes((), [subject(), subject()])] == [Verdict.ACCEPT] * 2
    assert judge_attributes((), []) == ()


def test_one_wrong_attribute_rejects() -> None:
    small_white, large_white, small_red = judge_attributes(
        parse("large white mug").attributes, [subject(side=0.1), subject(side=0.2), subject(RED, 0.1)]
    )
    assert large_white.verdict is Verdict.ACCEPT
    assert small_white.verdict is Verdict.REJECT
    assert small_red.verdict is Verdict.REJECT


def test_sizes_too_close_to_call_are_not_settled() -> None:
    judgements = judge_attributes(parse("large mug").attributes, [subject(side=0.10), subject(side=0.101)])
    assert {j.verdict for j in judgements} == {Verdict.UNSURE}


def test_a_size_alone_cannot_be_judged() -> None:
    (judgement,) = judge_attributes(parse("small mug").attributes, [subject()])
    assert judgement.verdict is Verdict.UNSURE
    assert judgement.unjudged == ("small",)


def test_tall_measures_height() -> None:
    flat = Subject(np.array(WHITE, float), np.array([0, 0, 0, 2.0, 2.0, 0.1]))
    upright = Subject(np.array(WHITE, float), np.array([0, 0, 0, 0.1, 0.1, 0.5]))
    first, second = judge_attributes(parse("tall lamp").attributes, [flat, upright])
    assert (first.verdict, second.verdict) == (Verdict.REJECT, Verdict.ACCEPT)


def test_what_eyes_must_judge_is_ranked_by_likeness_and_said_so() -> None:
    attributes = parse("floral towel").attributes
    judgements = judge_attributes(attributes, [subject(likeness=0.1), subject(likeness=0.6)])
    assert {j.verdict for j in judgements} == {Verdict.UNSURE}
    assert judgements[1].score > judgements[0].score
    assert judgements[0].unjudged == ("floral",)
    assert not can_judge(attributes)
    assert can_judge(parse("large red mug").attributes)
