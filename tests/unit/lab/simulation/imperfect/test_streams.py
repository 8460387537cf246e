"""Random draws by name."""

from __future__ import annotations

import numpy as np

from lab.simulation.imperfect.streams import happens, stream


def test_a_name_gives_the_same_numbers_whatever_was_drawn_before() -> None:
    before = stream(3, "noise", 7, 12).random(5)
    stream(3, "other", 1).random(100)
    assert np.array_equal(stream(3, "noise", 7, 12).random(5), before)


def test_another_name_or_seed_gives_other_numbers() -> None:
    draws = [
        stream(*key).random() for key in ((0, "a", 1), (0, "a", 2), (0, "b", 1), (1, "a", 1), (0, "a", 1, 1))
    ]
    assert len(set(draws)) == len(draws)


def test_a_mistake_happens_as_often_as_its_level_over_things_and_frames() -> None:
    rate = np.mean([happens(0, "missed", 0.2, thing, frame) for thing in range(150) for frame in range(30)])
    assert abs(rate - 0.2) < 0.03


def test_a_thing_is_inclined_to_a_mistake_in_all_frames() -> None:
    rates = [np.mean([happens(0, "split", 0.4, thing, frame) for frame in range(60)]) for thing in range(40)]
    assert np.std(rates) > 0.15  # even rates of 0.4 would deviate by 0.06


def test_nothing_happens_at_level_zero() -> None:
    assert not any(happens(0, "missed", 0.0, thing, 0) for thing in range(200))
