"""Masks by U2NetP on the box's crop, gated by depth; by depth alone where the salient thing is not the box's."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import onnxruntime

from ovip.scene.types import F32, U8, Bools, Box2, Frame
from services.perception.domain.segmentation import pixels_of, surface_mask

_SIDE = 320
_MARGIN = 0.15
_MEAN, _STD = np.array([0.485, 0.456, 0.406]), np.array([0.229, 0.224, 0.225])
_SALIENT = 0.5
_FILLS = 0.35  # the salient part must fill this share of the box, and its middle, to be the box's thing


class SaliencySegmenter:
    """U2NetP sees what stands out in a crop: right for cups, chairs and books, wrong for a table under magazines.

    So its mask is believed only where it fills the box and its middle; else the connected depth surface in the
    middle of the box is the mask.
    """

    def __init__(self, models: Path) -> None:
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 2
        # waiting threads would burn the cores that the rest of the stack needs
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        self._session = onnxruntime.InferenceSession(
            str(models / "u2netp.onnx"), options, providers=["CPUExecutionProvider"]
        )
        self._input = self._session.get_inputs()[0].name
        self._lock = threading.Lock()

    async def segment(self, frame: Frame, boxes: Sequence[Box2]) -> list[Bools]:
        return await asyncio.to_thread(lambda: [self._one(frame, box) for box in boxes])

    def _one(self, frame: Frame, box: Box2) -> Bools:
        salient = self._salient(frame.rgb, box)
        return salient if _is_the_boxes_thing(salient, box) else surface_mask(frame.depth, box)

    def _salient(self, rgb: U8, box: Box2) -> Bools:
        mask = np.zeros(rgb.shape[:2], dtype=bool)
        x0, y0, x1, y1 = pixels_of(box, rgb.shape)
        if x1 <= x0 or y1 <= y0:
            return mask
        dx, dy = round(_MARGIN * (x1 - x0)), round(_MARGIN * (y1 - y0))
        left, top, right, bottom = max(x0 - dx, 0), max(y0 - dy, 0), x1 + dx, y1 + dy
        crop = rgb[top:bottom, left:right]
        probability = cv2.resize(self._run(crop), (crop.shape[1], crop.shape[0]))
        whole = np.zeros_like(mask)
        whole[top : top + crop.shape[0], left : left + crop.shape[1]] = probability > _SALIENT
        mask[y0:y1, x0:x1] = whole[y0:y1, x0:x1]
        return mask

    def _run(self, crop: U8) -> F32:
        image = cv2.resize(crop, (_SIDE, _SIDE)).astype(np.float32)
        image = (image / max(float(image.max()), 1.0) - _MEAN) / _STD
        with self._lock:
            raw = self._session.run(None, {self._input: image.transpose(2, 0, 1)[None].astype(np.float32)})[
                0
            ][0, 0]
        return np.asarray((raw - raw.min()) / max(float(raw.max() - raw.min()), 1e-6), np.float32)


def _is_the_boxes_thing(mask: Bools, box: Box2) -> bool:
    x0, y0, x1, y1 = pixels_of(box, mask.shape)
    inside = mask[y0:y1, x0:x1]
    if inside.size == 0 or inside.mean() < _FILLS:
        return False
    h, w = inside.shape
    return bool(inside[h // 4 : max(3 * h // 4, 1), w // 4 : max(3 * w // 4, 1)].mean() > 0.5)
