"""What is asked of a VLM, and the fingerprint under which its answer is kept."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from ovip.errors import InvalidInput
from services.vlm_gateway.domain.images import ImageSize, image_size
from services.vlm_gateway.domain.schema import Schema


class Purpose(StrEnum):
    """Who waits for the answer, most urgent first: a robot, the frame pipeline, the region partition."""

    SEARCH = "search"
    ENUMERATE = "enumerate"
    GROUP = "group"


@dataclass(frozen=True, slots=True)
class Question:
    """A prompt with images and the JSON Schema that the reply must satisfy.

    images: encoded JPEG or PNG bytes. sizes: their widths and heights in pixels, read from their headers.
    """

    prompt: str
    images: tuple[bytes, ...]
    sizes: tuple[ImageSize, ...]
    schema: Schema
    max_output_tokens: int

    @classmethod
    def build(cls, prompt: str, images: Sequence[bytes], schema: Schema, max_output_tokens: int) -> Question:
        """A checked question; raises InvalidInput on an empty prompt or an image that is none."""
        if not prompt.strip():
            raise InvalidInput("the prompt is empty; expected a question in words")
        return cls(prompt, tuple(images), _sizes(images), schema, max_output_tokens)


def fingerprint(question: Question, models: Iterable[tuple[str, str]]) -> str:
    """SHA-256 (hex) over everything that shapes the reply: the words, images, schema, length and `models`.

    models: `(route name, model)` in fallback order, so that a change of models does not serve old answers.
    The purpose is left out: who asks does not change the answer.
    """
    parts = {
        "prompt": question.prompt,
        "images": [hashlib.sha256(image).hexdigest() for image in question.images],
        "schema": question.schema.text,
        "max_output_tokens": question.max_output_tokens,
        "models": [list(pair) for pair in models],
    }
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def _sizes(images: Sequence[bytes]) -> tuple[ImageSize, ...]:
    return tuple(image_size(image, f"image {number}") for number, image in enumerate(images, start=1))
