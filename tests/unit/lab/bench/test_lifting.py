"""The synthetic look that lifting is timed on, and what its row says."""

from __future__ import annotations

import numpy as np
import pytest

from lab.bench.lifting import CAMERA, measure_lifting, synthetic_look


def test_the_synthetic_look_has_as_many_masks_of_plausible_size_as_are_asked_for() -> None:
    look = synthetic_look(8, seed=1)
    sizes = [int(mask.sum()) for mask in look.masks]

    assert look.frame.depth.shape == (CAMERA.height, CAMERA.width) == (680, 1200)
    assert len(sizes) == 8 and sizes == sorted(sizes, reverse=True)
    assert sizes[-1] >= 500 and sizes[0] <= 60_000
    assert np.sum(look.masks, axis=0).max() == 1
    assert look.frame.depth.min() > 0.3 and look.frame.depth.max() < 7


def test_a_row_has_times_their_ratio_and_how_often_clusters_agree() -> None:
    row = measure_lifting(masks=3, repeats=1, former_repeats=1)

    assert row["masks"] == 3
    assert float(row["denoise_ms"]) > 0 and 0 < float(row["lift_ms"]) < float(row["former_ms"])
    assert float(row["ratio"]) == pytest.approx(float(row["former_ms"]) / float(row["lift_ms"]), rel=0.05)
    for name in ("0.06", "0.1"):
        assert 0 <= float(row[f"same_share_{name}"]) <= 1
        assert 0.8 < float(row[f"iou_{name}"]) <= 1
