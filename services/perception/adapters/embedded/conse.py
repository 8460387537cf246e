"""Image features without CLIP: class posteriors as a convex sum of word features (ConSE, Norouzi et al. 2013)."""

from __future__ import annotations

import asyncio
import hashlib
import os
import threading
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from ai_edge_litert.interpreter import Interpreter

from ovip.scene.features import normalize
from ovip.scene.types import F32, U8, Frame
from ovip.scene.words import normalize_word
from services.perception.adapters.embedded.minilm import DIMENSION, MiniLm
from services.perception.domain.boxes2d import ScoredBox
from services.perception.domain.segmentation import pixels_of

_TOP = 10  # classes in the combination, as in the paper
_MARGIN = 0.1  # context around the box, share of its size


class ConseEncoder:
    """Crops and texts in MiniLM's space.

    f = t(label) * w + (1 - w) * sum_k p_k t(class_k) over the ten best ImageNet classes, unit length. The
    posterior of this small classifier is weak on crops (7 of 15 photographs right among 25 words), so the
    detector's label weighs `label_weight`, three quarters by default.
    """

    space = "minilm-l6-v2-int8+conse"
    dimension = DIMENSION

    def __init__(self, models: Path, texts: MiniLm, label_weight: float = 0.75) -> None:
        self._texts = texts
        self._label_weight = label_weight
        self._lock = threading.Lock()
        self._net = Interpreter(str(models / "efficientnet_lite3.tflite"), num_threads=1)
        self._net.allocate_tensors()
        self._input, self._output = self._net.get_input_details()[0], self._net.get_output_details()[0]
        self._side = int(self._input["shape"][1])
        lines = (models / "imagenet_labels.txt").read_text().splitlines()
        self._classes = [normalize_word(line.split(",")[0]) for line in lines if line.strip()]
        self._class_features: F32 | None = None
        self._kept = (
            models
            / f"imagenet_words-{hashlib.sha256(chr(10).join(self._classes).encode()).hexdigest()[:12]}.npy"
        )

    async def embed_crops(self, frame: Frame, boxes: Sequence[ScoredBox]) -> F32:
        return await asyncio.to_thread(self._embed_crops, frame, boxes)

    async def embed_texts(self, texts: Sequence[str]) -> F32:
        return await self._texts.embed(texts)

    def _embed_crops(self, frame: Frame, boxes: Sequence[ScoredBox]) -> F32:
        if not boxes:
            return np.zeros((0, DIMENSION), np.float32)
        labels = self._texts.embed_now([box.label for box in boxes])
        looks = np.stack([self._look(frame.rgb, box) for box in boxes])
        mixed: F32 = np.asarray(self._label_weight * labels + (1 - self._label_weight) * looks, np.float32)
        return normalize(mixed)

    def _look(self, rgb: U8, box: ScoredBox) -> F32:
        posterior = self._posterior(_crop(rgb, box))
        best = np.argsort(-posterior, kind="stable")[:_TOP]
        weights: F32 = posterior[best] / np.float32(max(float(posterior[best].sum()), 1e-9))
        return normalize(np.asarray(weights @ self._features()[best], np.float32))

    def _posterior(self, crop: U8) -> F32:
        with self._lock:
            image = cv2.resize(crop, (self._side, self._side), interpolation=cv2.INTER_AREA)
            self._net.set_tensor(self._input["index"], image[None].astype(np.uint8))
            self._net.invoke()
            scale, zero = self._output["quantization"]
            raw = self._net.get_tensor(self._output["index"])[0]
        return np.asarray((raw.astype(np.float32) - zero) * scale, np.float32)

    def _features(self) -> F32:
        """Text features of the classes `(1000, D)`: seconds to make, so they are kept beside the models."""
        if self._class_features is None:
            self._class_features = _read(self._kept, len(self._classes))
        if self._class_features is None:
            self._class_features = self._texts.embed_now(self._classes)
            _keep(self._kept, self._class_features)
        return self._class_features


def _read(path: Path, rows: int) -> F32 | None:
    try:
        features = np.load(path)
    except (OSError, ValueError):
        return None
    good = features.shape == (rows, DIMENSION) and features.dtype == np.float32
    return features if good else None


def _keep(path: Path, features: F32) -> None:
    aside = path.with_name(f".{path.name}.{os.getpid()}.npy")
    try:
        np.save(aside, features)
        aside.rename(path)
    except OSError:  # a read-only model directory: the next process makes them again
        return


def _crop(rgb: U8, box: ScoredBox) -> U8:
    x0, y0, x1, y1 = pixels_of(box.box, rgb.shape)
    dx, dy = round(_MARGIN * (x1 - x0)), round(_MARGIN * (y1 - y0))
    return rgb[max(y0 - dy, 0) : y1 + dy, max(x0 - dx, 0) : x1 + dx]
