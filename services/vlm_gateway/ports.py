"""The seams of the gateway: an upstream that answers, and the limits that admit a question to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from services.vlm_gateway.domain.question import Purpose, Question


@dataclass(frozen=True, slots=True)
class Completion:
    """What a model replied, and the tokens it says that took."""

    text: str
    prompt_tokens: int = 0
    output_tokens: int = 0


@dataclass(frozen=True, slots=True)
class Failure:
    """Why an upstream gave no reply. retry_after: seconds it asked to be left alone, where it did."""

    reason: str
    kind: str
    retryable: bool = False
    retry_after: float | None = None


@dataclass(frozen=True, slots=True)
class Correction:
    """A reply that broke the schema, and the words that ask for a better one."""

    reply: str
    request: str


class Upstream(Protocol):
    """One VLM endpoint."""

    name: str
    model: str
    image_max_side: int

    async def complete(
        self, question: Question, correction: Correction | None, timeout_s: float
    ) -> Completion | Failure:
        """Asks once, within `timeout_s` seconds; a fault of the upstream is a Failure, never an exception."""
        ...


class Admission(Protocol):
    """The limits of one upstream: requests and tokens a minute, and how many at once."""

    async def enter(self, purpose: Purpose, tokens: int, until: float) -> float:
        """Waits for room, the urgent first; 0.0 once inside, else the seconds until there may be room.

        until: the clock reading after which it is too late. TooLarge where `tokens` can never fit.
        """
        ...

    def leave(self) -> None:
        """Gives back the place of an `enter` that returned 0.0."""
        ...

    def pause(self, seconds: float) -> None:
        """Lets nobody in for a while, because the upstream asked for it."""
        ...
