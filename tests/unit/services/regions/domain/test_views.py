"""Views: the frames that show a region, best first."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ovip.scene.types import I32
from services.regions.domain.evidence import FloorEvidence, pack_voxel
from services.regions.domain.views import seen_by

Squares = list[tuple[int, int]]


def looked(views: dict[str, Squares], layer: int = 0, height: float = 1.3) -> FloorEvidence:
    """Frames that saw the floor of these half-metre squares (x, y), and nothing else."""
    evidence = FloorEvidence()
    for name, squares in views.items():
        evidence.cameras[name] = (0.0, 0.0, height)
        index = np.array([(x, y, layer) for x, y in squares], np.int64).reshape(-1, 3)
        evidence.views[name] = np.unique(pack_voxel(index))
    return evidence


def strip(*regions: int) -> I32:
    """A row of half-metre squares, 10 x 10 cells each, each of one region."""
    return np.repeat(np.repeat(np.array([regions], np.int32), 10, axis=0), 10, axis=1)


def of(evidence: FloorEvidence, labels: I32, count: int, z: float = 0.0, most: int = 32) -> list[str]:
    """The frames of each region, their letters put together."""
    return ["".join(frames) for frames in seen_by(evidence, z, labels, count, (0.0, 0.0), 0.05, most)]


def test_the_next_frame_is_the_one_that_adds_most_not_the_one_that_sees_most() -> None:
    views = {"a": [(0, 0), (1, 0), (2, 0)], "b": [(1, 0), (2, 0)], "c": [(3, 0)]}
    assert of(looked(views), strip(1, 1, 1, 1), 1) == ["acb"]


def test_among_frames_that_add_as_much_the_one_that_sees_more_comes_first_then_the_first_id() -> None:
    views = {"a": [(0, 0), (1, 0), (2, 0)], "b": [(3, 0)], "c": [(2, 0), (3, 0)], "d": [(3, 0), (2, 0)]}
    assert of(looked(views), strip(1, 1, 1, 1), 1) == ["acdb"]


def test_a_square_counts_as_many_cells_as_the_region_has_in_it() -> None:
    labels = strip(1, 1, 2)
    labels[2:, :10] = 0  # of the first square, 2 of 10 rows are the region's
    assert of(looked({"a": [(0, 0)], "b": [(1, 0)], "c": [(2, 0)]}), labels, 2) == ["ba", "c"]


def test_a_region_nobody_saw_and_one_that_is_nowhere_have_no_frames() -> None:
    assert of(looked({"a": [(0, 0)]}), strip(1, 2), 3) == ["a", "", ""]
    assert of(FloorEvidence(), strip(1), 1) == [""]
    assert of(looked({"a": [(0, 0)]}), np.zeros((0, 0), np.int32), 2) == ["", ""]


def test_no_more_frames_than_asked_for() -> None:
    views = {name: [(number, 0)] for number, name in enumerate("abcd")}
    assert of(looked(views), strip(1, 1, 1, 1), 1, most=3) == ["abc"]


def test_a_ceiling_seen_from_below_is_not_the_floor_of_the_storey_above() -> None:
    below, above = looked({"a": [(0, 0)]}, layer=5, height=1.3), looked({"a": [(0, 0)]}, layer=5, height=4.2)
    assert of(below, strip(1), 1, z=2.9) == [""]
    assert of(above, strip(1), 1, z=2.9) == ["a"]


def test_a_wall_seen_above_the_floor_is_no_floor() -> None:
    assert of(looked({"a": [(0, 0)]}, layer=1), strip(1), 1) == [""]


def test_real_frames_are_found_by_what_they_saw() -> None:
    floor = np.stack(np.meshgrid(np.arange(0.02, 1.0, 0.04), np.arange(0.02, 0.5, 0.04), [0.0]), axis=-1)
    evidence = FloorEvidence()
    evidence.add(
        "far",
        floor.reshape(-1, 3).astype(np.float32) + np.array([1.0, 0, 0], np.float32),
        np.array([0, 0, 1.2]),
    )
    evidence.add("near", floor.reshape(-1, 3).astype(np.float32), np.array([0, 0, 1.2]))
    assert seen_by(evidence, 0.0, strip(1, 1, 2), 2, (0.0, 0.0), 0.05) == (("near",), ("far",))


@given(
    st.lists(st.sets(st.tuples(st.integers(0, 5), st.integers(0, 3))), max_size=8),
    st.tuples(st.integers(-40, 40), st.integers(-40, 40)),
    st.randoms(use_true_random=False),
)
def test_the_order_of_frames_and_whole_squares_of_shift_change_nothing(
    seen: list[set[tuple[int, int]]], shift: tuple[int, int], random: np.random.Generator
) -> None:
    labels = np.repeat(np.repeat(np.arange(24, dtype=np.int32).reshape(4, 6) % 3, 10, axis=0), 10, axis=1)
    views = {f"f{number}": sorted(squares) for number, squares in enumerate(seen)}
    moved = [(name, [(x + shift[0], y + shift[1]) for x, y in squares]) for name, squares in views.items()]
    random.shuffle(moved)  # type: ignore[arg-type]
    origin = (shift[0] * 0.5, shift[1] * 0.5)
    expected = seen_by(looked(views), 0.0, labels, 2, (0.0, 0.0), 0.05, 4)
    assert seen_by(looked(dict(moved)), 0.0, labels, 2, origin, 0.05, 4) == expected
    for frames, number in zip(expected, (1, 2), strict=True):
        squares = [{(x, y) for x, y in views[name] if (y * 6 + x) % 3 == number} for name in frames]
        sizes = [len(each - set().union(*squares[:at])) for at, each in enumerate(squares)]
        assert sizes == sorted(sizes, reverse=True)
