"""Words as one text prompt for a phrase-grounding detector, and its token scores as scores of words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, Bools

Span = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Prompt:
    """text: `cup. dining table.`; spans: where each of `words` lies in it, in characters."""

    words: tuple[str, ...]
    text: str
    spans: tuple[Span, ...]


def prompt_of(words: Sequence[str]) -> Prompt:
    """The words in lower case, each ended by a full stop; stops inside a word become blanks."""
    text, spans = "", []
    for word in words:
        start = len(text)
        text += word.lower().replace(".", " ").strip()
        spans.append((start, len(text)))
        text += ". "
    return Prompt(tuple(words), text.rstrip(), tuple(spans))


def prompts_of(words: Sequence[str], longest: int, tokens: Callable[[str], int]) -> list[Prompt]:
    """As few prompts as hold all words in turn, of at most `longest` tokens; a longer word stands alone."""
    groups: list[list[str]] = []
    for word in words:
        if groups and tokens(prompt_of([*groups[-1], word]).text) <= longest:
            groups[-1].append(word)
        else:
            groups.append([word])
    return [prompt_of(group) for group in groups]


def token_masks(spans: Sequence[Span], offsets: Sequence[Span]) -> Bools:
    """Which tokens `(W, T)` make up each word. offsets: characters of each token; empty for special ones."""
    masks = np.zeros((len(spans), len(offsets)), dtype=bool)
    for row, (start, end) in enumerate(spans):
        for column, (first, last) in enumerate(offsets):
            masks[row, column] = last > first and first < end and last > start
    return masks


def word_scores(token_scores: F32, masks: Bools) -> F32:
    """Scores of words `(Q, W)` from those of tokens `(Q, T)`: the mean over a word's tokens; 0 without any.

    As the detector is evaluated on class names.
    """
    weights = masks / np.maximum(masks.sum(axis=1, keepdims=True), 1)
    return np.asarray(token_scores @ weights.T, np.float32)
