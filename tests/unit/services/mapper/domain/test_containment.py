"""A mug on a table stays a mug, and a sofa one sofa: what protects which, at association, fusion and upkeep."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.features import normalize
from ovip.scene.types import F32, DetectionBatch
from services.mapper.domain.cloud import MOST_VOXELS
from services.mapper.domain.object_map import ObjectMap, map_of
from tests.builders import axis, batch, detection, leaning

STEP = 0.02


def _sheet(low: tuple[float, float, float], high: tuple[float, float, float]) -> F32:
    """Points 2 cm apart on a flat rectangle: one of its three extents is 0."""
    ticks = [
        np.arange(a + STEP / 2, b, STEP) if b > a else np.array([a]) for a, b in zip(low, high, strict=True)
    ]
    return np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.float32)


def _sofa() -> F32:
    """2.2 x 0.9 x 0.85 m: seat, back, front, both arms."""
    return np.concatenate(
        [
            _sheet((0, 0, 0.42), (2.2, 0.9, 0.42)),
            _sheet((0, 0.88, 0.42), (2.2, 0.88, 0.85)),
            _sheet((0, 0.01, 0), (2.2, 0.01, 0.42)),
            _sheet((0.01, 0, 0), (0.01, 0.9, 0.6)),
            _sheet((2.19, 0, 0), (2.19, 0.9, 0.6)),
        ]
    )


def _noisy(points: F32, rng: np.random.Generator) -> F32:
    """As a depth camera sees it: half a centimetre of noise a point, one of drift a view."""
    return (points + rng.normal(0, 0.005, points.shape) + rng.normal(0, 0.01, 3)).astype(np.float32)


def _look(kind: F32, rng: np.random.Generator, cosine: float = 0.85) -> F32:
    """A view's feature: the cosine of two views is about `cosine`."""
    noise = normalize(rng.normal(size=kind.shape).astype(np.float32))
    return normalize((np.sqrt(cosine) * kind + np.sqrt(1 - cosine) * noise).astype(np.float32))


def _labels(made: ObjectMap) -> list[str]:
    return sorted(o.label for o in made.objects())


@given(st.integers(0, 2**32 - 1), st.booleans())
@settings(max_examples=12)
def test_a_sofa_seen_in_ten_partial_views_is_one_sofa_in_whatever_order(seed: int, in_turn: bool) -> None:
    """Each view shows 40 % of its length. Upkeep joins what association could not: parts of one name that overlap."""
    rng = np.random.default_rng(seed)
    sofa, kind = _sofa(), normalize(rng.normal(size=256).astype(np.float32))
    starts = np.linspace(0, 0.6 * 2.2, 10)
    order = np.arange(10) if in_turn else rng.permutation(10)
    parts = [sofa[(sofa[:, 0] >= low) & (sofa[:, 0] <= low + 0.4 * 2.2)] for low in starts[order]]

    made = map_of(
        batch(n, detection("sofa", points=_noisy(part, rng), feature=_look(kind, rng)))
        for n, part in enumerate(parts, 1)
    )

    (one,) = made.objects()
    assert one.box == pytest.approx([0, 0, 0, 2.2, 0.9, 0.85], abs=0.06)
    assert one.observations == 10


def test_two_chairs_side_by_side_stay_two() -> None:
    """Alike to the eye, of one name, 6 cm apart, seen together and one by one."""
    rng = np.random.default_rng(0)
    kind = normalize(rng.normal(size=256).astype(np.float32))
    chair = np.concatenate(
        [_sheet((0, 0, 0.45), (0.45, 0.45, 0.45)), _sheet((0, 0.44, 0.45), (0.45, 0.44, 0.9))]
    )
    both = [chair, (chair + np.array([0.51, 0, 0])).astype(np.float32)]

    def frame(n: int) -> DetectionBatch:
        seen = both if n % 3 == 0 else [both[n % 2]]
        looks = [detection("chair", points=_noisy(points, rng), feature=_look(kind, rng)) for points in seen]
        return batch(n, *looks)

    made = map_of(map(frame, range(1, 41)))

    assert _labels(made) == ["chair", "chair"]


@pytest.mark.parametrize("first", ["table", "cup"])
def test_a_cup_wholly_within_the_tables_points_is_not_merged_by_upkeep(first: str) -> None:
    """The table's cloud holds the cup's (masks that bled), so that all of the cup overlaps it, one-sided."""
    top = _sheet((0, 0, 0.7), (1.2, 0.8, 0.7))
    cup = np.concatenate([_sheet((0.5, 0.3, z), (0.6, 0.4, z)) for z in np.arange(0.71, 0.8, STEP)])
    table = detection("table", points=np.concatenate([top, cup]), feature=axis(0))
    mug = detection("cup", points=cup, feature=leaning(0, 1, 0.97))
    turns = [table, mug] if first == "table" else [mug, table]

    made = map_of(batch(n, *turns) for n in range(1, 31))

    assert _labels(made) == ["cup", "table"]
    assert {o.label: o.observations for o in made.objects()} == {"cup": 30, "table": 30}


def test_a_book_on_a_pile_of_books_stays_itself() -> None:
    """One name and nested boxes: a small book within the box of a lying large one, its cloud above the other's."""
    large = _sheet((0, 0, 0.02), (0.4, 0.3, 0.02))
    large = np.concatenate(
        [large, _sheet((0, 0, 0.16), (0.04, 0.3, 0.16))]
    )  # its upright cover makes the box tall
    small = np.concatenate([_sheet((0.2, 0.1, z), (0.3, 0.2, z)) for z in (0.09, 0.11)])
    pile = [
        detection("book", points=large, feature=axis(0)),
        detection("book", points=small, feature=leaning(0, 1, 0.9)),
    ]

    made = map_of(batch(n, *pile) for n in range(1, 31))

    assert _labels(made) == ["book", "book"]


def test_a_floor_and_a_wall_are_mapped_and_swallow_nothing_that_stands_on_them() -> None:
    """An 8 x 6 m floor seen in tiles, a shelf along the wall, a shoe on the floor: the floor's voxels stay bounded."""
    rng = np.random.default_rng(1)
    kinds = normalize(rng.normal(size=(4, 64)).astype(np.float32))
    floor = _sheet((0, 0, 0), (8, 6, 0))
    wall = _sheet((0, 6, 0), (8, 6, 2.5))
    shelf = _sheet((1, 5.7, 0), (2, 5.7, 1.8))
    shoe = np.concatenate([_sheet((4, 3, z), (4.3, 3.1, z)) for z in (0.01, 0.05, 0.09)])

    def frame(n: int) -> DetectionBatch:
        x = rng.uniform(0, 4)
        parts = {"floor": floor, "wall": wall, "shelf": shelf, "shoe": shoe}
        seen = {
            label: points[(points[:, 0] >= x) & (points[:, 0] <= x + 4)] for label, points in parts.items()
        }
        return batch(
            n,
            *(
                detection(label, points=_noisy(points, rng), feature=_look(kinds[i], rng))
                for i, (label, points) in enumerate(seen.items())
                if len(points)
            ),
        )

    made = map_of(map(frame, range(1, 41)))

    assert _labels(made) == ["floor", "shelf", "shoe", "wall"]
    assert max(o.voxels for o in made.objects()) <= MOST_VOXELS
