"""The VLM within one question's budget: counts calls, stays closed once there is no VLM, lists the fallbacks
taken.
"""

from __future__ import annotations

from collections.abc import Sequence

from ovip.errors import (
    Corrupt,
    DeadlineExceeded,
    Exhausted,
    InvalidInput,
    NotConfigured,
    OvipError,
    Unavailable,
)
from services.retrieval.domain.questions import Question
from services.retrieval.ports import Vlm

UNANSWERED = (NotConfigured, Unavailable, Exhausted, DeadlineExceeded, InvalidInput, Corrupt)
"""What a question to the VLM may end in that has a fallback."""


class VlmBudget:
    """One question's way to the VLM. calls: made so far, over all replicas. fallbacks: each taken, once."""

    def __init__(self, vlm: Vlm, budget: int, spent: int = 0) -> None:
        self._vlm = vlm
        self._budget = budget
        self._closed = ""
        self.calls = spent
        self.fallbacks: list[str] = []

    async def ask(self, question: Question, images: Sequence[bytes] = ()) -> object:
        """The reply's JSON value; raises one of UNANSWERED where there is none to be had."""
        self.check_open()
        try:
            reply = await self._vlm.ask("search", question.prompt, images, question.schema)
        except (NotConfigured, Unavailable) as error:
            self._closed = _reason(error)
            raise
        except OvipError:
            self.calls += 1
            raise
        self.calls += 1
        return reply.value

    def check_open(self) -> None:
        """Unavailable where there is no VLM, Exhausted where the budget is used up: before images are
        fetched.
        """
        if self._closed:
            raise Unavailable(self._closed)
        if self.calls >= self._budget:
            raise Exhausted(f"the question's {self._budget} VLM calls are used up")

    def fell_back(self, what: str, error: OvipError) -> None:
        """Notes a fallback and why it was taken."""
        text = f"{what}, {self._closed or _reason(error)}"
        if text not in self.fallbacks:
            self.fallbacks.append(text)


def _reason(error: OvipError) -> str:
    if isinstance(error, NotConfigured):
        return "no VLM configured"
    return f"no VLM answer ({error})"
