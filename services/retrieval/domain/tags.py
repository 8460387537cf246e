"""Tier 2, tag retrieval: frames whose tags speak of the target, bridged into segments (CARA, SPEC 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.retrieval.domain.names import NameParams, TextFeatures, match_names


@dataclass(frozen=True, slots=True)
class TagParams:
    """gap: cold frames that a segment may bridge. best: segments looked at, best first."""

    gap: int = 5
    best: int = 6


@dataclass(frozen=True, slots=True)
class Segment:
    """Frames first..last (inclusive) in which the target may be in view; `best` is the frame that says so
    most.
    """

    first: int
    last: int
    best: int
    score: float
    word: str


def score_frames(
    noun: str, tags: Sequence[Sequence[str]], texts: TextFeatures | None, params: NameParams | None = None
) -> tuple[npt.NDArray[np.float64], tuple[str, ...]]:
    """How well each frame's best tag names the noun -> scores `(F,)`, 0 for none, and those tags."""
    words = {word for frame in tags for word in frame}
    matches = {
        match.name: match.score for match in match_names(noun, tuple(words), texts, params or NameParams())
    }
    best = [
        max((word for word in frame if word in matches), key=lambda w: matches[w], default="")
        for frame in tags
    ]
    return np.array([matches.get(word, 0.0) for word in best], dtype=np.float64), tuple(best)


def bridge(
    scores: npt.NDArray[np.float64], words: Sequence[str], params: TagParams | None = None
) -> tuple[Segment, ...]:
    """Hot frames (score > 0) in runs that bridge up to `gap` cold ones, best segment first.

    The best frame of a segment has its highest score; a tie goes to the frame nearest the middle of the
    segment, then to the earlier. Segments tie by number of hot frames, then by the earlier.
    """
    params = params or TagParams()
    hot = np.flatnonzero(scores > 0)
    if not len(hot):
        return ()
    runs = np.split(hot, np.flatnonzero(np.diff(hot) > params.gap + 1) + 1)
    ranked = sorted(runs, key=lambda run: (-scores[run].max(), -len(run), run[0]))
    return tuple(_segment(run, scores, words) for run in ranked)


def _segment(run: npt.NDArray[np.intp], scores: npt.NDArray[np.float64], words: Sequence[str]) -> Segment:
    middle = (run[0] + run[-1]) / 2
    best = min(run, key=lambda frame: (-scores[frame], abs(frame - middle), frame))
    return Segment(int(run[0]), int(run[-1]), int(best), float(scores[best]), words[int(best)])
