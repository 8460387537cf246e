"""The seams of regions: the map, text features, a VLM, and who names the functions of objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from ovip.scene.answers import VlmReply
from ovip.scene.types import F32, SceneMap
from services.regions.domain.assembly import PlacedObjects


class MapReader(Protocol):
    """The mapper."""

    async def get_map(self, scene: str) -> SceneMap:
        """The confirmed objects of a scene as they stand."""
        ...


class TextEncoder(Protocol):
    """Perception's text features."""

    async def embed_text(self, texts: Sequence[str]) -> F32:
        """Unit features `(N, D)`."""
        ...


class Vlm(Protocol):
    """The VLM gateway."""

    async def ask(
        self,
        purpose: str,
        prompt: str,
        *,
        schema: dict[str, Any] | None = None,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
    ) -> VlmReply:
        """A reply that satisfies `schema`; an OvipError where there is none to be had. Zeros: the gateway's own."""
        ...


@dataclass(frozen=True, slots=True)
class Grouping:
    """The function of each object asked about, in order, and which fallbacks took part.

    told: which of them a VLM named; none where it is empty.
    """

    functions: tuple[str, ...]
    fallbacks: tuple[str, ...] = ()
    told: tuple[bool, ...] = ()


class Grouper(Protocol):
    """Names the functions of one floor's objects (Algorithm 1 line 5)."""

    async def group(self, objects: PlacedObjects) -> Grouping:
        """A function for each object, "unknown" allowed; an OvipError where it cannot."""
        ...
