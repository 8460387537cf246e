"""Questions and the fingerprints their answers are kept under."""

from __future__ import annotations

import pytest

from ovip.errors import InvalidInput
from services.vlm_gateway.domain.question import Question, fingerprint
from services.vlm_gateway.domain.schema import Schema
from tests.unit.services.vlm_gateway.local_upstream import picture

MODELS = (("kimi", "kimi-k2.6"),)
WORDS = Schema.parse('{"type": "array", "items": {"type": "string"}}')


def ask(
    prompt: str = "what is here?", images: tuple[bytes, ...] = (), schema: Schema = WORDS, n: int = 100
) -> Question:
    return Question.build(prompt, images, schema, n)


def test_same_question_has_the_same_fingerprint() -> None:
    assert fingerprint(ask(images=(picture(8, 6),)), MODELS) == fingerprint(
        ask(images=(picture(8, 6),)), MODELS
    )


def test_schema_spelled_otherwise_is_the_same_question() -> None:
    spelled = Schema.parse('{"items":{"type":"string"},   "type":"array"}')
    assert fingerprint(ask(schema=spelled), MODELS) == fingerprint(ask(), MODELS)


@pytest.mark.parametrize(
    "other",
    [
        ask("what is there?"),
        ask(images=(picture(8, 6),)),
        ask(schema=Schema.parse("{}")),
        ask(n=101),
    ],
)
def test_anything_that_shapes_the_reply_changes_the_fingerprint(other: Question) -> None:
    assert fingerprint(other, MODELS) != fingerprint(ask(), MODELS)


def test_order_of_images_matters() -> None:
    a, b = picture(8, 6), picture(6, 8)
    assert fingerprint(ask(images=(a, b)), MODELS) != fingerprint(ask(images=(b, a)), MODELS)


def test_another_model_does_not_serve_old_answers() -> None:
    assert fingerprint(ask(), MODELS) != fingerprint(ask(), (("kimi", "kimi-k3"),))


def test_empty_prompt_is_refused() -> None:
    with pytest.raises(InvalidInput, match="prompt is empty"):
        ask(" \n")


def test_bad_image_is_named_by_its_place() -> None:
    with pytest.raises(InvalidInput, match="image 2"):
        ask(images=(picture(8, 6), b"GIF89a"))
