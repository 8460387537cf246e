"""Functions of objects: what each object's place is for (KGSW, Algorithm 1 line 5).

The paper asks a VLM, with labels and BEV centres (`services.regions.grouping`). Here is what needs none (SPEC
6): a table of words and functions gives each object a prior, its neighbours vote where the word alone leaves
it open, and a word that is not in the table borrows the priors of its nearest words in text-feature space.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ovip.scene.features import normalize
from ovip.scene.types import F32, F64, Bools
from ovip.scene.words import normalize_word
from services.regions.domain.function_table import FUNCTION_WORDS
from services.regions.domain.partition import UNKNOWN_FUNCTION


@dataclass(frozen=True, slots=True)
class FunctionParams:
    """possible: weight of a `possible` word beside 1 for a `typical` one. company: how much a neighbour of
    settled function can add to a prior, times that prior. reach: e-folding distance of that, metres. enough:
    an object's best function must score this much, else it is unknown. neighbours: words an unlisted word
    borrows from. stands_out: its nearest word must be this many standard deviations more similar than the
    table's words are on average (scale-free, because encoders' similarities differ in scale)."""

    possible: float = 0.4
    company: float = 3.0
    reach: float = 1.5
    enough: float = 0.6
    neighbours: int = 3
    stands_out: float = 3.0


FUNCTIONS: tuple[str, ...] = tuple(FUNCTION_WORDS)


def functions_of(
    words: tuple[str, ...], centres: F64, borrowed: dict[str, F64], params: FunctionParams | None = None
) -> tuple[str, ...]:
    """The function of each of N objects from its word and its neighbours; "unknown" where neither settles it.

    centres: `(N, 2)` metres on one floor. borrowed: priors `(T,)` of words that the table lacks, see
    `borrow_priors`. With prior q_i(t) of object i's word and distances d_ij, i's function is
        argmax_t q_i(t) * (1 + company * max over j != i of a_j(t) * exp(-d_ij / reach)),
    where a_j is q_j kept where it alone is enough: a chair by a dining table is for dining, a chair by itself
    could be for anything. Ties go to the function listed first.
    """
    params = params or FunctionParams()
    if not words:
        return ()
    priors = np.stack([_prior_or_none(word, borrowed, params) for word in words])
    anchors = np.where(priors >= params.enough, priors, 0.0)
    distance = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    nearness = np.exp(-distance / params.reach)
    np.fill_diagonal(nearness, 0.0)
    support = np.stack([(nearness * anchor).max(axis=1) for anchor in anchors.T], axis=1)
    scores = priors * (1.0 + params.company * support)
    best = scores.argmax(axis=1)
    settled: Bools = scores.max(axis=1) >= params.enough
    return tuple(FUNCTIONS[k] if sure else UNKNOWN_FUNCTION for k, sure in zip(best, settled, strict=True))


def prior_of(word: str, params: FunctionParams | None = None) -> F64 | None:
    """How much a word speaks for each function -> `(T,)`, in sum at most 1; None for one not listed."""
    table = _table((params or FunctionParams()).possible)
    return table.get(normalize_word(word))


def table_words() -> tuple[str, ...]:
    """Every word of the table, sorted."""
    return tuple(sorted(_table(FunctionParams().possible)))


def unlisted(words: tuple[str, ...]) -> tuple[str, ...]:
    """Those of `words` that the table lacks, sorted, each once."""
    return tuple(sorted({word for word in words if prior_of(word) is None}))


def borrow_priors(
    words: tuple[str, ...],
    features: F32,
    known: tuple[str, ...],
    known_features: F32,
    params: FunctionParams | None = None,
) -> dict[str, F64]:
    """Priors `(T,)` of words that the table lacks, from the nearest words that it has; words like none are
    left out.

    features: `(N, D)` of `words`; known_features: `(M, D)` of `known`, words of the table. The prior is the
    nearest words' mean, each weighted by how far it stands out.
    """
    params = params or FunctionParams()
    if not words:
        return {}
    priors = np.stack([_table(params.possible)[word] for word in known])
    similarity = np.asarray(normalize(features) @ normalize(known_features).T, dtype=np.float64)
    spread = np.maximum(similarity.std(axis=1, keepdims=True), 1e-9)
    standing = (similarity - similarity.mean(axis=1, keepdims=True)) / spread
    nearest = np.argsort(-standing, axis=1, kind="stable")[:, : params.neighbours]
    borrowed = {}
    for word, row, chosen in zip(words, standing, nearest, strict=True):
        if row[chosen[0]] >= params.stands_out:
            weight = np.maximum(row[chosen] - params.stands_out, 0.0) + 1e-9
            borrowed[word] = weight @ priors[chosen] / weight.sum()
    return borrowed


def _prior_or_none(word: str, borrowed: dict[str, F64], params: FunctionParams) -> F64:
    listed = prior_of(word, params)
    return listed if listed is not None else borrowed.get(word, np.zeros(len(FUNCTIONS)))


@cache
def _table(possible: float) -> dict[str, F64]:
    weights: dict[str, F64] = {}
    for k, words in enumerate(FUNCTION_WORDS.values()):
        for weight, listed in ((possible, words.possible), (1.0, words.typical)):
            for word in filter(None, (normalize_word(part) for part in listed.split(","))):
                weights.setdefault(word, np.zeros(len(FUNCTION_WORDS)))[k] = weight
    return {word: weight / max(1.0, weight.sum()) for word, weight in weights.items()}
