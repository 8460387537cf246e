"""The seams of retrieval: what it asks of the map, the frames, the regions and a VLM, and where searches are
kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from ovip.scene.answers import Answer, FrameRecord, PerceptionStatus, VlmReply
from ovip.scene.grid import FloorGrid
from ovip.scene.types import F32, Box2, Detection, Partition, SceneMap
from services.retrieval.domain.search import Search


class Scenes(Protocol):
    """Which scenes there are."""

    async def scenes(self) -> list[str]:
        """Their names."""
        ...


class Maps(Protocol):
    """The objects of a scene."""

    async def get_map(self, scene: str, include_unconfirmed: bool = False) -> SceneMap:
        """The map as it stands; NotFound where the scene has none."""
        ...


class Frames(Protocol):
    """The frame history."""

    async def list_frames(
        self, scene: str, after: str = "", limit: int = 0
    ) -> tuple[list[FrameRecord], dict[str, F32]]:
        """Frames after a log id in order of arrival, and the text feature of every tag among them."""
        ...

    async def get_frame_record(self, scene: str, frame_id: str) -> FrameRecord:
        """One frame without its images; NotFound where there is none."""
        ...

    async def get_rgb(self, scene: str, frame_id: str) -> bytes:
        """Its colour image, JPEG or PNG."""
        ...

    async def status(self, scene: str) -> PerceptionStatus:
        """Where perception stands, with the name of its text space."""
        ...


class Grounder(Protocol):
    """Finds words in frames, and puts words into the space of image features."""

    async def ground(
        self, scene: str, frame_ids: Sequence[str], words: Sequence[str]
    ) -> tuple[dict[str, tuple[Detection, ...]], tuple[str, ...]]:
        """Detections by frame, and the words that it has no way to see."""
        ...

    async def embed_text(self, texts: Sequence[str]) -> F32:
        """Unit text features `(N, D)`."""
        ...


class Regions(Protocol):
    """The partition of the floors and their grids."""

    async def get_partition(self, scene: str) -> Partition:
        """The newest partition; without regions before the first."""
        ...

    async def get_floor_grid(self, scene: str, floor: int) -> FloorGrid:
        """One storey's grid; NotFound where there is none."""
        ...


class Vlm(Protocol):
    """The VLM gateway."""

    async def ask(
        self,
        purpose: str,
        prompt: str,
        images: Sequence[bytes] = (),
        schema: dict[str, Any] | None = None,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
    ) -> VlmReply:
        """A reply that satisfies `schema`; NotConfigured where there is no upstream."""
        ...


class Crops(Protocol):
    """Cuts crops out of encoded images."""

    async def crop(self, image: bytes, box: Box2) -> bytes:
        """The box with some of what is around it, as JPEG; Corrupt where the image does not decode."""
        ...


@dataclass(frozen=True, slots=True)
class StoredSearch:
    """A search with the revision that a change must be made on."""

    scene: str
    search: Search
    revision: int


class Searches(Protocol):
    """Where searches are kept, so that any replica can go on with them."""

    async def load(self, scene: str, search_id: str) -> StoredSearch:
        """NotFound where there is none."""
        ...

    async def save(self, stored: StoredSearch) -> StoredSearch:
        """Writes a change made on `stored.revision` (0: new); Conflict where it has moved on since."""
        ...

    async def remember(self, scene: str, search_id: str, text: str, answer: Answer) -> None:
        """Keeps a plain question's answer for a while."""
        ...

    async def recall(self, scene: str, search_id: str) -> tuple[str, Answer] | None:
        """What `remember` kept, or None."""
        ...
