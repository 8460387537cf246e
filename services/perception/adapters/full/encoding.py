"""Image and text features of the CLIP family, through transformers or open_clip (SPEC 1.5)."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from transformers import AutoModel, AutoProcessor

from ovip.errors import NotConfigured
from ovip.scene.features import normalize
from ovip.scene.types import F32, U8, Frame
from services.perception.adapters.full.crops import crop
from services.perception.adapters.full.loading import loading
from services.perception.domain.boxes2d import ScoredBox

_SETTING = "OVIP_FULL_ENCODER"
_OPEN_CLIP = ("hf-hub:", "local-dir:")
_BATCH = 64


class TwoTowers(Protocol):
    """A model with an image tower and a text tower into one space. scale: of cosines to logits."""

    scale: float

    def images(self, images: Sequence[U8]) -> F32:
        """Features `(N, D)` of `(h, w, 3)` RGB images."""
        ...

    def texts(self, texts: Sequence[str]) -> F32:
        """Features `(N, D)` of texts, cut at the model's context length."""
        ...


def open_encoder(name: str, device: str) -> ClipEncoder:
    """`hf-hub:NAME` and `local-dir:PATH` through open_clip, anything else through transformers."""
    with loading(_SETTING, name):
        towers: TwoTowers = OpenClip(name, device) if name.startswith(_OPEN_CLIP) else HubClip(name, device)
    return ClipEncoder(towers, f"clip:{Path(name).name if Path(name).is_dir() else name}")


class ClipEncoder:
    """Crops and texts in one CLIP space; one thread at a time in the model."""

    def __init__(self, towers: TwoTowers, space: str) -> None:
        self.space = space
        self.scale = towers.scale
        self.dimension = towers.texts(["thing"]).shape[1]
        self._towers = towers
        self._lock = threading.Lock()

    async def embed_crops(self, frame: Frame, boxes: Sequence[ScoredBox]) -> F32:
        return await asyncio.to_thread(self.embed_images_now, [crop(frame.rgb, box) for box in boxes])

    async def embed_texts(self, texts: Sequence[str]) -> F32:
        return await asyncio.to_thread(self.embed_texts_now, texts)

    def embed_images_now(self, images: Sequence[U8]) -> F32:
        """Unit features `(N, D)` of whole images."""
        return self._in_batches(self._towers.images, images)

    def embed_texts_now(self, texts: Sequence[str]) -> F32:
        """Unit features `(N, D)`."""
        return self._in_batches(self._towers.texts, texts)

    def _in_batches(self, embed: Any, items: Sequence[Any]) -> F32:
        if not items:
            return np.zeros((0, self.dimension), np.float32)
        with self._lock, torch.inference_mode():
            parts = [embed(items[at : at + _BATCH]) for at in range(0, len(items), _BATCH)]
        return normalize(np.concatenate(parts))


class HubClip:
    """CLIP or SigLIP weights in transformers' own format."""

    def __init__(self, name: str, device: str) -> None:
        self._device = device
        self._processor = AutoProcessor.from_pretrained(name)
        self._model = AutoModel.from_pretrained(name).to(device).eval()
        if not hasattr(self._model, "get_text_features"):
            kind = self._model.config.model_type
            raise NotConfigured(
                f"{_SETTING}: expected a model of images and texts; {name!r} is of type {kind}"
            )
        self.scale = float(self._model.logit_scale.detach().exp())

    def images(self, images: Sequence[U8]) -> F32:
        inputs = self._processor(images=list(images), return_tensors="pt", input_data_format="channels_last")
        return _features(self._model.get_image_features(pixel_values=inputs["pixel_values"].to(self._device)))

    def texts(self, texts: Sequence[str]) -> F32:
        inputs = self._processor(text=list(texts), return_tensors="pt", padding="max_length", truncation=True)
        on_device = {name: value.to(self._device) for name, value in inputs.items()}
        with torch.inference_mode():
            return _features(self._model.get_text_features(**on_device))


class OpenClip:
    """Weights in open_clip's format (Ilharco et al.; Cherti et al., CVPR 2023)."""

    def __init__(self, name: str, device: str) -> None:
        import open_clip
        from PIL import Image

        self._device = device
        self._picture = Image.fromarray
        self._model, self._transform = open_clip.create_model_from_pretrained(name, device=device)
        self._model.eval()
        self._tokenizer = open_clip.get_tokenizer(name)
        self.scale = float(self._model.logit_scale.detach().exp())

    def images(self, images: Sequence[U8]) -> F32:
        pixels = torch.stack([self._transform(self._picture(image)) for image in images])
        return _features(self._model.encode_image(pixels.to(self._device)))

    def texts(self, texts: Sequence[str]) -> F32:
        with torch.inference_mode():
            return _features(self._model.encode_text(self._tokenizer(list(texts)).to(self._device)))


def _features(output: Any) -> F32:
    """transformers 5 wraps the features, transformers 4 and open_clip do not."""
    return np.asarray(getattr(output, "pooler_output", output).float().cpu().numpy(), np.float32)
