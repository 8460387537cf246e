"""The made-up floor that the mapper is measured on: as crowded, and as alike, as it says."""

from __future__ import annotations

import numpy as np
import pytest

from lab.bench.mapping_walk import Walk
from lab.bench.mapping_world import SITE_SIDE, SITE_THINGS, CrowdedFloor, cell_of, middle_of, site_at
from ovip.scene.boxes import pairwise_touching
from ovip.scene.types import DetectionBatch
from ovip.scene.voxels import voxel_keys


def _seen(floor: CrowdedFloor, sites: int, frame: int = 1) -> DetectionBatch:
    return floor.batch(floor.things(0, SITE_THINGS * sites), frame)


def test_sites_are_numbered_so_that_a_smaller_floor_is_a_square_part_of_a_larger_one() -> None:
    for side in (1, 2, 5, 9):
        cells = {cell_of(number) for number in range(side * side)}
        assert cells == {(x, y) for x in range(side) for y in range(side)}
    assert [site_at(*cell_of(number)) for number in range(200)] == list(range(200))


def test_every_part_of_the_floor_is_as_crowded_as_every_other() -> None:
    floor = CrowdedFloor(32)
    for first in (0, 400, 5000):
        boxes = np.array([d.box for d in floor.batch(floor.things(8 * first, 8 * first + 512), 1).detections])
        neighbours = pairwise_touching(boxes, boxes).sum(axis=1) - 1
        assert neighbours.mean() == pytest.approx(3.1, abs=0.3)
        assert neighbours.max() <= SITE_THINGS


def test_things_stay_on_their_site_give_or_take() -> None:
    floor = CrowdedFloor(32)
    for number in (0, 7, 123):
        for thing in floor.site(number):
            assert np.abs(thing.points[:, :2].mean(axis=0) - middle_of(number)).max() < 0.75 * SITE_SIDE


def test_detections_have_500_to_5000_points_as_many_of_each_scale() -> None:
    counts = np.array([len(d.points) for d in _seen(CrowdedFloor(32), 64).detections])
    assert np.quantile(counts, 0.02) >= 450
    assert counts.max() <= 5800
    assert np.log10(np.median(counts)) == pytest.approx(np.log10(np.sqrt(500 * 5000)), abs=0.08)


def test_a_detection_has_one_point_a_voxel_by_voxel_key_as_lifting_leaves_it() -> None:
    for d in _seen(CrowdedFloor(32), 4).detections:
        assert (np.diff(voxel_keys(d.points, 0.02)) > 0).all()
        assert len(d.points) == len(d.colors)


@pytest.mark.parametrize("dimension", [512, 1024])
def test_cosines_are_those_of_an_image_encoder(dimension: int) -> None:
    floor = CrowdedFloor(dimension)
    first, second = _seen(floor, 40, frame=1), _seen(floor, 40, frame=2)
    labels = np.array([d.label for d in first.detections])
    a, b = (np.array([d.feature for d in batch.detections]) for batch in (first, second))
    cosines, same = a @ b.T, np.eye(len(labels), dtype=bool)
    alike = (labels[:, None] == labels) & ~same
    assert np.linalg.norm(a, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert cosines[same].min() > 0.9
    assert cosines[alike].mean() == pytest.approx(0.86, abs=0.01)
    assert cosines[~alike & ~same].mean() == pytest.approx(0.74, abs=0.01)
    assert 130 < len(set(labels)) <= 150


def test_the_same_site_and_the_same_frame_are_the_same_again_whatever_was_asked_before() -> None:
    floor = CrowdedFloor(32)
    alone = floor.site(5)
    assert all(
        np.array_equal(one.points, again.points) and one.label == again.label
        for one, again in zip(alone, floor.things(40, 48), strict=True)
    )
    once, again = _seen(floor, 2, frame=3), _seen(CrowdedFloor(32), 2, frame=3)
    assert all(
        np.array_equal(a.points, b.points) and np.array_equal(a.feature, b.feature)
        for a, b in zip(once.detections, again.detections, strict=True)
    )


def test_a_walk_sees_what_it_is_asked_for_from_among_the_first_things_and_measures_depth_at_it() -> None:
    floor = CrowdedFloor(32)
    mapped = {thing.points.tobytes() for thing in floor.things(0, 100)}
    assert len(mapped) == 100
    for batch in Walk(floor, 100, 20, 1).frames(6):
        assert len(batch.detections) == 20
        boxes = np.array([d.box for d in batch.detections])
        assert boxes[:, :2].min() > -SITE_SIDE
        assert boxes[:, 3:5].max() < 5 * SITE_SIDE
        assert batch.nearest.shape == (170, 300)
        assert batch.nearest.min() > 0.3
        assert batch.nearest.max() <= 7.0
        middle = batch.detections[0].box[:3]
        distance = np.linalg.norm(middle - batch.world_from_camera[:3, 3])
        assert distance < 5.0
