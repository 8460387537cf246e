"""The mapper's benches run, small, on the real map and the real store, and their reference is a fair one."""

from __future__ import annotations

import numpy as np
import pytest

from lab.bench.mapping import GrowingMap, measure_mapper
from lab.bench.mapping_circle import Circle, CircleParams, measure_circle
from lab.bench.mapping_dense import DenseObject, Stacked, associate_all_pairs
from lab.bench.mapping_world import CrowdedFloor
from ovip.scene.boxes import box_of
from ovip.scene.types import DetectionBatch
from services.mapper.domain.association import AssociationParams, Instances, associate

COLUMNS = [
    *("objects", "detections", "dim", "lift_ms", "denoise_ms", "associate_ms", "fuse_ms", "upkeep_ms"),
    *("commit_ms", "frame_ms", "frame_p99_ms", "dense_ms", "bytes_per_frame", "watch_ms", "snapshot_ms"),
    *("ratio", "dense_fuse_ms", "dense_bytes_per_frame", "bytes_map", "load"),
]


async def test_a_row_for_each_size_detections_and_dimension_with_every_column() -> None:
    rows = await measure_mapper(objects=(24, 40), detections=(4, 8), dimensions=(16, 32), frames=3)
    assert [(row["objects"], row["detections"], row["dim"]) for row in rows] == [
        (objects, detections, dim) for objects in (24, 40) for detections in (4, 8) for dim in (16, 32)
    ]
    for row in rows:
        assert list(row) == COLUMNS
        assert all(float(row[name]) > 0 for name in COLUMNS if name not in {"load", "lift_ms"})
        assert float(row["associate_ms"]) + float(row["fuse_ms"]) < float(row["frame_ms"])
        assert float(row["frame_ms"]) <= float(row["frame_p99_ms"])
        assert row["dense_bytes_per_frame"] == int(str(row["detections"])) * 1200 * 680
    assert float(rows[4]["bytes_map"]) > float(rows[1]["bytes_map"]) > float(rows[0]["bytes_map"])


def test_a_growing_map_holds_each_thing_once_and_frames_of_it_make_nothing_new() -> None:
    growing = GrowingMap(CrowdedFloor(256))
    growing.grow(64)
    assert len(growing.map.table) == 64
    for batch in growing.frames(4, 16):
        delta = growing.map.integrate(batch)
        assert (len(delta.created), len(delta.departed)) == (0, 0)
        assert len(delta.updated) >= 16


def test_a_narrowed_map_holds_the_same_things_with_shorter_features_and_leaves_the_wide_one_alone() -> None:
    growing = GrowingMap(CrowdedFloor(256))
    growing.grow(48)
    before, narrow = growing.map.state_hash(), growing.narrowed(64)
    for batch in narrow.frames(4, 16):
        assert {d.feature.shape for d in batch.detections} == {(64,)}
        assert narrow.map.integrate(batch).created == ()
    assert len(narrow.map.table) == 48
    assert growing.map.state_hash() == before
    assert growing.narrowed(256) is growing


def test_the_dense_reference_joins_what_the_mapper_joins() -> None:
    floor = CrowdedFloor(256)
    mapped, seen = floor.batch(floor.things(0, 200), 1), floor.batch(floor.things(0, 220), 2)
    numbers = {f"word {number}": number for number in range(150)}
    dense = associate_all_pairs(_stacked(seen, numbers), _stacked(mapped, numbers))
    pruned = associate(_instances(seen), _instances(mapped), AssociationParams())
    assert dense.tolist() == pruned.tolist()
    assert (dense[:200] == np.arange(200)).mean() > 0.95
    assert (dense[200:] == -1).all()


def test_the_dense_reference_keeps_one_point_a_voxel_and_every_mask() -> None:
    floor = CrowdedFloor(16)
    first, second = (floor.batch(floor.things(0, 1), frame).detections[0] for frame in (1, 2))
    dense = DenseObject(first.points, first.colors, first.feature, 1, [])
    dense.fuse(second, "mask", 0.02)
    cells = np.floor(dense.points / 0.02)
    assert len(first.points) <= len(dense.points) <= len(first.points) + len(second.points)
    assert len(np.unique(cells, axis=0)) >= 0.98 * len(cells)  # a mean may round over the border of its voxel
    assert dense.feature == pytest.approx((first.feature + second.feature) / _length(first, second), abs=1e-6)
    assert (dense.seen, dense.masks) == (2, ["mask"])


def test_a_circling_robot_finds_the_rooms_things_and_ends_with_the_last_frame() -> None:
    rows = measure_circle(frames=200)
    assert [row["frames"] for row in rows] == [2, 20, 100, 200]
    assert 38 <= int(rows[-1]["objects"]) <= 44
    assert all(int(row["bytes_map"]) > 0 and int(row["rss_mb"]) > 0 for row in rows)


def test_a_perfect_circle_sees_ten_of_the_rooms_things_at_a_time_and_all_of_them_in_a_round() -> None:
    params = CircleParams(missed=0, cut=0, misnamed=0, hallucinated=0, pose=0)
    circle = Circle(params)
    room = np.array([box_of(thing.points) for thing in circle.things])
    seen: set[int] = set()
    for frame in range(0, params.round, 10):
        boxes = np.array([d.box for d in circle.batch(frame).detections])
        off = np.abs(boxes[:, None] - room[None]).max(axis=2)
        assert boxes.shape == (10, 6)
        assert off.min(axis=1).max() < 0.03
        assert len(set(off.argmin(axis=1))) == 10
        seen |= set(off.argmin(axis=1).tolist())
    assert seen == set(range(40))


def _stacked(batch: DetectionBatch, numbers: dict[str, int]) -> Stacked:
    return Stacked.of(batch.detections, numbers)


def _instances(batch: DetectionBatch) -> Instances:
    return Instances(
        np.array([d.box for d in batch.detections]),
        np.array([d.feature for d in batch.detections]),
        [d.label for d in batch.detections],
    )


def _length(*detections: object) -> float:
    return float(np.linalg.norm(sum(d.feature for d in detections)))  # type: ignore[attr-defined]
