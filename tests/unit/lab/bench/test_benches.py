"""Every bench runs, small, on the real thing, and says what it measured."""

from __future__ import annotations

from pathlib import Path

import pytest

from lab.bench.ingesting import _CAMERA, make_pictures, measure_ingest
from lab.bench.perceiving import measure_perception
from lab.bench.tier1 import measure_tier1
from ovip.wire import decode_depth_units, decode_rgb


def test_pictures_are_of_the_size_asked_for_decode_and_are_all_different() -> None:
    pictures = make_pictures(5, kilobytes=300)
    assert len({picture.rgb for picture in pictures}) == len({picture.depth for picture in pictures}) == 5
    for picture in pictures:
        assert picture.kilobytes == pytest.approx(300, abs=30)
        assert decode_rgb(picture.rgb, _CAMERA).shape == (480, 640, 3)
        assert decode_depth_units(picture.depth, "shuffle_zstd", _CAMERA).min() > 1000


@pytest.mark.models
async def test_every_frame_that_is_streamed_is_acked(models_dir: Path) -> None:
    rows = await measure_ingest(robots=2, kilobytes=250, seconds=0.02)
    assert [row["frames"] for row in rows] == [
        8,
        8,
    ]  # 2 robots x (1 + the 3 that 0.02 s at 125 a second take)
    for row in rows:
        assert 0 < float(row["ack_p50_ms"]) <= float(row["ack_p99_ms"])
        assert float(row["frames_a_second"]) > 0


@pytest.mark.models
async def test_tier_1_is_timed_for_each_size_of_map(models_dir: Path) -> None:
    rows = await measure_tier1(sizes=(10, 80), rounds=1)
    assert [(row["objects"], row["answers"]) for row in rows] == [(10, 10), (80, 60)]
    for row in rows:
        assert 0 < float(row["tier_p50_ms"]) <= float(row["answer_p50_ms"])


@pytest.mark.models
async def test_every_step_of_perception_is_timed_without_the_warm_up(models_dir: Path) -> None:
    rows = await measure_perception(frames=1)
    assert [row["step"] for row in rows] == ["enumerate", "ground", "segment", "embed", "lift", "surface"]
    assert {row["frames"] for row in rows} == {1}
    assert float(rows[0]["boxes_a_frame"]) > 0
