"""Routes and the graph of passages."""

from __future__ import annotations

from ovip.codec.geometry import vector_message, vector_value, vectors_value
from ovip.codec.regions import edge_message, edge_value
from ovip.scene.navigation import Route
from ovip.scene.route_graph import RouteGraph, RouteLink, RouteNode
from ovip.v1 import regions_pb2


def route_message(r: Route) -> regions_pb2.PlanRouteResponse:
    return regions_pb2.PlanRouteResponse(
        path=[vector_message(corner) for corner in r.path],
        length=r.length,
        region_ids=r.region_ids,
        passages=[edge_message(edge) for edge in r.passages],
        why=r.why,
        revision=r.revision,
    )


def route_value(m: regions_pb2.PlanRouteResponse) -> Route:
    return Route(
        path=vectors_value(m.path),
        length=m.length,
        region_ids=tuple(m.region_ids),
        passages=tuple(edge_value(edge) for edge in m.passages),
        why=m.why,
        revision=m.revision,
    )


def route_graph_message(g: RouteGraph) -> regions_pb2.GetRouteGraphResponse:
    return regions_pb2.GetRouteGraphResponse(
        nodes=[
            regions_pb2.RouteNode(
                node=n.node,
                passage=edge_message(n.passage),
                floor=n.floor,
                position=vector_message(n.position),
            )
            for n in g.nodes
        ],
        links=[regions_pb2.RouteLink(a=k.a, b=k.b, region_id=k.region_id, length=k.length) for k in g.links],
        revision=g.revision,
    )


def route_graph_value(m: regions_pb2.GetRouteGraphResponse) -> RouteGraph:
    return RouteGraph(
        nodes=tuple(
            RouteNode(n.node, edge_value(n.passage), n.floor, vector_value(n.position)) for n in m.nodes
        ),
        links=tuple(RouteLink(k.a, k.b, k.region_id, k.length) for k in m.links),
        revision=m.revision,
    )
