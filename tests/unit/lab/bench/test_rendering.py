"""The rendering bench says what it measured."""

from __future__ import annotations

import pytest

pytest.importorskip("open3d", reason="rendering needs Open3D")

from lab.bench.rendering import measure_rendering
from tests.unit.lab.simulation.box_homes import box_home


def test_both_ways_to_render_are_timed_without_the_warm_up() -> None:
    rows = measure_rendering(frames=2, home=box_home())
    assert [row["what"] for row in rows] == ["shaded", "depth and ids"]
    for row in rows:
        assert (row["frames"], row["home"], row["triangles"]) == (2, "boxes", 12 * 12)
        assert float(row["frames_per_second"]) == pytest.approx(1e3 / float(row["mean_ms"]), rel=0.01)
