"""Free space: walls bound F, furniture does not, and the unseen is not free."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN
from ovip.scene.types import F32
from services.regions.domain.evidence import CELL, FloorEvidence, pack_voxel
from services.regions.domain.floors import Storey, find_storeys
from services.regions.domain.free_space import FreeSpace, find_free_space
from tests.unit.services.regions.rooms import Span, plane, room, seen, two_rooms, without

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


# what tells furniture from walls


def boxed(x: Span, y: Span, height: float) -> F32:
    """A closed thing on the floor: its four sides and its top."""
    return np.concatenate(
        [
            plane(x, (y[0], y[0]), (0, height)),
            plane(x, (y[1], y[1]), (0, height)),
            plane((x[0], x[0]), y, (0, height)),
            plane((x[1], x[1]), y, (0, height)),
            plane(x, y, (height, height)),
        ]
    )


def with_thing(x: Span, y: Span, height: float) -> F32:
    """A room of 4 x 4 m with a thing in it; the floor under the thing is not seen."""
    hollow = without(room((0.025, 4.025), (0.025, 4.025)), x, y, (-0.1, height - 0.01))
    return np.concatenate([hollow, boxed(x, y, height)])


@pytest.mark.parametrize("height", [1.2, 1.6, 1.9, 2.05])
def test_a_row_of_wardrobes_through_a_room_does_not_cut_it(height: float) -> None:
    """Rays go on to the ceiling's height above it: it ends where no wall would."""
    cloud = with_thing((1.7, 2.3), (0.1, 4.0), height)
    space = space_of(seen((cloud, (1.0, 2.0, 1.4)), (cloud, (3.0, 2.0, 1.4))))
    for x in (1.0, 1.72, 2.0, 2.28, 3.0):
        assert space.free[at(space, x, 2.0)]
        assert not space.wall[at(space, x, 2.0)]
    assert space.occupancy[at(space, 1.72, 2.0)] == OCCUPIED
    assert space.occupancy[at(space, 2.0, 2.0)] != FREE


def test_a_partition_up_to_the_ceiling_cuts_a_room() -> None:
    cloud = with_thing((1.7, 2.3), (0.1, 4.0), 2.5)
    space = space_of(seen((cloud, (1.0, 2.0, 1.4)), (cloud, (3.0, 2.0, 1.4))))
    assert space.wall[at(space, 1.72, 2.0)]
    assert not space.free[at(space, 2.0, 2.0)]


def test_tall_furniture_that_nobody_looked_over_is_taken_for_a_wall() -> None:
    cloud = with_thing((1.7, 2.3), (0.1, 4.0), 2.0)
    low = cloud[cloud[:, 2] < 2.0]
    space = space_of(seen((low, (1.0, 2.0, 1.4)), (low, (3.0, 2.0, 1.4))))
    assert space.wall[at(space, 1.72, 2.0)]


def test_an_open_door_leaf_is_no_wall() -> None:
    """2 m high and 0.04 m thick, square to the wall; over it the ceiling is seen."""
    cloud = with_thing((2.0, 2.04), (0.03, 0.9), 2.0)
    space = space_of(seen((cloud, (1.0, 2.0, 1.4)), (cloud, (3.0, 2.0, 1.4))))
    assert space.free[at(space, 2.02, 0.5)]
    assert space.occupancy[at(space, 2.02, 0.5)] == OCCUPIED


def test_a_closed_door_is_a_wall() -> None:
    """Its leaf fills the doorway, and over it the wall goes on."""
    cloud = np.concatenate([room((0, 4), (0, 4)), plane((2.0, 2.0), (0, 4), (0, 2.5))])
    left, right = cloud[cloud[:, 0] <= 2.001], cloud[cloud[:, 0] >= 1.999]
    space = space_of(seen((left, (1.0, 2.0, 1.4)), (right, (3.0, 2.0, 1.4))))
    assert space.wall[at(space, 2.0, 1.0)]
    assert space.free[at(space, 1.0, 1.0)]
    assert space.free[at(space, 3.0, 1.0)]


