"""Partitions of the floors, and their navigation grids."""

from __future__ import annotations

import numpy as np

from ovip.codec.geometry import polygon_message, polygon_value, vector_message, vector_value
from ovip.codec.reading import parsed
from ovip.errors import Corrupt
from ovip.scene.grid import FloorGrid
from ovip.scene.types import Floor, Partition, Region, RegionEdge
from ovip.v1 import regions_pb2


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
            )
            for r in p.regions
        ],
        edges=[
            regions_pb2.RegionEdge(a=e.a, b=e.b, width=e.width, position=vector_message(e.position))
            for e in p.edges
        ],
        fallbacks=p.fallbacks,
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
            )
            for r in m.regions
        ),
        edges=tuple(RegionEdge(e.a, e.b, e.width, vector_value(e.position)) for e in m.edges),
        fallbacks=tuple(m.fallbacks),
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
