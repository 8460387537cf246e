from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.errors import InvalidInput
from ovip.scene.building import Building, check_radius, floor_of, joined
from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.types import Floor, Partition
from ovip.scene.walking import distance_field
from tests.unit.ovip.scene.buildings import building, stairs, storey

OCCUPANCIES = arrays.arrays(
    np.uint8,
    st.tuples(st.integers(1, 8), st.integers(1, 8)),
    elements=st.sampled_from([UNKNOWN, FREE, FREE, FREE, OCCUPIED]),
)
DOWN, UP = storey("hhhhh"), storey("bbbbb", floor=1)
FLIGHT = stairs("h", "b", (2.25, 0.25, 0.0), (0.25, 0.25, 3.0))


def test_distances_run_over_the_stairs() -> None:
    home = Building(*building([DOWN, UP], [FLIGHT]), 0.0)
    climb = np.hypot(2.0, 3.0)
    fields = home.distances((0, 0, 3))
    assert fields[0][0].tolist() == pytest.approx([1.5, 1.0, 0.5, 0.0, 0.5])
    assert fields[1][0].tolist() == pytest.approx([0.5 + climb + 0.5 * k for k in range(5)])


def test_of_two_flights_between_the_same_cells_the_shorter_is_taken() -> None:
    steep = stairs("h", "b", (2.25, 0.25, 0.0), (0.75, 0.25, 3.0))
    spiral = stairs("h", "b", (2.25, 0.5, 0.0), (0.75, 0.5, 3.0))
    for edges in ([steep, spiral], [spiral, steep]):
        home = Building(*building([DOWN, UP], edges), 0.0)
        assert home.distances((0, 0, 4))[1][0, 1] == pytest.approx(np.hypot(1.5, 3.0))
        legs = home.legs((0, 0, 4), (1, 0, 1))
        assert [leg.flight and leg.flight.edge is steep for leg in legs] == [True, None]


def test_stairs_without_floor_to_stand_on_at_both_ends_join_nothing() -> None:
    far = stairs("h", "b", (2.25, 0.25, 0.0), (9.0, 0.25, 3.0))
    level = stairs("h", "h", (2.25, 0.25, 0.0), (0.25, 0.25, 0.0))
    home = Building(*building([DOWN, UP], [far, level]), 0.0)
    assert home.flights == ()
    assert home.legs((0, 0, 0), (1, 0, 0)) == ()
    assert joined((), ()).shape == (0, 3)


def test_legs_are_walked_cell_by_cell_or_in_straight_lines() -> None:
    home = Building(*building([DOWN, UP], [FLIGHT]), 0.0)
    legs = home.legs((0, 0, 2), (1, 0, 2))
    assert [leg.floor for leg in legs] == [0, 1]
    assert home.centres(legs[0]).tolist() == [[1.25, 0.25, 0.0], [1.75, 0.25, 0.0], [2.25, 0.25, 0.0]]
    assert home.straight(legs[0]).tolist() == [[1.25, 0.25, 0.0], [2.25, 0.25, 0.0]]
    line = joined(legs, [home.straight(leg) for leg in legs])
    assert line[2:4].tolist() == [[2.25, 0.25, 0.0], [0.25, 0.25, 3.0]]


def test_nothing_known_is_a_building_without_storeys() -> None:
    home = Building(Partition(0, 0), {}, 0.2)
    assert (home.grids, home.pieces, home.flights) == ({}, {}, ())
    assert home.floor_at(np.zeros(3)) is None
    assert home.spot_at(np.zeros(3)) is None


@pytest.mark.parametrize("radius", [-1e-9, np.nan, np.inf, 2.5])
def test_a_radius_is_checked(radius: float) -> None:
    with pytest.raises(InvalidInput, match="0 to 2 metres"):
        check_radius(radius)


def test_a_height_belongs_to_the_floor_below_it() -> None:
    floors = (Floor(0, 0.0, 2.5, 9.0), Floor(1, 3.0, 5.5, 9.0))
    assert floor_of(0.8, floors) == floors[0]
    assert floor_of(2.9, floors) == floors[1]
    assert floor_of(-1.0, floors) == floors[0]
    assert floor_of(1.0, ()) is None


@settings(max_examples=40, deadline=None)
@given(OCCUPANCIES, st.floats(0.0, 0.6))
def test_without_stairs_a_building_is_its_floors(occupancy: np.ndarray, radius: float) -> None:
    grid = FloorGrid(0, (0.0, 0.0), 0.5, occupancy, np.zeros(occupancy.shape, np.uint16))
    home = Building(*building([grid]), radius)
    for row, column in np.argwhere(home.standing[0])[:3].tolist():
        own = distance_field(home.standing[0], (row, column), 0.5)
        assert home.distances((0, row, column))[0].tolist() == own.tolist()
        same = home.pieces[0] == home.pieces[0][row, column]
        assert (same & home.standing[0]).tolist() == np.isfinite(own).tolist()
