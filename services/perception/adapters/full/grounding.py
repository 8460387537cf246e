"""Open-vocabulary detectors: Grounding DINO by phrases, OWLv2 and OmDet-Turbo by queries (SPEC 1.3)."""

from __future__ import annotations

import asyncio
import threading
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from transformers import AutoConfig, AutoModelForZeroShotObjectDetection, AutoProcessor

from ovip.errors import NotConfigured
from ovip.scene.types import F32, I64, U8, Box2, Frame
from services.perception.adapters.full.calibration import Calibration
from services.perception.adapters.full.loading import loading
from services.perception.adapters.full.prompts import Prompt, prompts_of, token_masks, word_scores
from services.perception.domain.boxes2d import ScoredBox, suppress
from services.perception.ports import Grounder

_SETTING = "OVIP_FULL_GROUNDER"

# Each backend's own threshold: the default of its post-processing in transformers (docs/models.md).
_BY_PHRASES = {"grounding-dino": Calibration(0.25), "mm-grounding-dino": Calibration(0.25)}
_BY_QUERIES = {"owlv2": Calibration(0.1), "owlvit": Calibration(0.1), "omdet-turbo": Calibration(0.3)}
_QUERY_TEXTS = {"owlv2": "a photo of a {}", "owlvit": "a photo of a {}", "omdet-turbo": "{}"}


def open_grounder(name: str, device: str, min_confidence: float) -> Grounder:
    """The detector of hub name or directory `name`; NotConfigured for a type of model not known here."""
    with loading(_SETTING, name):
        kind = AutoConfig.from_pretrained(name).model_type
    if kind in _BY_PHRASES:
        return PhraseGrounder(name, device, min_confidence, _BY_PHRASES[kind])
    if kind in _BY_QUERIES:
        return QueryGrounder(name, device, min_confidence, _BY_QUERIES[kind], _QUERY_TEXTS[kind])
    known = ", ".join(sorted({**_BY_PHRASES, **_BY_QUERIES}))
    raise NotConfigured(f"{_SETTING}: expected a model of type {known}; {name!r} is of type {kind}")


class _Detector(ABC):
    """The model and its processor, asked from one thread at a time."""

    def __init__(self, name: str, device: str, min_confidence: float, calibration: Calibration) -> None:
        with loading(_SETTING, name):
            self._processor = AutoProcessor.from_pretrained(name)
            self._model = AutoModelForZeroShotObjectDetection.from_pretrained(name).to(device).eval()
        self._device = device
        self._min_confidence = min_confidence
        self._calibration = calibration
        self._lock = threading.Lock()

    def groundable(self, word: str) -> bool:
        """Any word can be looked for."""
        return bool(word.strip())

    async def ground(self, frame: Frame, words: Sequence[str]) -> list[ScoredBox]:
        wanted = list(dict.fromkeys(word for word in words if word.strip()))
        return await asyncio.to_thread(self._ground, frame.rgb, wanted) if wanted else []

    def _ground(self, rgb: U8, words: Sequence[str]) -> list[ScoredBox]:
        with self._lock, torch.inference_mode():
            return suppress(self._look(rgb, words))

    @abstractmethod
    def _look(self, rgb: U8, words: Sequence[str]) -> list[ScoredBox]:
        """Boxes of the words, things more than once."""

    def _kept(self, words: Sequence[str], index: I64, scores: F32, corners: F32, rgb: U8) -> list[ScoredBox]:
        """Boxes `(N, 4)` x0 y0 x1 y1 pixels of words `index` `(N,)`, confident enough, inside the image."""
        height, width = rgb.shape[:2]
        confidence = self._calibration.confidence(scores)
        inside = np.clip(corners, 0.0, [width, height, width, height])
        return [
            ScoredBox(words[index[i]], float(confidence[i]), Box2(*(float(v) for v in inside[i])))
            for i in np.flatnonzero(confidence >= self._min_confidence)
            if inside[i, 0] < inside[i, 2] and inside[i, 1] < inside[i, 3]
        ]


class PhraseGrounder(_Detector):
    """Grounding DINO (Liu et al., ECCV 2024): the words as one prompt, a score for each token of it.

    A box belongs to the word whose tokens score best on average, so its label is always one of the words
    asked for; the phrases that the processor cuts out of the prompt can be parts of two words.
    """

    def _look(self, rgb: U8, words: Sequence[str]) -> list[ScoredBox]:
        longest = int(self._model.config.max_text_len)
        prompts = prompts_of(words, longest, lambda text: len(self._processor.tokenizer(text)["input_ids"]))
        return [box for prompt in prompts for box in self._look_for(rgb, prompt)]

    def _look_for(self, rgb: U8, prompt: Prompt) -> list[ScoredBox]:
        inputs = _inputs(self._processor(images=rgb, text=prompt.text, return_tensors="pt"), self._device)
        outputs = self._model(**inputs)
        offsets = self._processor.tokenizer(prompt.text, return_offsets_mapping=True)["offset_mapping"]
        masks = token_masks(prompt.spans, offsets)
        token_scores = _numpy(outputs.logits[0].sigmoid())[:, : masks.shape[1]]
        scores = word_scores(token_scores, masks[:, : token_scores.shape[1]])
        best = scores.argmax(axis=1)
        corners = _corners(_numpy(outputs.pred_boxes[0]), rgb)
        return self._kept(prompt.words, best, scores[np.arange(len(best)), best], corners, rgb)


class QueryGrounder(_Detector):
    """OWLv2 (Minderer et al., NeurIPS 2023), OWL-ViT, OmDet-Turbo (Zhao et al., 2024): a query a word."""

    def __init__(
        self, name: str, device: str, min_confidence: float, calibration: Calibration, query_text: str
    ) -> None:
        super().__init__(name, device, min_confidence, calibration)
        self._query_text = query_text

    def _look(self, rgb: U8, words: Sequence[str]) -> list[ScoredBox]:
        queries = [self._query_text.format(word) for word in words]
        inputs = _inputs(self._processor(images=rgb, text=[queries], return_tensors="pt"), self._device)
        outputs = self._model(**inputs)
        found = self._processor.post_process_grounded_object_detection(
            outputs=outputs, threshold=0.0, target_sizes=[rgb.shape[:2]]
        )[0]
        return self._kept(
            words,
            _numpy(found["labels"]).astype(np.int64),
            _numpy(found["scores"]),
            _numpy(found["boxes"]),
            rgb,
        )


def _inputs(encoding: Any, device: str) -> Any:
    return {name: value.to(device) for name, value in encoding.items()}


def _numpy(tensor: Any) -> F32:
    return np.asarray(tensor.float().cpu().numpy(), np.float32)


def _corners(relative: F32, rgb: U8) -> F32:
    """`(N, 4)` centre x, centre y, width, height in shares of the image -> x0 y0 x1 y1 in pixels."""
    height, width = rgb.shape[:2]
    center, half = relative[:, :2], relative[:, 2:] / 2
    corners = np.concatenate([center - half, center + half], axis=1)
    return np.asarray(corners * np.array([width, height, width, height]), np.float32)
