"""Masks by SAM 2 prompted with boxes (Ravi et al., ICLR 2025; SPEC 1.4)."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence

import numpy as np
import torch
from transformers import Sam2Model, Sam2Processor

from ovip.scene.types import U8, Bools, Box2, Frame
from services.perception.adapters.full.loading import loading
from services.perception.domain.segmentation import pixels_of

_SETTING = "OVIP_FULL_SEGMENTER"


class Sam2Segmenter:
    """One mask per box, the whole frame encoded once for all of its boxes."""

    def __init__(self, name: str, device: str) -> None:
        with loading(_SETTING, name):
            self._processor = Sam2Processor.from_pretrained(name)
            self._model = Sam2Model.from_pretrained(name).to(device).eval()
        self._device = device
        self._lock = threading.Lock()

    async def segment(self, frame: Frame, boxes: Sequence[Box2]) -> list[Bools]:
        return await asyncio.to_thread(self._segment, frame.rgb, boxes)

    def _segment(self, rgb: U8, boxes: Sequence[Box2]) -> list[Bools]:
        """A box without pixels in the image gets an empty mask."""
        masks = [np.zeros(rgb.shape[:2], dtype=bool) for _ in boxes]
        pixels = [pixels_of(box, rgb.shape) for box in boxes]
        real = [i for i, (x0, y0, x1, y1) in enumerate(pixels) if x0 < x1 and y0 < y1]
        if real:
            for i, mask in zip(real, self._masks(rgb, [pixels[i] for i in real]), strict=True):
                masks[i] = mask
        return masks

    def _masks(self, rgb: U8, boxes: Sequence[tuple[int, int, int, int]]) -> Bools:
        """`(N, H, W)` of N boxes x0 y0 x1 y1."""
        prompts = [[[float(v) for v in box] for box in boxes]]
        inputs = self._processor(images=rgb, input_boxes=prompts, return_tensors="pt")
        with self._lock, torch.inference_mode():
            outputs = self._model(
                pixel_values=inputs["pixel_values"].to(self._device),
                input_boxes=inputs["input_boxes"].to(self._device),
                multimask_output=False,
            )
        full_size = self._processor.post_process_masks(
            outputs.pred_masks.float().cpu(), inputs["original_sizes"]
        )
        return np.asarray(full_size[0][:, 0].numpy(), dtype=bool)