# windows and the outdoors


PANE = (1.0, 3.0)


EYE = (2.0, 2.0, 1.4)


def through(points: F32, y: Span, z: Span) -> F32:
    """The points that EYE sees through an opening in the wall at x = 4.025."""
    share = (4.025 - EYE[0]) / (points[:, :1] - EYE[0])
    crossing = np.array(EYE) + (points - np.array(EYE)) * share
    seen_through = (crossing[:, 1:] > (y[0] + 0.05, z[0] + 0.05)) & (
        crossing[:, 1:] < (y[1] - 0.05, z[1] - 0.05)
    )
    return points[seen_through.all(axis=1)]


def with_opening(bottom: float, top: float) -> F32:
    """A room whose wall at x = 4 has glass from y 1 to 3: through it, ground and a house 3 m away are seen."""
    indoors = without(room((0.025, 4.025), (0.025, 4.025)), (4.0, 4.1), PANE, (bottom, top))
    beyond = np.concatenate([plane((4.1, 7.0), (-1, 5), (0, 0)), plane((7.0, 7.0), (-1, 5), (0.0, 3.5))])
    return np.concatenate([indoors, through(beyond, PANE, (bottom, top))])


@pytest.mark.parametrize("top", [2.0, 2.1, 2.2])
def test_what_is_seen_through_a_window_is_not_of_the_room(top: float) -> None:
    """Wall under and over it: the rays between do not make a doorway of it."""
    cloud = with_opening(0.8, top)
    space = space_of(seen((cloud, EYE)))
    assert space.wall[at(space, 4.03, 2.0)]
    assert space.free[at(space, 3.5, 2.0)]
    columns = np.arange(space.free.shape[1]) * space.resolution + space.origin[0]
    assert not space.free[:, columns > 4.1].any()
    assert not (space.occupancy[:, columns > 4.1] == FREE).any()


def test_outdoors_behind_glass_down_to_the_floor_is_not_of_the_room() -> None:
    """Under a lintel, with no ceiling beyond it, and no camera was there."""
    cloud = with_opening(0.0, 2.0)
    beyond = space_of(seen((cloud, EYE)))
    assert beyond.free[at(beyond, 3.5, 2.0)]
    assert not beyond.free[at(beyond, 5.5, 2.0)]
    assert beyond.occupancy[at(beyond, 5.5, 2.0)] == UNKNOWN


def test_outdoors_where_a_camera_was_is_free() -> None:
    cloud = with_opening(0.0, 2.0)
    space = space_of(seen((cloud, EYE), (cloud[cloud[:, 0] > 4.1], (5.5, 2.0, 1.4))))
    assert space.free[at(space, 5.0, 2.0)]


def test_a_room_that_is_looked_into_through_a_doorway_is_free() -> None:
    """A little of its ceiling shows."""
    ceiling = through(plane((5.8, 7.0), PANE, (2.5, 2.5)), PANE, (0.0, 2.0))
    space = space_of(seen((np.concatenate([with_opening(0.0, 2.0), ceiling]), EYE)))
    assert space.free[at(space, 5.5, 2.0)]


def test_no_ceiling_beyond_a_doorway_says_nothing_where_no_camera_saw_ceilings() -> None:
    cloud = with_opening(0.0, 2.0)
    level = cloud[(cloud[:, 2] < 2.3)]
    space = space_of(seen((level, EYE)))
    assert space.free[at(space, 5.5, 2.0)]


