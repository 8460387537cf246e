"""The survey: storeys with their free space, from whatever was seen."""

from __future__ import annotations

import numpy as np
import pytest

from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.survey import storeys_of_objects, survey
from tests.unit.services.regions.rooms import room, seen


def test_no_frame_is_no_storey() -> None:
    assert survey(FloorEvidence()) == ()
    assert storeys_of_objects((), np.zeros((2, 3))).tolist() == [0, 0]


def test_a_camera_without_any_surface_stands_on_a_storey_of_its_own() -> None:
    (here,) = survey(seen((np.zeros((0, 3), np.float32), (-3.0, 2.0, 1.2))))
    assert here.space.free.sum() * here.space.resolution**2 == pytest.approx(np.pi * 0.2**2, rel=0.3)
    assert not here.space.wall.any()


def test_a_cloud_of_no_finite_point_is_no_surface() -> None:
    nowhere = np.full((5, 3), np.nan, np.float32)
    (here,) = survey(seen((nowhere, (0.0, 0.0, 1.2))))
    (camera_only,) = survey(seen((np.zeros((0, 3), np.float32), (0.0, 0.0, 1.2))))
    assert (here.space.free == camera_only.space.free).all()


def test_each_storey_has_its_own_free_space() -> None:
    below, above = room((0, 4), (0, 3), height=2.6), room((5, 9), (0, 3), floor=2.9)
    lower, upper = survey(seen((below, (2.0, 1.5, 1.2)), (above, (7.0, 1.5, 4.1))))
    assert lower.space.origin[0] < 0.1
    assert upper.space.origin[0] > 4.5
    assert storeys_of_objects((lower, upper), np.array([[2, 1, 0.5], [7, 1, 3.5]])).tolist() == [0, 1]
    for here in (lower, upper):
        assert here.space.free.sum() * here.space.resolution**2 == pytest.approx(12.0, rel=0.08)
