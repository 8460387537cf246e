"""Alignment of two recordings: found where there is one place, refused in words where it cannot be told."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from ovip.errors import InvalidInput, NotConfigured, Unreliable
from ovip.scene.types import F64
from services.mapper.adapters.alignment import IcpAligner
from services.mapper.domain.registration import turn
from tests.unit.services.mapper.surfaces import moved, resampled, room

pytest.importorskip("open3d", reason="alignment needs Open3D, of the extra 'lab'")

BED = (0.3, 0.2, 0.0, 2.3, 1.6, 0.5)
CUPBOARD = (3.4, 2.5, 0.0, 4.0, 4.0, 2.0)
TABLE = (2.9, 0.4, 0.0, 4.1, 1.2, 0.7)
ROOM = room(5.0, 4.2, BED, CUPBOARD, TABLE)
ALIGNER = IcpAligner()


def _inverse(pose: F64) -> F64:
    return np.asarray(np.linalg.inv(pose), np.float64)


def _truth(seed: int) -> F64:
    rng = np.random.default_rng(seed)
    made = turn(float(rng.uniform(0, 2 * np.pi)))
    made[:3, 3] = rng.uniform(-8, 8, 3) * [1, 1, 0.1]
    return made


@pytest.mark.parametrize("seed", range(4))
def test_two_looks_at_one_room_align_within_a_centimetre(seed: int) -> None:
    truth = _truth(seed)
    other = moved(resampled(ROOM, seed), _inverse(truth))

    found = ALIGNER.align(ROOM, other, None)

    off = moved(other, found.world_from_other) - moved(other, truth)
    assert np.linalg.norm(off, axis=1).max() < 0.01
    assert found.overlap > 0.9
    assert found.rmse < 0.01


def test_two_overlapping_parts_align() -> None:
    truth = _truth(9)
    left, right = ROOM[ROOM[:, 0] < 3.6], ROOM[ROOM[:, 0] > 1.2]

    found = ALIGNER.align(left, moved(resampled(right, 9), _inverse(truth)), None)

    assert np.allclose(found.world_from_other, truth, atol=0.02)
    assert 0.5 < found.overlap < 0.95


def test_a_guess_decides_what_shape_alone_cannot() -> None:
    bare = room(5.0, 4.2)

    with pytest.raises(Unreliable, match="ambiguous"):
        ALIGNER.align(bare, resampled(bare, 3), None)
    found = ALIGNER.align(bare, resampled(bare, 3), turn(0.03))

    assert np.allclose(found.world_from_other, np.eye(4), atol=0.01)


def test_another_room_is_refused_with_the_figures() -> None:
    another = room(
        7.5, 2.6, (6.0, 0.2, 0, 7.0, 1.6, 0.9), (1.0, 1.8, 0, 3.0, 2.5, 1.3), (3.5, 0.1, 0, 4.0, 0.9, 1.7)
    )

    with pytest.raises(Unreliable, match=r"overlap 0\.\d\d, agreement 0\.\d\d, rmse \d\.\d cm"):
        ALIGNER.align(ROOM, another, None)


@pytest.mark.parametrize("points", [np.zeros((0, 3), np.float32), ROOM[:50]])
def test_a_surface_that_is_too_small_is_refused(
    points: np.ndarray[tuple[int, ...], np.dtype[np.float32]],
) -> None:
    with pytest.raises(InvalidInput, match="the other surface has"):
        ALIGNER.align(ROOM, points, None)
    with pytest.raises(InvalidInput, match="this surface has"):
        ALIGNER.align(points, ROOM, None)


def test_points_that_are_no_numbers_are_refused() -> None:
    broken = ROOM.copy()
    broken[7, 1] = np.nan

    with pytest.raises(InvalidInput, match="no numbers"):
        ALIGNER.align(ROOM, broken, None)


def test_a_guess_that_does_not_keep_z_up_is_refused() -> None:
    with pytest.raises(InvalidInput, match="guess: expected z to stay up"):
        ALIGNER.align(ROOM, ROOM, np.diag([1.0, -1.0, -1.0, 1.0]))


def test_without_open3d_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "open3d", None)

    with pytest.raises(NotConfigured, match=r"pip install 'ovip-sg\[lab\]'"):
        ALIGNER.align(ROOM, ROOM, None)
