"""Which models stand behind the seams, by the name of the set (DESIGN 5)."""

from __future__ import annotations

import dataclasses
from collections.abc import Awaitable, Callable, Sequence

from ovip.clients import VlmClient
from ovip.errors import InvalidInput
from ovip.scene.types import F32, Bools, Box2, Frame
from services.perception.adapters import model_cache
from services.perception.adapters.vlm_enumerator import VlmEnumerator
from services.perception.config import Settings
from services.perception.detecting import Models
from services.perception.domain.boxes2d import ScoredBox
from services.perception.domain.segmentation import surface_mask
from services.perception.ports import Enumerator

_Embed = Callable[[Sequence[str]], Awaitable[F32]]


def open_models(settings: Settings, vlm: VlmClient) -> Models:
    """The set that OVIP_MODELS names, loaded, and the second encoder beside it where OVIP_SECOND_ENCODER names one.

    NotConfigured where files or packages are missing.
    """
    return _with_second_encoder(_set_of(settings, vlm), settings)


def _set_of(settings: Settings, vlm: VlmClient) -> Models:
    if settings.models == "given":
        return _given(settings)
    if settings.models == "full":
        from services.perception.adapters.full import open_full

        models = open_full(settings)
    else:
        models = _embedded(settings)
    return _with_enumerator(models, settings, vlm)


def _embedded(settings: Settings) -> Models:
    from services.perception.adapters import embedded

    files = model_cache.require(settings.models_dir)
    detector = embedded.TiledDetector(files, settings.min_confidence)
    return Models(
        name="embedded",
        enumerator=embedded.DetectorEnumerator(detector),
        grounder=embedded.DetectorGrounder(detector),
        segmenter=embedded.SaliencySegmenter(files),
        encoder=embedded.ConseEncoder(files, embedded.MiniLm(files)),
    )


def _given(settings: Settings) -> Models:
    from services.perception.adapters.embedded.minilm import DIMENSION, MiniLm

    texts = MiniLm(model_cache.require(settings.models_dir))
    return Models("given", _NoWords(), _NoBoxes(), _SurfaceSegmenter(), _LabelEncoder(texts.embed, DIMENSION))


def _with_enumerator(models: Models, settings: Settings, vlm: VlmClient) -> Models:
    if settings.enumerator == "detector":
        return models
    fallback: Enumerator | None = models.enumerator if settings.enumerator == "auto" else None
    return dataclasses.replace(models, enumerator=VlmEnumerator(vlm, fallback))


def _with_second_encoder(models: Models, settings: Settings) -> Models:
    if not settings.second_encoder:
        return models
    from services.perception.adapters.full import open_second_encoder

    return dataclasses.replace(models, second_encoder=open_second_encoder(settings))


class _NoWords:
    async def enumerate(self, frame: Frame) -> tuple[str, ...]:
        raise InvalidInput(f"frame {frame.frame_id}: OVIP_MODELS=given expects detections made on board")


class _NoBoxes:
    def groundable(self, word: str) -> bool:
        return False

    async def ground(self, frame: Frame, words: Sequence[str]) -> list[ScoredBox]:
        return []


class _SurfaceSegmenter:
    """Masks by depth alone, for robots that send boxes without masks."""

    async def segment(self, frame: Frame, boxes: Sequence[Box2]) -> list[Bools]:
        return [surface_mask(frame.depth, box) for box in boxes]


class _LabelEncoder:
    """The label's text feature stands for the crop, for robots that send no features."""

    space = "minilm-l6-v2-int8"

    def __init__(self, embed: _Embed, dimension: int) -> None:
        self._embed = embed
        self.dimension = dimension

    async def embed_crops(self, frame: Frame, boxes: Sequence[ScoredBox]) -> F32:
        return await self._embed([box.label for box in boxes])

    async def embed_texts(self, texts: Sequence[str]) -> F32:
        return await self._embed(texts)
