"""Free space: walls bound F, furniture does not, and the unseen is not free."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN
from ovip.scene.types import F32
from services.regions.domain.evidence import CELL, FloorEvidence, pack_voxel
from services.regions.domain.floors import Storey, find_storeys
from services.regions.domain.free_space import FreeSpace, find_free_space
from tests.unit.services.regions.rooms import plane, room, seen, two_rooms, without

GROUND = Storey(0.0, None, -np.inf, np.inf)


def space_of(evidence: FloorEvidence) -> FreeSpace:
    return find_free_space(evidence, find_storeys(evidence)[0])


def at(space: FreeSpace, x: float, y: float) -> tuple[int, int]:
    return int((y - space.origin[1]) / space.resolution), int((x - space.origin[0]) / space.resolution)


def with_table() -> F32:
    """A room with a table of panels, its top at 0.72 m; what is under it is not seen."""
    table = np.concatenate(
        [
            plane((1.5, 2.5), (2.0, 3.0), (0.72, 0.72)),
            plane((1.5, 2.5), (2.0, 2.0), (0.0, 0.72)),
            plane((1.5, 1.5), (2.0, 3.0), (0.0, 0.72)),
        ]
    )
    return np.concatenate([without(room((0, 4), (0, 4)), (1.5, 2.5), (2.0, 3.0), (-0.1, 0.1)), table])


def test_f_is_the_floor_between_the_walls() -> None:
    space = space_of(seen((room((0.025, 4.025), (0.025, 3.025)), (2.0, 1.0, 1.2))))
    assert space.free.sum() * space.resolution**2 == pytest.approx(12.0, rel=0.06)
    assert space.free[at(space, 2, 1)]
    assert not space.free[at(space, 4.03, 1)]
    assert space.wall[at(space, 4.03, 1.0)]


def test_furniture_is_in_f_but_occupied() -> None:
    space = space_of(seen((with_table(), (2.0, 1.0, 1.3)), (with_table(), (2.1, 1.0, 1.3))))
    assert space.free[at(space, 2.0, 2.5)]
    assert not space.wall[at(space, 2.0, 2.0)]
    assert space.occupancy[at(space, 2.0, 2.5)] == OCCUPIED
    assert space.occupancy[at(space, 1.0, 1.0)] == FREE


def test_an_obstacle_hit_once_is_neither_free_nor_an_obstacle() -> None:
    speck = np.array([[1.02, 1.02, 0.5]], np.float32)
    space = space_of(seen((np.concatenate([room((0, 4), (0, 4)), speck]), (2.0, 2.0, 1.2))))
    assert space.occupancy[at(space, 1.02, 1.02)] == UNKNOWN


def test_the_head_of_a_door_does_not_close_it() -> None:
    space = space_of(two_rooms())
    for x in (4.03, 4.12, 4.23):
        assert space.free[at(space, x, 2.0)]
        assert not space.free[at(space, x, 1.0)]


def test_what_was_never_seen_is_unknown_and_not_free() -> None:
    half = without(room((0, 4), (0, 4)), (2.0, 4.1), (-0.1, 4.1), (-0.1, 2.6))
    space = space_of(seen((half, (1.0, 2.0, 1.2))))
    assert space.free.shape[1] * space.resolution < 2.6
    assert (space.occupancy[:, -1] == UNKNOWN).all()


def test_a_small_blind_spot_is_filled_in_f_and_stays_unknown_to_a_robot() -> None:
    """Only the floor itself was counted: no rays, no camera over it."""
    blind = without(plane((0, 3), (0, 3), (0, 0)), (1.0, 1.6), (1.0, 1.6), (-0.1, 0.1))
    evidence = FloorEvidence()
    evidence.hits.add(np.unique(pack_voxel(np.floor(blind / CELL).astype(np.int64))))
    space = find_free_space(evidence, GROUND)
    assert space.free[at(space, 1.3, 1.3)]
    assert space.occupancy[at(space, 1.3, 1.3)] == UNKNOWN


def test_a_wall_seen_only_low_is_still_a_wall() -> None:
    low = room((0.025, 3.025), (0.025, 3.025))
    space = space_of(seen((low[low[:, 2] < 1.35], (1.5, 1.5, 1.2))))
    assert space.wall[at(space, 3.03, 1.5)]


def test_a_post_is_no_wall() -> None:
    post = plane((2.0, 2.0), (2.0, 2.04), (0, 2.4))
    space = space_of(seen((np.concatenate([room((0, 4), (0, 4)), post]), (1.0, 1.0, 1.2))))
    assert space.free[at(space, 2.0, 2.02)]
    assert space.occupancy[at(space, 2.0, 2.02)] == OCCUPIED


def test_where_the_camera_was_carried_is_free() -> None:
    space = find_free_space(seen((np.zeros((0, 3), np.float32), (1.0, 1.0, 1.2))), GROUND)
    assert space.occupancy[at(space, 1.0, 1.15)] == FREE
    assert space.free.sum() * space.resolution**2 == pytest.approx(np.pi * 0.2**2, rel=0.3)


def test_an_empty_storey_has_no_cells() -> None:
    space = find_free_space(FloorEvidence(), GROUND)
    assert space.free.shape == space.occupancy.shape == (0, 0)


def test_the_other_storey_is_not_in_the_way() -> None:
    below, above = room((0, 3), (0, 3), height=2.6), room((4, 7), (0, 3), floor=2.9)
    evidence = seen((below, (1.5, 1.5, 1.2)), (above, (5.5, 1.5, 4.1)))
    lower, upper = (find_free_space(evidence, storey) for storey in find_storeys(evidence))
    assert lower.origin[0] < 0.1
    assert upper.origin[0] > 3.5
