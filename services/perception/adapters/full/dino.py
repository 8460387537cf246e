"""Image features of the DINO family (Oquab et al., TMLR 2024), which tell things apart that share a name (SPEC 1.5).

They may only veto merges (SPEC 2.6): there is no text in their space.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from transformers import AutoConfig, AutoImageProcessor, AutoModel

from ovip.errors import NotConfigured
from ovip.scene.features import normalize
from ovip.scene.types import F32, U8, Frame
from services.perception.adapters.full.crops import crop
from services.perception.adapters.full.loading import loading
from services.perception.domain.boxes2d import ScoredBox

_SETTING = "OVIP_SECOND_ENCODER"
_BATCH = 64


class DinoEncoder:
    """Crops in the space of a DINO's class token; one thread at a time in the model."""

    def __init__(self, name: str, device: str) -> None:
        with loading(_SETTING, name):
            kind = AutoConfig.from_pretrained(name).model_type
            if kind != "vit" and not kind.startswith("dino"):  # the first DINO is a plain ViT
                raise NotConfigured(
                    f"{_SETTING}: expected a model of the DINO family; {name!r} is of type {kind}"
                )
            self._processor = AutoImageProcessor.from_pretrained(name)
            self._model = AutoModel.from_pretrained(name).to(device).eval()
        self.space = f"dino:{Path(name).name if Path(name).is_dir() else name}"
        self._device = device
        self._lock = threading.Lock()
        with torch.inference_mode():
            self.dimension = self._embed([np.zeros((32, 32, 3), np.uint8)]).shape[1]

    async def embed_crops(self, frame: Frame, boxes: Sequence[ScoredBox]) -> F32:
        return await asyncio.to_thread(self.embed_images_now, [crop(frame.rgb, box) for box in boxes])

    def embed_images_now(self, images: Sequence[U8]) -> F32:
        """Unit features `(N, D)` of whole images."""
        if not images:
            return np.zeros((0, self.dimension), np.float32)
        with self._lock, torch.inference_mode():
            parts = [self._embed(images[at : at + _BATCH]) for at in range(0, len(images), _BATCH)]
        return normalize(np.concatenate(parts))

    def _embed(self, images: Sequence[U8]) -> F32:
        inputs = self._processor(images=list(images), return_tensors="pt", input_data_format="channels_last")
        output = self._model(pixel_values=inputs["pixel_values"].to(self._device))
        # not `pooler_output`: the first DINO's weights have no pooler, and it would be random
        return np.asarray(output.last_hidden_state[:, 0].float().cpu().numpy(), np.float32)