def test_a_place_that_is_seen_only_over_a_wall_is_not_reached() -> None:
    """A hatch between two rooms, wall under it and over it: the other room is not free before it was entered."""
    left, right = room((0.025, 4.025), (0.025, 4.025)), room((4.225, 8.225), (0.025, 4.025))
    hatch = (1.5, 2.5), (1.0, 2.0)
    beyond = through(right[right[:, 0] > 4.3], *hatch)
    near = np.concatenate([without(left, (4.0, 4.1), *hatch), beyond])
    once = space_of(seen((near, EYE)))
    assert len(beyond)
    assert not once.free[at(once, 6.0, 2.0)]
    entered = space_of(seen((near, EYE), (without(right, (4.2, 4.3), *hatch), (6.0, 2.0, 1.4))))
    assert entered.free[at(entered, 6.0, 2.0)]
    assert not entered.free[at(entered, 4.13, 2.0)]


# floors that end


def test_a_stairwell_is_not_free() -> None:
    """Seen down into: no floor and no thing in it, and the stairs are below."""
    well = ((2.0, 3.5), (1.0, 2.5), (-0.1, 0.1))
    floor = without(room((0.025, 4.025), (0.025, 4.025)), *well)
    stairs = plane((2.0, 3.5), (1.0, 2.5), (-1.4, -1.4))
    cloud = np.concatenate([floor, stairs])
    space = find_free_space(seen((cloud, (1.6, 1.7, 1.4)), (cloud, (3.0, 3.0, 1.4))), GROUND)
    assert not space.free[at(space, 2.7, 1.7)]
    assert space.occupancy[at(space, 2.7, 1.7)] == UNKNOWN
    assert space.free[at(space, 2.7, 3.0)]


def test_a_blind_spot_is_no_stairwell() -> None:
    blind = without(room((0.025, 4.025), (0.025, 4.025)), (2.0, 3.5), (1.0, 2.5), (-0.1, 0.1))
    space = space_of(seen((blind, (1.0, 1.7, 1.4))))
    assert space.free[at(space, 2.7, 1.7)]


# wherever and whenever


@pytest.mark.parametrize("shift", [(-30.0, -12.5, 0.0), (40_000.0, -40_000.0, 0.0), (5.0, 5.0, -8.0)])
def test_where_in_the_world_a_room_stands_changes_nothing(shift: tuple[float, float, float]) -> None:
    """Shifts are whole cells and slabs, points lie inside cells: the same cells are found, elsewhere."""
    cloud, camera, moved = (
        room((0.025, 4.025), (0.025, 3.025), 0.03, 2.5),
        np.array([2.02, 1.02, 1.22]),
        np.array(shift),
    )
    near = space_of(seen((cloud, camera)))
    far = space_of(seen((cloud + moved, camera + moved)))  # type: ignore[arg-type]
    assert far.free.sum() == pytest.approx(near.free.sum(), rel=0.02)
    assert far.origin == pytest.approx((near.origin[0] + shift[0], near.origin[1] + shift[1]))


def test_nothing_is_free_that_no_frame_saw() -> None:
    """A camera that looks along +x proves nothing behind it but the floor that it stands on."""
    cloud = room((0.025, 4.025), (0.025, 4.025))
    ahead = cloud[cloud[:, 0] > 2.5]
    space = space_of(seen((ahead, (2.0, 2.0, 1.4))))
    columns = (np.arange(space.free.shape[1]) + 1) * space.resolution + space.origin[0]
    assert not space.free[:, columns < 1.75].any()
    assert space.free[at(space, 3.0, 2.0)]


@settings(max_examples=15, deadline=None)
@given(st.permutations(range(4)))
def test_the_order_of_frames_changes_no_cell(order: list[int]) -> None:
    cloud = with_thing((1.7, 2.3), (0.1, 3.0), 1.9)
    views = [(cloud[k::2], (1.0 + 0.5 * k, 3.5, 1.4)) for k in range(4)]
    one, other = FloorEvidence(), FloorEvidence()
    for number in range(4):
        one.add(f"f{number}", views[number][0], np.array(views[number][1]))
    for number in order:
        other.add(f"f{number}", views[number][0], np.array(views[number][1]))
    for mask in ("free", "wall", "occupancy"):
        assert (getattr(space_of(one), mask) == getattr(space_of(other), mask)).all()
