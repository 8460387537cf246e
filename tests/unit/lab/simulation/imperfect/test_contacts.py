"""What stands on what in a picture."""

from __future__ import annotations

import numpy as np

from lab.simulation.imperfect.contacts import contacts
from ovip.scene.types import F32, U16


def carriers(ids: U16, depth: F32) -> dict[int, int]:
    return contacts(ids, depth, np.bincount(ids.ravel())).carrier


def scene() -> tuple[U16, F32]:
    """A cup (3) on a table (2) in front of a wall (1): rows down, the wall a metre behind."""
    ids = np.full((20, 20), 1, np.uint16)
    depth = np.full((20, 20), 3.0, np.float32)
    ids[10:, :], depth[10:, :] = 2, 2.0
    ids[6:12, 8:12], depth[6:12, 8:12] = 3, 2.0
    return ids, depth


def test_a_cup_stands_on_the_table_and_does_not_touch_the_wall_behind() -> None:
    assert carriers(*scene()) == {3: 2}


def test_a_picture_hangs_on_the_wall_that_it_touches() -> None:
    ids = np.full((20, 20), 1, np.uint16)
    ids[5:10, 5:10] = 4
    depth = np.full((20, 20), 2.0, np.float32)
    assert carriers(ids, depth) == {4: 1}


def test_a_thing_between_two_stands_on_the_lower_one() -> None:
    ids = np.full((30, 10), 1, np.uint16)
    ids[20:] = 2
    ids[18:20, 2:6] = 3  # four pixels of table below, four of wall above, two at each side
    depth = np.full((30, 10), 2.0, np.float32)
    assert carriers(ids, depth)[3] == 2


def test_a_touch_of_two_pixels_is_no_contact() -> None:
    ids = np.zeros((10, 10), np.uint16)
    ids[5:, :] = 1
    ids[3:5, 4:6] = 2
    depth = np.full((10, 10), 2.0, np.float32)
    assert carriers(ids, depth) == {}


def test_what_has_no_depth_touches_nothing() -> None:
    ids, depth = scene()
    assert carriers(ids, np.zeros_like(depth)) == {}


def test_the_things_on_a_thing_come_by_id() -> None:
    ids, depth = scene()
    ids[10:14, 0:4], ids[12:15, 15:19] = 9, 7
    assert contacts(ids, depth, np.bincount(ids.ravel())).carried_by(2) == [3, 7, 9]
