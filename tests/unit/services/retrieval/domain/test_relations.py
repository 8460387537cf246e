from __future__ import annotations

import numpy as np
import pytest

from services.retrieval.domain.judgement import Verdict
from services.retrieval.domain.query import parse
from services.retrieval.domain.relations import judge_relation

TABLE = np.array([0.0, 0.0, 0.0, 2.0, 1.0, 0.75])
CHAIR = np.array([0.0, 0.0, 0.0, 0.5, 0.5, 1.0])
NONE = np.zeros((0, 6))


def on_top(z: float, x: float = 0.5) -> np.ndarray:
    return np.array([x, 0.4, z, x + 0.1, 0.5, z + 0.1])


@pytest.mark.parametrize(
    ("text", "box", "anchor", "verdict"),
    [
        ("cup on the table", on_top(0.75), TABLE, Verdict.ACCEPT),
        ("cup on the table", on_top(0.85), TABLE, Verdict.ACCEPT),
        ("cup on the table", on_top(1.2), TABLE, Verdict.REJECT),
        ("cup on the table", on_top(0.1), TABLE, Verdict.REJECT),
        ("cup on the table", on_top(0.75, x=3.0), TABLE, Verdict.REJECT),
        ("bag on the chair", on_top(0.45, x=0.2), CHAIR, Verdict.ACCEPT),
        ("box under the table", on_top(0.0), TABLE, Verdict.ACCEPT),
        ("box under the table", on_top(0.8), TABLE, Verdict.REJECT),
        ("clock above the table", on_top(1.6), TABLE, Verdict.ACCEPT),
        ("cup next to the table", on_top(0.5, x=2.2), TABLE, Verdict.ACCEPT),
        ("cup next to the table", on_top(0.5, x=3.5), TABLE, Verdict.REJECT),
        ("cup next to the table", on_top(0.75), TABLE, Verdict.REJECT),
        ("spoon in the table", on_top(0.3), TABLE, Verdict.ACCEPT),
        ("spoon in the table", on_top(0.7), TABLE, Verdict.REJECT),
    ],
)
def test_boxes_tell_relations(text: str, box: np.ndarray, anchor: np.ndarray, verdict: Verdict) -> None:
    assert judge_relation(parse(text).relations[0], box, anchor[None]).verdict is verdict


def test_behind_depends_on_where_one_stands() -> None:
    judgement = judge_relation(parse("cup behind the table").relations[0], on_top(0.75), TABLE[None])
    assert judgement.verdict is Verdict.UNSURE
    assert judgement.unjudged == ("behind the table",)


def test_without_the_anchor_in_the_map_nothing_is_settled() -> None:
    judgement = judge_relation(parse("cup on the table").relations[0], on_top(0.75), NONE)
    assert judgement.verdict is Verdict.UNSURE


def test_the_best_of_several_anchors_counts() -> None:
    far = TABLE + np.array([9.0, 0, 0, 9.0, 0, 0])
    relation = parse("cup on the table").relations[0]
    assert judge_relation(relation, on_top(0.75), np.stack([far, TABLE])).verdict is Verdict.ACCEPT
