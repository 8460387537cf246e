"""Functions of objects: what each object's place is for (KGSW, Algorithm 1 line 5).

The paper asks a VLM, with labels and BEV centres (`services.regions.grouping`). Here is what needs none (SPEC
6): a table of words and functions gives each object a prior, what it stands at tips it where the word alone
leaves it open, and a word that is not in the table borrows the priors of its nearest words in text-feature space.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ovip.scene.features import normalize
from ovip.scene.types import F32, F64, Bools
from services.regions.domain.function_priors import FUNCTIONS, is_listed, prior_of, table_words
from services.regions.domain.partition import UNKNOWN_FUNCTION

__all__ = [
    "FUNCTIONS",
    "FunctionParams",
    "borrow_priors",
    "function_scores",
    "functions_of",
    "prior_of",
    "table_words",
    "unlisted",
    "votes_of",
]


@dataclass(frozen=True, slots=True)
class FunctionParams:
    """company: by how many times a neighbour of settled function, at no distance, lifts a prior for it. reach:
    e-folding distance of that, metres. enough: an object's best function must score this much, else it is
    unknown; and a word whose prior is this much settles its object.

    around: e-folding distance, metres, of what the objects around one speak for; one that its own word leaves open
    joins them where they speak for one function with at least `amount` in sum and `one_mind` of the whole.

    neighbours: words an unlisted word borrows from. stands_out: the nearest must be this many standard deviations
    more similar than the table's words are on average (scale-free, because encoders' similarities differ in
    scale), and each counts by what it exceeds half of that. agree: what their priors together must say for one
    function. Measured with MiniLM on 145 words that the table lacks, 19 of them no household things: 79 borrow,
    72 of them rightly; with 3 neighbours and no need to agree it was 141 and 101.

    unheard: the vote of a word or a function that the table lacks. witness: the least vote of an object whose function
    a VLM named, so that three of them make an area.
    """

    company: float = 12.0
    reach: float = 0.8
    enough: float = 0.5
    around: float = 1.5
    amount: float = 0.5
    one_mind: float = 0.65
    neighbours: int = 8
    stands_out: float = 2.5
    agree: float = 0.35
    unheard: float = 0.5
    witness: float = 0.7


_CUT_OFF = 5.0
"""Reaches: company further away than this counts nothing."""
_AROUND = 16
"""So many of the objects that speak for something are around one: the nearest, itself among them if it does."""


def functions_of(
    words: tuple[str, ...], centres: F64, borrowed: dict[str, F64], params: FunctionParams | None = None
) -> tuple[str, ...]:
    """The function of each of N objects from its word and its neighbours; "unknown" where neither settles it.

    First the function of the largest score where that is `enough`, see `function_scores`. Then an object whose
    word leaves it open, as a picture's does, joins the objects around it where these are of one mind,
        e_i(t) = sum over the nearest j != i that speak of exp(-d_ij / around) * score_j(t),
    unless its word speaks for others only. Ties go to the function listed first.
    """
    params = params or FunctionParams()
    scores = function_scores(words, centres, borrowed, params)
    if not len(scores):
        return ()
    around = _around(scores, centres, params.around)
    settled: Bools = scores.max(axis=1) >= params.enough
    agreed: Bools = around.max(axis=1) >= params.one_mind * np.maximum(around.sum(axis=1), 1e-12)
    open_to: Bools = ~scores.any(axis=1) | (scores[np.arange(len(scores)), around.argmax(axis=1)] > 0)
    joins: Bools = ~settled & agreed & open_to & (around.sum(axis=1) >= params.amount)
    best = np.where(joins, around.argmax(axis=1), scores.argmax(axis=1))
    return tuple(
        FUNCTIONS[k] if sure else UNKNOWN_FUNCTION for k, sure in zip(best, settled | joins, strict=True)
    )


def function_scores(
    words: tuple[str, ...], centres: F64, borrowed: dict[str, F64], params: FunctionParams | None = None
) -> F64:
    """How much each of N objects speaks for each function of `FUNCTIONS` -> `(N, T)`.

    Each row is nonnegative and sums to at most 1: shares of belief, the rest is undecided, and a row of zeros says
    nothing. Sum them over objects to weigh what an area is for; with `company=0` each word counts by itself.

    centres: `(N, 2)` metres on one floor. borrowed: priors `(T,)` of words that the table lacks, see
    `borrow_priors`. With prior q_i(t) of object i's word and the distance d_i(t) to the nearest other object
    whose word alone settles it for t, the lifted priors
        l_i(t) = q_i(t) * (1 + company * exp(-d_i(t) / reach))
    share the belief with what the word leaves open, 1 - sum of q_i:
        score_i(t) = l_i(t) / (sum of l_i + 1 - sum of q_i).
    So a chair by a dining table is for dining, and a chair by itself could be for anything.
    """
    params = params or FunctionParams()
    if not words:
        return np.zeros((0, len(FUNCTIONS)))
    priors = _priors(words, borrowed)
    lifted = priors * (1.0 + params.company * _company(priors >= params.enough, centres, params.reach))
    undecided = 1.0 - priors.sum(axis=1, keepdims=True)
    total = lifted.sum(axis=1, keepdims=True) + np.maximum(undecided, 0.0)
    scores: F64 = lifted / np.maximum(total, 1e-12)
    return scores


def votes_of(
    words: Sequence[str],
    functions: Sequence[str],
    told: Sequence[bool] = (),
    params: FunctionParams | None = None,
) -> F64:
    """How much each of N objects vouches by its own word for the function it was given -> `(N,)`, 0..1.

    What the table says of the word and the function: 1 for a stove in a kitchen, a quarter for a chair in an office;
    `unheard` for a word or a function that it does not know; and at least `witness` for one that a VLM named, which
    saw what stands around it: `told`, `(N,)`, or none of them where it is empty.
    """
    params = params or FunctionParams()
    votes = np.full(len(words), params.unheard)
    for number, (word, function) in enumerate(zip(words, functions, strict=True)):
        prior = prior_of(word)
        if is_listed(word) and (function in FUNCTIONS or function == UNKNOWN_FUNCTION):
            votes[number] = (
                0.0 if prior is None or function not in FUNCTIONS else prior[FUNCTIONS.index(function)]
            )
    named = np.array(told, dtype=bool) if len(told) else np.zeros(len(words), dtype=bool)
    named &= np.array([function != UNKNOWN_FUNCTION for function in functions], dtype=bool)
    heard: F64 = np.where(named, np.maximum(votes, params.witness), votes)
    return heard


def unlisted(words: tuple[str, ...]) -> tuple[str, ...]:
    """Those of `words` that the table does not know, sorted, each once."""
    return tuple(sorted({word for word in words if not is_listed(word)}))


def borrow_priors(
    words: tuple[str, ...],
    features: F32,
    known: tuple[str, ...],
    known_features: F32,
    params: FunctionParams | None = None,
) -> dict[str, F64]:
    """Priors `(T,)` of words that the table lacks, from the nearest words that it has; words like none are
    left out.

    features: `(N, D)` of `words`; known_features: `(M, D)` of `known`, words of the table, those that say nothing
    among them. The prior is the nearest words' mean, each weighted by how far it stands out; a word whose nearest
    disagree borrows nothing.
    """
    params = params or FunctionParams()
    if not words or not known:
        return {}
    priors = _priors(known, {})
    similarity = np.asarray(normalize(features) @ normalize(known_features).T, dtype=np.float64)
    spread = np.maximum(similarity.std(axis=1, keepdims=True), 1e-9)
    standing = (similarity - similarity.mean(axis=1, keepdims=True)) / spread
    nearest = np.argsort(-standing, axis=1, kind="stable")[:, : params.neighbours]
    borrowed = {}
    for word, row, chosen in zip(words, standing, nearest, strict=True):
        weight = np.maximum(row[chosen] - params.stands_out / 2, 0.0)
        if row[chosen[0]] < params.stands_out:
            continue
        prior = weight @ priors[chosen] / weight.sum()
        if prior.max() >= params.agree:
            borrowed[word] = prior
    return borrowed


def _priors(words: tuple[str, ...], borrowed: dict[str, F64]) -> F64:
    """What each word speaks for -> `(N, T)`, zeros where it says nothing."""
    silent = np.zeros(len(FUNCTIONS))
    rows = {word: number for number, word in enumerate(dict.fromkeys(words))}
    listed = [(prior_of(word), word) for word in rows]
    known = np.stack([borrowed.get(word, silent) if prior is None else prior for prior, word in listed])
    return known[[rows[word] for word in words]]


def _company(settles: Bools, centres: F64, reach: float) -> F64:
    """exp(-distance / reach) from each object to the nearest other one that settles each function -> `(N, T)`."""
    nearness = np.zeros(settles.shape)
    for function in np.flatnonzero(settles.any(axis=0)):
        those = settles[:, function]
        distance, _ = cKDTree(centres[those]).query(centres, k=2, distance_upper_bound=_CUT_OFF * reach)
        nearest = np.where(those, distance[:, 1], distance[:, 0])  # its own nearest is itself
        nearness[:, function] = np.exp(-nearest / reach)
    return nearness


def _around(scores: F64, centres: F64, reach: float) -> F64:
    """What the nearest objects around each one speak for, each the less the further away -> `(N, T)`."""
    speaking = np.flatnonzero(scores.any(axis=1))
    if not len(speaking):
        return np.zeros(scores.shape)
    distance, found = cKDTree(centres[speaking]).query(
        centres, k=_AROUND, distance_upper_bound=_CUT_OFF * reach
    )
    beside = np.append(speaking, 0)[found]  # beyond the cut-off it is the one after the last, at no nearness
    nearness = np.where(beside == np.arange(len(scores))[:, None], 0.0, np.exp(-distance / reach))
    total: F64 = np.einsum("nk,nkt->nt", nearness, scores[beside])
    return total
