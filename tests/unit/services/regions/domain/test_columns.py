"""Columns: which layers a band takes, and what fills one."""

from __future__ import annotations

import numpy as np
import pytest

from services.regions.domain.bricks import Window
from services.regions.domain.columns import Bandwidths, Columns, layers_of, marked
from services.regions.domain.counts import pack_voxel
from services.regions.domain.evidence import CELL, SLAB, FloorEvidence
from services.regions.domain.floors import Storey

GROUND = Storey(0.0, None, -np.inf, np.inf)
WANTED = Bandwidths({"low": (0.0, 1.0)}, {"low": (0.0, 1.0)}, (0.0, 2.0))


def columns(hits: int, filled: int, passes: int) -> Columns:
    """One column of a band 0.5 m high: 10 voxels, 2 slabs."""
    return Columns(
        {"wall": np.array([hits])},
        {"wall": np.array([filled])},
        {"wall": np.array([passes])},
        {"wall": (1.5, 2.0)},
    )


def evidence_of(*cells: tuple[int, int, int]) -> FloorEvidence:
    evidence = FloorEvidence()
    evidence.hits.add(pack_voxel(np.array(cells, np.int64).reshape(-1, 3)))
    return evidence


@pytest.mark.parametrize(
    ("storey", "layer", "span", "layers"),
    [
        (GROUND, CELL, (0.0, 0.10), (0, 2)),
        (GROUND, CELL, (-0.15, 0.10), (-3, 2)),
        (GROUND, SLAB, (1.4, 2.0), (6, 8)),  # middles 1.625 and 1.875
        (Storey(3.0, None, 2.7, np.inf), CELL, (-0.5, 0.0), (54, 60)),  # from the storey's own lowest
        (Storey(0.0, None, -np.inf, 2.6), SLAB, (2.0, 8.0), (8, 10)),
        (GROUND, CELL, (0.5, 0.5), (10, 10)),
    ],
)
def test_a_band_takes_the_layers_whose_middles_it_holds(
    storey: Storey, layer: float, span: tuple[float, float], layers: tuple[int, int]
) -> None:
    assert layers_of(storey, layer, span) == layers


@pytest.mark.parametrize(
    ("hits", "filled", "passes", "is_filled"),
    [
        (5, 5, 0, True),
        (4, 4, 0, False),
        (5, 5, 2, True),
        (5, 5, 3, False),
        (50, 5, 20, True),
        (0, 0, 0, False),
    ],
)
def test_a_column_is_filled_by_half_its_voxels_hit_as_often_as_seen_through(
    hits: int, filled: int, passes: int, is_filled: bool
) -> None:
    """Five of ten voxels, hit once each, outweigh one ray in each of two slabs, but not three in both."""
    assert columns(hits, filled, passes).is_filled("wall", 0.5, 0.2).tolist() == [is_filled]


@pytest.mark.parametrize(
    ("hits", "passes", "goes_on"), [(10, 2, True), (10, 3, False), (1, 0, True), (0, 0, False), (1, 1, False)]
)
def test_a_column_goes_on_where_its_voxels_are_hit_as_often_as_slabs_are_passed(
    hits: int, passes: int, goes_on: bool
) -> None:
    assert columns(hits, 1, passes).goes_on("wall").tolist() == [goes_on]


def test_marks_lie_where_their_columns_do() -> None:
    found = marked(
        evidence_of((-30, 4, 2), (700, 900, 2), (0, 0, 99)),
        GROUND,
        WANTED,
        lambda c: {"hit": c.hits["low"] > 0},
        2,
    )
    assert found is not None
    assert found.window == Window((-32, 2), (703, 903))
    assert np.argwhere(found.masks["hit"]).tolist() == [[2, 2], [898, 732]]
    assert not found.stood.any()


def test_a_camera_alone_is_a_column() -> None:
    evidence = FloorEvidence()
    evidence.add("f", np.zeros((0, 3), np.float32), np.array([-1.01, 2.01, 1.0]))
    found = marked(evidence, GROUND, WANTED, lambda c: {"hit": c.hits["low"] > 0}, 1)
    assert found is not None
    assert found.window == Window((-22, 39), (-19, 42))
    assert np.argwhere(found.stood).tolist() == [[1, 1]]


def test_nothing_in_the_bands_is_no_marks() -> None:
    assert marked(FloorEvidence(), GROUND, WANTED, lambda c: {}, 1) is None
    high = evidence_of((0, 0, 40))
    assert marked(high, GROUND, WANTED, lambda c: {"hit": c.hits["low"] > 0}, 1) is None
