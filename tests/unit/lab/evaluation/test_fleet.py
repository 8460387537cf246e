"""The fleet protocol: what counts as the same object, and a robot whose world is moved."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from lab.evaluation.experiment import Options
from lab.evaluation.experiments.fleet import matched_share, moved_batch, run
from ovip.errors import InvalidInput
from ovip.scene.types import Detection, MapObject
from services.mapper.domain.object_map import map_of
from services.mapper.domain.registration import turn
from tests.builders import axis, batch, detection

CUP = detection("cup")
LAMP = detection("lamp", (2, 0, 0), (2.2, 0.2, 0.2), feature=axis(1))


def _objects(*things: Detection) -> tuple[MapObject, ...]:
    return map_of(batch(n, *things) for n in range(1, 4)).objects()


def test_an_object_is_there_where_its_label_and_its_box_are() -> None:
    near = detection("cup", (0.05, 0, 0), (0.25, 0.2, 0.2))  # IoU 0.6
    beside = detection("cup", (0.1, 0, 0), (0.3, 0.2, 0.2))  # IoU 1/3

    assert matched_share(_objects(CUP, LAMP), _objects(near, LAMP)) == 1.0
    assert matched_share(_objects(CUP, LAMP), _objects(beside, LAMP)) == 0.5
    assert matched_share(_objects(CUP), _objects(dataclasses.replace(CUP, label="mug"))) == 0.0
    assert matched_share(_objects(CUP), ()) == 0.0
    assert matched_share((), _objects(CUP)) is None


def test_each_object_counts_once() -> None:
    (cup,) = _objects(CUP)

    assert matched_share((cup, cup), (cup,)) == 0.5


def test_a_moved_batch_has_its_camera_boxes_and_points_moved_together() -> None:
    pose = turn(np.pi / 2)
    pose[:3, 3] = 1.0, 2.0, 0.5

    moved = moved_batch(dataclasses.replace(batch(1, LAMP), surface=LAMP.points), pose)

    assert np.allclose(moved.world_from_camera, pose)
    assert moved.detections[0].box == pytest.approx([0.8, 4.0, 0.5, 1.0, 4.2, 0.7])
    assert np.allclose(moved.surface, moved.detections[0].points)


def test_a_data_set_that_is_unknown_or_not_there_is_refused() -> None:
    with pytest.raises(InvalidInput, match="expected small_house"):
        run(Options(dataset="replica"))
    with pytest.raises(InvalidInput, match="folder of small_house"):
        run(Options(dataset="small_house"))
