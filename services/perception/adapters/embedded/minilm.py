"""Text features by all-MiniLM-L6-v2 (int8) on onnxruntime: mean of the token states, unit length."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import onnxruntime
from tokenizers import Tokenizer

from ovip.scene.features import normalize
from ovip.scene.types import F32

DIMENSION = 384
_LONGEST = 64


class MiniLm:
    """384-d text features; the same text always gives the same bytes, alone or among others."""

    def __init__(self, models: Path) -> None:
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        self._session = onnxruntime.InferenceSession(
            str(models / "minilm_int8.onnx"), options, providers=["CPUExecutionProvider"]
        )
        self._inputs = {item.name for item in self._session.get_inputs()}
        self._tokenizer = Tokenizer.from_file(str(models / "minilm_tokenizer.json"))
        self._tokenizer.enable_truncation(_LONGEST)
        self._tokenizer.no_padding()
        self._lock = threading.Lock()
        self._known: dict[str, F32] = {}

    async def embed(self, texts: Sequence[str]) -> F32:
        """Unit features `(N, 384)`."""
        return await asyncio.to_thread(self.embed_now, texts)

    def embed_now(self, texts: Sequence[str]) -> F32:
        if not texts:
            return np.zeros((0, DIMENSION), np.float32)
        with self._lock:
            if len(self._known) > 50_000:
                self._known.clear()
            return np.stack([self._one(text) for text in texts])

    def _one(self, text: str) -> F32:
        if text not in self._known:
            ids = np.array([self._tokenizer.encode(text).ids], np.int64)
            feeds = {
                "input_ids": ids,
                "attention_mask": np.ones_like(ids),
                "token_type_ids": np.zeros_like(ids),
            }
            states = self._session.run(None, {k: v for k, v in feeds.items() if k in self._inputs})[0]
            self._known[text] = normalize(states[0].mean(axis=0) if states.ndim == 3 else states[0])
        return self._known[text]
