"""The grid over boxes: nothing that touches is missed, whatever came, grew, moved and went."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.boxes import pair_touching
from ovip.scene.types import F64
from services.mapper.domain.index import BoxIndex


def _boxes(rng: np.random.Generator, count: int) -> F64:
    """From points to walls to boxes far larger than the rest of the world."""
    low = rng.uniform(-5, 5, (count, 3))
    return np.concatenate([low, low + rng.choice([0.0, 0.3, 4.0, 60.0], (count, 3))], axis=1)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=60)
def test_every_box_that_touches_is_near(seed: int) -> None:
    rng = np.random.default_rng(seed)
    index, held = BoxIndex(), dict[int, F64]()
    for box in _boxes(rng, 60):
        number = int(rng.integers(25))
        if rng.random() < 0.2:
            index.remove(number)
            held.pop(number, None)
        else:
            index.put(number, box)
            held[number] = box

    for asked in _boxes(rng, 20):
        near = index.near(asked)
        assert near <= held.keys()
        assert {n for n, box in held.items() if pair_touching(asked, box)} <= near


def test_what_is_far_is_not_near() -> None:
    index = BoxIndex(edge=1.0)
    index.put(1, np.array([0.1, 0.1, 0.1, 0.2, 0.2, 0.2]))
    index.put(2, np.array([5.1, 0.1, 0.1, 5.2, 0.2, 0.2]))

    assert index.near(np.array([0.3, 0.3, 0.3, 0.4, 0.4, 0.4])) == {1}


def test_a_box_that_moved_is_found_where_it_is_and_not_where_it_was() -> None:
    index = BoxIndex(edge=1.0)
    here, there = np.array([0.1, 0.1, 0.1, 0.2, 0.2, 0.2]), np.array([7.1, 0.1, 0.1, 7.2, 0.2, 0.2])
    index.put(1, here)
    index.put(1, there)

    assert index.near(here) == set()
    assert index.near(there) == {1}


def test_an_empty_index_has_nothing_near_and_forgets_what_it_never_had() -> None:
    index = BoxIndex()
    index.remove(3)

    assert index.near(np.array([-1e6, -1e6, -1e6, 1e6, 1e6, 1e6])) == set()
