from __future__ import annotations

import numpy as np

from ovip import codec
from ovip.scene.navigation import Route, plan_route
from ovip.scene.route_graph import RouteGraph, route_graph
from ovip.v1 import regions_pb2
from tests.builders import same
from tests.unit.ovip.scene.buildings import building, door, stairs, storey

HOME = building(
    [storey("hhhh#kkkk", "hhhhhkkkk", "hhhh#kkkk"), storey("bbbbbbbbb", floor=1)],
    [door("h", "k", 2.5, 0.75), stairs("h", "b", (0.25, 0.25, 0.0), (4.25, 0.25, 3.0))],
)


def test_a_route_survives_the_wire() -> None:
    route = plan_route(*HOME, np.array([4.25, 0.75, 0.0]), np.array([0.25, 0.25, 3.0]), 0.2)
    assert len(route.passages) == 2
    sent = regions_pb2.PlanRouteResponse.FromString(codec.route_message(route).SerializeToString())
    assert same(codec.route_value(sent), route)


def test_no_way_survives_the_wire() -> None:
    route = plan_route(HOME[0], {}, np.zeros(3), np.ones(3), 0.2)
    back = codec.route_value(codec.route_message(route))
    assert same(back, route)
    assert isinstance(back, Route)
    assert back.path.shape == (0, 3)


def test_a_route_graph_survives_the_wire() -> None:
    graph = route_graph(*HOME, 0.2)
    assert len(graph.links) == 2
    sent = regions_pb2.GetRouteGraphResponse.FromString(codec.route_graph_message(graph).SerializeToString())
    assert same(codec.route_graph_value(sent), graph)
    assert codec.route_graph_value(codec.route_graph_message(RouteGraph())) == RouteGraph()
