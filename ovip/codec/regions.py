"""Partitions of the floors, and their navigation grids."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from ovip.codec.geometry import polygon_message, polygon_value, vector_message, vector_value
from ovip.codec.reading import parsed
from ovip.errors import Corrupt
from ovip.scene.grid import FloorGrid
from ovip.scene.types import (
    EdgeKind,
    Floor,
    Frontier,
    Partition,
    Region,
    RegionEdge,
    RegionEvent,
    RegionEventKind,
)
from ovip.v1 import regions_pb2

K = TypeVar("K")
_EDGES = {
    EdgeKind.OPENING: regions_pb2.REGION_EDGE_KIND_OPENING,
    EdgeKind.DOORWAY: regions_pb2.REGION_EDGE_KIND_DOORWAY,
    EdgeKind.STAIRS: regions_pb2.REGION_EDGE_KIND_STAIRS,
}
_EVENTS = {
    RegionEventKind.APPEARED: regions_pb2.REGION_EVENT_KIND_APPEARED,
    RegionEventKind.VANISHED: regions_pb2.REGION_EVENT_KIND_VANISHED,
    RegionEventKind.RETYPED: regions_pb2.REGION_EVENT_KIND_RETYPED,
    RegionEventKind.RESHAPED: regions_pb2.REGION_EVENT_KIND_RESHAPED,
}


def partition_message(p: Partition) -> regions_pb2.Partition:
    return regions_pb2.Partition(
        map_version=p.map_version,
        revision=p.revision,
        floors=[
            regions_pb2.FloorSummary(floor=f.floor, z=f.z, ceiling_z=f.ceiling_z or 0.0, area=f.area)
            for f in p.floors
        ],
        regions=[
            regions_pb2.Region(
                region_id=r.region_id,
                floor=r.floor,
                function=r.function,
                display_name=r.display_name,
                area=r.area,
                centroid=vector_message(r.centroid),
                outlines=[polygon_message(ring) for ring in r.outlines],
                holes=[polygon_message(ring) for ring in r.holes],
                object_ids=r.object_ids,
                frame_ids=r.frame_ids,
                seen_by=r.seen_by,
            )
            for r in p.regions
        ],
        edges=[edge_message(edge) for edge in p.edges],
        fallbacks=p.fallbacks,
        frontiers=[
            regions_pb2.Frontier(
                floor=f.floor, region_id=f.region_id, position=vector_message(f.position), width=f.width
            )
            for f in p.frontiers
        ],
        events=[
            regions_pb2.RegionEvent(
                kind=_EVENTS[e.kind],
                region_id=e.region_id,
                floor=e.floor,
                display_name=e.display_name,
                other=e.other,
            )
            for e in p.events
        ],
    )


def partition_value(m: regions_pb2.Partition) -> Partition:
    return Partition(
        map_version=m.map_version,
        revision=m.revision,
        floors=tuple(Floor(f.floor, f.z, f.ceiling_z or None, f.area) for f in m.floors),
        regions=tuple(
            Region(
                region_id=r.region_id,
                floor=r.floor,
                function=r.function,
                display_name=r.display_name,
                area=r.area,
                centroid=vector_value(r.centroid),
                outlines=tuple(polygon_value(ring) for ring in r.outlines),
                holes=tuple(polygon_value(ring) for ring in r.holes),
                object_ids=tuple(r.object_ids),
                frame_ids=tuple(r.frame_ids),
                seen_by=tuple(r.seen_by),
            )
            for r in m.regions
        ),
        edges=tuple(edge_value(edge) for edge in m.edges),
        fallbacks=tuple(m.fallbacks),
        frontiers=tuple(
            Frontier(f.floor, f.region_id, vector_value(f.position), f.width) for f in m.frontiers
        ),
        events=tuple(
            RegionEvent(
                _known(_EVENTS, e.kind, "region event"), e.region_id, e.floor, e.display_name, e.other
            )
            for e in m.events
        ),
    )


def edge_message(e: RegionEdge) -> regions_pb2.RegionEdge:
    return regions_pb2.RegionEdge(
        a=e.a,
        b=e.b,
        width=e.width,
        position=vector_message(e.position),
        kind=_EDGES[e.kind],
        upper=None if e.upper is None else vector_message(e.upper),
    )


def edge_value(m: regions_pb2.RegionEdge) -> RegionEdge:
    return RegionEdge(
        m.a,
        m.b,
        m.width,
        vector_value(m.position),
        _known(_EDGES, m.kind, "region edge"),
        vector_value(m.upper) if m.HasField("upper") else None,
    )


def encode_partition(p: Partition) -> bytes:
    return partition_message(p).SerializeToString(deterministic=True)


def decode_partition(data: bytes) -> Partition:
    return partition_value(parsed(regions_pb2.Partition, data))


def floor_grid_message(g: FloorGrid) -> regions_pb2.GetFloorGridResponse:
    return regions_pb2.GetFloorGridResponse(
        floor=g.floor,
        origin_x=g.origin[0],
        origin_y=g.origin[1],
        resolution=g.resolution,
        rows=g.occupancy.shape[0],
        columns=g.occupancy.shape[1],
        occupancy=np.ascontiguousarray(g.occupancy).tobytes(),
        regions=np.ascontiguousarray(g.regions, dtype="<u2").tobytes(),
        region_ids=g.region_ids,
        revision=g.revision,
    )


def floor_grid_value(m: regions_pb2.GetFloorGridResponse) -> FloorGrid:
    shape = (m.rows, m.columns)
    if len(m.occupancy) != m.rows * m.columns or len(m.regions) != 2 * m.rows * m.columns:
        raise Corrupt(f"floor grid: {m.rows} x {m.columns} cells do not match the bytes that came with them")
    return FloorGrid(
        floor=m.floor,
        origin=(m.origin_x, m.origin_y),
        resolution=m.resolution,
        occupancy=np.frombuffer(m.occupancy, np.uint8).reshape(shape),
        regions=np.frombuffer(m.regions, "<u2").astype(np.uint16).reshape(shape),
        region_ids=tuple(m.region_ids),
        revision=m.revision,
    )


def encode_floor_grid(g: FloorGrid) -> bytes:
    return floor_grid_message(g).SerializeToString(deterministic=True)


def decode_floor_grid(data: bytes) -> FloorGrid:
    return floor_grid_value(parsed(regions_pb2.GetFloorGridResponse, data))


def _known(names: Mapping[K, int], number: int, what: str) -> K:
    for name, value in names.items():
        if value == number:
            return name
    raise Corrupt(f"{what}: kind {number} is none of {', '.join(str(name) for name in names)}")
