"""Upkeep: clutter goes, what lies on or in another is seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ovip.scene.types import F32, F64
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.upkeep import UpkeepParams, denoised, nesting, overlap
from tests.builders import block

PARAMS = UpkeepParams()
SIZE = 0.02


def _cloud(*parts: F32) -> VoxelCloud:
    points = np.concatenate(parts)
    return VoxelCloud.of(points, np.zeros((len(points), 3), np.uint8), SIZE)


def _cup(x: float = 0.01) -> F32:
    return block((x, 0.01, 0.01), (x + 0.1, 0.11, 0.11), 0.02)


def _denoised(cloud: VoxelCloud) -> VoxelCloud:
    (clean,) = denoised([cloud], PARAMS)
    return clean


def test_clouds_denoised_together_are_those_denoised_apart() -> None:
    stray = np.array([[0.51, 0.01, 0.01], [0.53, 0.01, 0.01]], np.float32)
    clouds = [_cloud(_cup(), stray), _cloud(_cup(0.3)), _cloud(stray)]

    together = denoised(clouds, PARAMS)

    assert [c.keys.tolist() for c in together] == [_denoised(c).keys.tolist() for c in clouds]
    assert denoised([], PARAMS) == []


def test_a_small_clutter_away_from_the_thing_goes() -> None:
    stray = np.array([[0.51, 0.01, 0.01], [0.53, 0.01, 0.01]], np.float32)

    kept = _denoised(_cloud(_cup(), stray))

    assert kept.box[3] < 0.2
    assert len(kept) == len(_cloud(_cup()))


def test_a_large_second_part_stays() -> None:
    """Two legs of one table may hang together by nothing that was seen."""
    both = _cloud(_cup(), _cup(0.51))

    assert len(_denoised(both)) == len(both)


def test_voxels_seen_once_go_where_most_were_seen_again() -> None:
    edge = np.array([[0.131, 0.01, 0.01], [0.151, 0.01, 0.01]], np.float32)  # joined to the cup

    assert _denoised(_cloud(_cup(), _cup(), edge)).box[3] < 0.12
    assert _denoised(_cloud(_cup(), edge)).box[3] > 0.14  # nothing was seen twice yet


def test_one_voxel_is_left_alone() -> None:
    assert len(_denoised(_cloud(np.full((1, 3), 0.01, np.float32)))) == 1


def test_overlap_is_the_share_of_the_smaller_cloud_by_hand() -> None:
    """Ten voxels in a row against four, two of which lie on the ten."""
    ten = np.array([[0.01 + 0.02 * i, 0.01, 0.01] for i in range(10)], np.float32)
    four = np.array(
        [[0.15, 0.01, 0.01], [0.19, 0.01, 0.01], [0.41, 0.01, 0.01], [0.61, 0.01, 0.01]], np.float32
    )

    assert overlap(_cloud(ten), _cloud(four), 0.01) == 0.5
    assert overlap(_cloud(four), _cloud(ten), 0.01) == 0.5
    assert overlap(_cloud(ten), _cloud(ten), 0.01) == 1.0


def test_clouds_apart_do_not_overlap() -> None:
    assert overlap(_cloud(_cup()), _cloud(_cup(2.01)), 0.04) == 0.0


@pytest.mark.parametrize(
    ("a", "b", "share", "ratio"),
    [
        ((0, 0, 0, 1, 1, 1), (0, 0, 0, 2, 2, 2), 1.0, 1 / 8),
        ((0.5, 0, 0, 1.5, 1, 1), (0, 0, 0, 1, 4, 4), 0.5, 1 / 16),
        ((3, 3, 3, 4, 4, 4), (0, 0, 0, 1, 1, 1), 0.0, 1.0),
    ],
)
def test_nesting_is_the_share_of_the_smaller_box_and_its_part_of_the_larger_by_hand(
    a: Sequence[float], b: Sequence[float], share: float, ratio: float
) -> None:
    one, other = _box(a), _box(b)

    assert nesting(one, other, 0.0) == pytest.approx((share, ratio))
    assert nesting(other, one, 0.0) == pytest.approx((share, ratio))


def test_flat_boxes_have_the_thickness_of_the_slack() -> None:
    """A wall seen face on has no depth; half a voxel on each side gives it one."""
    wall, part = _box((0, 0, 0, 1, 1, 0)), _box((0.2, 0.2, 0, 0.4, 0.4, 0))

    assert nesting(wall, part, 0.01)[0] == pytest.approx(1.0)
    assert nesting(wall, part + np.array([0, 0, 0.5, 0, 0, 0.5]), 0.01)[0] == 0.0


def _box(corners: Sequence[float]) -> F64:
    return np.array(corners, np.float64)


def test_the_tail_of_noise_beside_what_was_seen_a_hundred_times_as_often_goes() -> None:
    """Drift of centimetres reaches a second count in the end; a side seen lately lies elsewhere and stays."""
    tail = np.array([[0.131, 0.01, 0.01]], np.float32)
    lately = block((0.01, 0.41, 0.01), (0.11, 0.51, 0.11), 0.02)
    cloud = _cloud(_cup(), _cup(), tail, tail, lately, lately)
    often = _cloud(_cup())
    for _ in range(8):
        often = often.merged(often)  # 256 times in the end
    cloud = cloud.merged(often)

    clean = _denoised(cloud)

    assert clean.counts.max() > 200
    assert clean.box[3] == pytest.approx(0.11, abs=0.01)
    assert clean.box[4] == pytest.approx(0.51, abs=0.01)
