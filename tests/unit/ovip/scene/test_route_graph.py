from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.errors import InvalidInput
from ovip.scene.building import Building
from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.route_graph import RouteGraph, route_graph
from ovip.scene.types import Partition
from tests.unit.ovip.scene.buildings import building, door, stairs, storey

# a hall 6 m long with a kitchen at one end and a study at the other, and a bedroom above
DOWN = storey(
    "kkk#########sss",
    "kkkkhhhhhhhssss",
    "kkk#########sss",
)
UP = storey("bbbbbbbbb", floor=1)
DOORS = [door("h", "k", 2.0, 0.75), door("h", "s", 5.5, 0.75)]
FLIGHT = stairs("h", "b", (3.75, 0.75, 0.0), (0.25, 0.25, 3.0))


def links(graph: RouteGraph) -> list[tuple[int, int, str, float]]:
    return [(k.a, k.b, k.region_id, round(k.length, 6)) for k in graph.links]


def test_passages_are_nodes_and_links_are_metres_walked_inside_a_region() -> None:
    graph = route_graph(*building([DOWN], DOORS), 0.2)
    assert [(n.node, n.floor, n.position.tolist()) for n in graph.nodes] == [
        (0, 0, [2.25, 0.75, 0.0]),
        (1, 0, [5.25, 0.75, 0.0]),
    ]
    assert links(graph) == [(0, 1, "rh", 3.0)]
    assert graph.revision == 3


def test_stairs_have_a_node_on_both_floors() -> None:
    graph = route_graph(*building([DOWN, UP], [*DOORS, FLIGHT]), 0.2)
    assert [n.floor for n in graph.nodes] == [0, 0, 0, 1]
    assert [n.position.tolist() for n in graph.nodes[2:]] == [[3.75, 0.75, 0.0], [0.25, 0.25, 3.0]]
    climb = round(float(np.sqrt(3.5**2 + 0.5**2 + 3.0**2)), 6)
    assert links(graph) == [(0, 1, "rh", 3.0), (0, 2, "rh", 1.5), (1, 2, "rh", 1.5), (2, 3, "", climb)]


def test_two_doorways_between_two_rooms_are_linked_through_both() -> None:
    rooms = storey("hhhhh#kkkkk", "hhhhhhkkkkk", "hhhhh#kkkkk", "hhhhhhkkkkk", "hhhhh#kkkkk")
    both = [door("h", "k", 3.0, 0.75), door("h", "k", 3.0, 1.75)]
    graph = route_graph(*building([rooms], both), 0.2)
    # from the cell in the doorway, which is the hall's: one step in, one metre along, one step back
    by_hall = 2 * 0.5 + 1.0
    assert links(graph) == [(0, 1, "rh", by_hall), (0, 1, "rk", by_hall)]


def test_a_passage_that_the_robot_does_not_fit_through_is_left_out() -> None:
    wide = storey("hhhhhkkkkk", "hhhhhkkkkk", "hhhhhkkkkk", "hhhhh#kkkk", "hhhhhkkkkk")
    both = [door("h", "k", 2.5, 0.75, width=1.5), door("h", "k", 2.5, 2.25)]
    assert len(route_graph(*building([wide], both), 0.2).nodes) == 2
    assert len(route_graph(*building([wide], both), 0.3).nodes) == 1


def test_furniture_between_two_doorways_of_a_room_unlinks_them() -> None:
    blocked = storey("kkk#########sss", "kkkkhhhHhhhssss", "kkk#########sss")
    assert links(route_graph(*building([blocked], DOORS), 0.2)) == []


def test_a_node_in_a_wide_opening_stands_beside_the_furniture_in_its_middle() -> None:
    table = storey("hhhhkkkk", "hhhHkkkk", "hhhhkkkk")
    graph = route_graph(*building([table], [door("h", "k", 2.0, 0.75, width=1.5)]), 0.2)
    assert [n.position.tolist() for n in graph.nodes] == [[1.75, 0.25, 0.0]]


def test_nothing_known_is_an_empty_graph() -> None:
    assert route_graph(Partition(0, 0), {}, 0.2) == RouteGraph()
    with pytest.raises(InvalidInput):
        route_graph(Partition(0, 0), {}, -1.0)


@settings(max_examples=60, deadline=None)
@given(
    arrays.arrays(
        np.uint8,
        st.tuples(st.integers(2, 9), st.integers(2, 9)),
        elements=st.sampled_from([FREE, FREE, OCCUPIED]),
    ),
    st.integers(0, 2**31 - 1),
    st.floats(0.0, 0.3),
)
def test_a_link_is_the_geodesic_wherever_the_shortest_way_stays_in_its_region(
    occupancy: np.ndarray, seed: int, radius: float
) -> None:
    rng = np.random.default_rng(seed)
    middles = rng.uniform(0, 9, (3, 2))
    cells = np.indices(occupancy.shape).reshape(2, -1).T
    nearest = np.linalg.norm(cells[:, None] - middles[None], axis=2).argmin(axis=1).reshape(occupancy.shape)
    ids, labels = np.unique(nearest, return_inverse=True)
    labels = labels.reshape(occupancy.shape) + 1
    grid = FloorGrid(
        0, (0.0, 0.0), 0.5, occupancy, labels.astype(np.uint16), tuple(f"r{k}" for k in range(len(ids)))
    )
    borders = np.argwhere(labels[:, :-1] != labels[:, 1:])[:5]
    doors = [
        door(
            str(labels[row, column] - 1),
            str(labels[row, column + 1] - 1),
            0.5 * (column + 1),
            0.5 * row + 0.25,
        )
        for row, column in borders.tolist()
    ]
    partition, grids = building([grid], doors)
    graph = route_graph(partition, grids, radius)
    home = Building(partition, grids, radius)
    spots = [(0, *grid.cell_of(node.position)) for node in graph.nodes]
    assert all(home.standing[0][spot[1:]] for spot in spots)
    linked = {(link.a, link.b, link.region_id): link.length for link in graph.links}
    for (a, b, _), length in linked.items():
        assert length >= home.distances(spots[a])[0][spots[b][1:]] - 1e-9
    for a, b in combinations(range(len(spots)), 2):
        legs = home.legs(spots[a], spots[b])
        inside = {int(label) for label in labels.ravel()[legs[0].cells[1:-1]]} if legs else {0}
        shared = {graph.nodes[a].passage.a, graph.nodes[a].passage.b} & {
            graph.nodes[b].passage.a,
            graph.nodes[b].passage.b,
        }
        for region_id in shared:
            if inside <= {1 + grid.region_ids.index(region_id)}:
                geodesic = home.distances(spots[a])[0][spots[b][1:]]
                assert linked[(a, b, region_id)] == pytest.approx(geodesic)
    turned, _ = building([grid], doors[::-1])
    mirrored = route_graph(turned, grids, radius)
    assert sorted(round(k.length, 6) for k in mirrored.links) == sorted(
        round(k.length, 6) for k in graph.links
    )
