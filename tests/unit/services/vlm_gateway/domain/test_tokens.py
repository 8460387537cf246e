"""Token estimates worked by hand."""

from __future__ import annotations

from services.vlm_gateway.domain.question import Question
from services.vlm_gateway.domain.schema import Schema
from services.vlm_gateway.domain.tokens import estimate_tokens
from tests.unit.services.vlm_gateway.local_upstream import picture


def test_words_cost_a_token_every_three_bytes() -> None:
    # 32 overhead + ceil((28 + 2) / 3) + 100 reply
    assert estimate_tokens(Question.build("x" * 28, (), Schema.parse("{}"), 100), 1024) == 32 + 10 + 100


def test_image_costs_its_patches_after_shrinking() -> None:
    question = Question.build("x" * 28, (picture(640, 480),), Schema.parse("{}"), 100)
    # 640x480 at 28 px: 23 * 18 = 414; shrunk to 320x240: 12 * 9 = 108
    assert estimate_tokens(question, 1024) == 32 + 10 + 414 + 100
    assert estimate_tokens(question, 320) == 32 + 10 + 108 + 100
