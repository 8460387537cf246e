"""Enumeration by a VLM: its words normalised, and the fallback where no VLM answers."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from ovip.errors import DeadlineExceeded, Exhausted, InvalidInput, NotConfigured, OvipError, Unavailable
from ovip.scene.answers import VlmReply
from ovip.scene.types import Frame
from services.perception.adapters import vlm_enumerator
from services.perception.adapters.vlm_enumerator import SCHEMA, VlmEnumerator
from tests.builders import frame


class Vlm:
    """The gateway's client, which answers or fails as told."""

    def __init__(self, *answers: list[str] | Exception) -> None:
        self._answers = list(answers)
        self.asked: list[dict[str, Any]] = []

    async def ask(self, purpose: str, prompt: str, images: Any, schema: Any, **limits: Any) -> VlmReply:
        self.asked.append({"purpose": purpose, "images": images, "schema": schema})
        answer = self._answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return VlmReply({"objects": answer})


class Fallback:
    async def enumerate(self, frame: Frame) -> tuple[str, ...]:
        return ("by the detector",)


async def test_words_are_normalised_sorted_and_each_once() -> None:
    vlm = Vlm(["Coffee Mugs", "chair", "chairs", " ", "..."])

    assert await VlmEnumerator(vlm, None).enumerate(frame()) == ("chair", "coffee mug")  # type: ignore[arg-type]


async def test_the_vlm_gets_the_image_as_it_is_with_the_schema() -> None:
    vlm = Vlm([])
    rgb = np.zeros((48, 64, 3), np.uint8)
    rgb[:] = (200, 30, 30)

    await VlmEnumerator(vlm, None).enumerate(frame(rgb=rgb))  # type: ignore[arg-type]

    (asked,) = vlm.asked
    assert (asked["purpose"], asked["schema"]) == ("enumerate", SCHEMA)
    bgr = cv2.imdecode(np.frombuffer(asked["images"][0], np.uint8), cv2.IMREAD_COLOR)
    assert bgr is not None
    assert bgr[20, 20] == pytest.approx([30, 30, 200], abs=4)


@pytest.mark.parametrize("kind", [NotConfigured, Unavailable, Exhausted, DeadlineExceeded])
async def test_where_no_vlm_answers_the_fallback_names_and_the_vlm_is_left_alone_for_a_while(
    kind: type[OvipError], monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [1000.0]
    monkeypatch.setattr(vlm_enumerator.time, "monotonic", lambda: now[0])
    vlm = Vlm(kind("no"), ["cup"])
    enumerator = VlmEnumerator(vlm, Fallback())  # type: ignore[arg-type]

    assert await enumerator.enumerate(frame()) == ("by the detector",)
    assert await enumerator.enumerate(frame()) == ("by the detector",)
    assert len(vlm.asked) == 1
    now[0] += 61.0
    assert await enumerator.enumerate(frame()) == ("cup",)


async def test_without_a_fallback_the_error_goes_on() -> None:
    with pytest.raises(NotConfigured):
        await VlmEnumerator(Vlm(NotConfigured("no")), None).enumerate(frame())  # type: ignore[arg-type]


async def test_a_refused_question_is_no_reason_to_fall_back() -> None:
    with pytest.raises(InvalidInput):
        await VlmEnumerator(Vlm(InvalidInput("no")), Fallback()).enumerate(frame())  # type: ignore[arg-type]
