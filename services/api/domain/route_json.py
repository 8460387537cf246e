"""Routes and the graph of passages as JSON values, in the world or the recording's frame."""

from __future__ import annotations

from typing import Any

from ovip.answer_json import OutputFrame, number, numbers
from ovip.scene.navigation import Route
from ovip.scene.route_graph import RouteGraph
from ovip.scene.types import RegionEdge


def route_to_json(route: Route, frame: OutputFrame) -> dict[str, Any]:
    """A way with what it leads through; `why` says why there is none."""
    return {
        "frame": frame.name,
        "path": numbers(frame.points(route.path)),
        "length": number(route.length),
        "region_ids": list(route.region_ids),
        "passages": [_passage(edge, frame) for edge in route.passages],
        "why": route.why,
        "regions_revision": route.revision,
    }


def route_graph_to_json(graph: RouteGraph, frame: OutputFrame) -> dict[str, Any]:
    """Passages as nodes, and the walks between them."""
    return {
        "frame": frame.name,
        "nodes": [
            {
                "node": node.node,
                "floor": node.floor,
                "position": numbers(frame.points(node.position)[0]),
                "passage": _passage(node.passage, frame),
            }
            for node in graph.nodes
        ],
        "links": [
            {
                "a": link.a,
                "b": link.b,
                "region_id": link.region_id or None,
                "length": number(link.length),
            }
            for link in graph.links
        ],
        "regions_revision": graph.revision,
    }


def _passage(edge: RegionEdge, frame: OutputFrame) -> dict[str, Any]:
    return {
        "kind": edge.kind.value,
        "a": edge.a,
        "b": edge.b,
        "width": number(edge.width),
        "position": numbers(frame.points(edge.position)[0]),
        "upper": None if edge.upper is None else numbers(frame.points(edge.upper)[0]),
    }
