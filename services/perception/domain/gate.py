"""The frame-adaptive vocabulary: which words a frame is grounded with (FAV-Gate, Eq. 1)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

DEFAULT_BLACKLIST = frozenset(
    {"text", "logo", "pipe", "shadow", "reflection", "background", "object", "thing", "image"}
)


@dataclass(frozen=True, slots=True)
class GateParams:
    """n_min: frames that must name a word (paper: 3, Table "Models and hyperparameters"); blacklist: the paper's B."""

    n_min: int = 3
    blacklist: frozenset[str] = DEFAULT_BLACKLIST


@dataclass(frozen=True, slots=True)
class Admission:
    """What one more frame lets be grounded: its own words V^t, and (earlier frame id, word) pairs admitted late."""

    words: tuple[str, ...]
    late: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class VocabularyGate:
    """Which frames named each word so far: `named[w]` = frame ids in order of arrival.

    Only the first `n_min` frames of a word are kept, with its count: enough for the gate, bounded for any run.
    """

    params: GateParams
    named: Mapping[str, tuple[str, ...]]

    @classmethod
    def empty(cls, params: GateParams) -> VocabularyGate:
        return cls(params, {})

    @property
    def vocabulary(self) -> tuple[str, ...]:
        """V_glob = {w : freq(w) >= n_min} minus B, sorted."""
        return tuple(sorted(word for word, frames in self.named.items() if self._admits(word, len(frames))))

    def observe(self, frame_id: str, tags: Iterable[str]) -> tuple[VocabularyGate, Admission]:
        """The gate after a frame whose enumerated words T^t are `tags`, and what may be grounded now.

        Causal: V^t = T^t intersect V_glob as of this frame. A word that reaches n_min here also admits the earlier
        frames that named it, so that after the last frame the grounded (frame, word) pairs equal the offline set.
        """
        named = dict(self.named)
        words: list[str] = []
        late: list[tuple[str, str]] = []
        for word in sorted(set(tags)):
            before = named.get(word, ())
            named[word] = (*before, frame_id)[: self.params.n_min]
            if not self._admits(word, len(named[word])):
                continue
            words.append(word)
            if len(before) < self.params.n_min:
                late.extend((earlier, word) for earlier in before)
        return VocabularyGate(self.params, named), Admission(tuple(words), tuple(late))

    def _admits(self, word: str, frequency: int) -> bool:
        return frequency >= self.params.n_min and word not in self.params.blacklist


def gate_offline(tags: Sequence[tuple[str, Iterable[str]]], params: GateParams) -> set[tuple[str, str]]:
    """All (frame id, word) pairs to ground in a recorded run, tags of every frame known first (Eq. 1)."""
    sets = [(frame_id, set(words)) for frame_id, words in tags]
    frequency: dict[str, int] = {}
    for _, words in sets:
        for word in words:
            frequency[word] = frequency.get(word, 0) + 1
    admitted = {word for word, count in frequency.items() if count >= params.n_min} - params.blacklist
    return {(frame_id, word) for frame_id, words in sets for word in words & admitted}
