"""Where one surface may lie on another: the true placement comes first, and chance counts for nothing."""

from __future__ import annotations

import numpy as np
import pytest

from services.mapper.domain.registration import SearchParams, agreement, differ, propose, turn
from tests.unit.services.mapper.surfaces import moved, resampled, room

BED = (0.3, 0.2, 0.0, 2.3, 1.6, 0.5)
CUPBOARD = (3.4, 2.5, 0.0, 4.0, 4.0, 2.0)
TABLE = (2.9, 0.4, 0.0, 4.1, 1.2, 0.7)
ROOM = room(5.0, 4.2, BED, CUPBOARD, TABLE)
PARAMS = SearchParams()


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.2, 4.0])
def test_the_first_proposal_is_where_the_room_was_taken_from(yaw: float) -> None:
    truth = turn(yaw)
    truth[:3, 3] = 3.0, -6.0, 0.4
    other = moved(resampled(ROOM, 1), np.asarray(np.linalg.inv(truth), np.float64))

    best = propose(ROOM, other, PARAMS)[0]

    centre = other.mean(axis=0).astype(np.float64)
    off = (best.world_from_other - truth)[:3, :3] @ centre + (best.world_from_other - truth)[:3, 3]
    assert np.abs(off).max() < 1.5 * PARAMS.cell
    assert abs(np.angle(np.exp(1j * (_yaw(best.world_from_other) - yaw)))) <= PARAMS.turn


def _yaw(pose: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    return float(np.arctan2(pose[1, 0], pose[0, 0]))


def test_proposals_are_all_different_and_the_best_come_first() -> None:
    found = propose(ROOM, resampled(ROOM, 2), PARAMS)

    assert [one.score for one in found] == sorted((one.score for one in found), reverse=True)
    assert all(
        differ(a.world_from_other, b.world_from_other, np.array([2.5, 2.1, 0.0]), PARAMS)
        for i, a in enumerate(found)
        for b in found[:i]
    )


def test_two_bare_floors_have_nothing_in_common_beyond_chance() -> None:
    floor = ROOM[ROOM[:, 2] == 0]

    assert agreement(floor, floor, 0.1) == pytest.approx(0.0, abs=1e-6)
    assert max(one.score for one in propose(floor, floor, PARAMS)) == pytest.approx(0.0, abs=1e-3)


def test_a_room_agrees_with_itself_and_not_with_itself_turned_around() -> None:
    about = turn(np.pi)
    about[:3, 3] = 5.0, 4.2, 0.0  # about its middle: the walls fall on each other

    assert agreement(ROOM, resampled(ROOM, 3), 0.1) > 0.95
    assert 0.2 < agreement(ROOM, moved(ROOM, about), 0.1) < 0.8


def test_surfaces_that_share_no_floor_plan_do_not_agree() -> None:
    away = np.eye(4)
    away[0, 3] = 50.0

    assert agreement(ROOM, moved(ROOM, away), 0.1) == 0.0


def test_agreement_by_hand() -> None:
    """4 x 4 columns with a floor; one has a post in one column, the other beside it, or three columns away.

    A cell counts with its neighbours. Cells: 16 of the floor, at the post 1 in each of the layers 1 to 9. Layer 0: by
    chance 16. Layer 1 is beside the floor, by chance 1. Layers 2 to 9: the other's grown post covers 3 x 3 of 16
    columns where it stands inside, by chance 9/16 each. Found: all 25 for the near one; kappa 1.
    """
    columns = np.array([(x, y) for x in range(4) for y in range(4)], np.float64)
    floor = np.column_stack([columns + 0.5, np.full(16, 0.5)])
    post = [[1.5, 1.5, z + 0.5] for z in range(1, 10)]
    beside = [[2.5, 2.5, z + 0.5] for z in range(1, 10)]
    a, b = (np.concatenate([floor, part]).astype(np.float32) for part in (post, beside))
    corner = np.concatenate([floor, [[3.5, 3.5, z + 0.5] for z in range(1, 10)]]).astype(np.float32)

    assert agreement(a, b, 1.0) == pytest.approx(1.0)
    # the corner's post covers 2 x 2 of 16 columns: none of 8 found where chance gives 2; its own chance is 9/16 of 8
    expected = (
        (17 - (17 + 8 * 4 / 16)) / (25 - (17 + 8 * 4 / 16)) + (17 - (17 + 4.5)) / (25 - (17 + 4.5))
    ) / 2
    assert agreement(a, corner, 1.0) == pytest.approx(expected)
