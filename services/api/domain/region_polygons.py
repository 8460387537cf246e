"""Regions as a GeoJSON feature collection (RFC 7946), but for its coordinates: those are metres, not degrees."""

from __future__ import annotations

from typing import Any

import numpy as np

from ovip.answer_json import number, numbers
from ovip.scene.types import F64, Bools, Partition, Region
from services.api.domain.palette import region_colors


def regions_geojson(scene: str, partition: Partition) -> dict[str, Any]:
    """One feature a region: a MultiPolygon of closed rings, x then y in the z-up world, outer ones counter-clockwise,
    holes clockwise."""
    colors = region_colors(partition.regions)
    heights = {floor.floor: floor.z for floor in partition.floors}
    return {
        "type": "FeatureCollection",
        "scene": scene,
        "map_version": partition.map_version,
        "regions_revision": partition.revision,
        "frame": "world",
        "unit": "metre",
        "floors": [{"floor": floor.floor, "z": number(floor.z)} for floor in partition.floors],
        "features": [
            _feature(region, heights.get(region.floor, 0.0), colors[region.region_id])
            for region in partition.regions
        ],
    }


def _feature(region: Region, z: float, color: str) -> dict[str, Any]:
    return {
        "type": "Feature",
        "id": region.region_id,
        "geometry": {"type": "MultiPolygon", "coordinates": _polygons(region)},
        "properties": {
            "id": region.region_id,
            "floor": region.floor,
            "z": number(z),
            "function": region.function,
            "display_name": region.display_name,
            "area": number(region.area),
            "object_ids": list(region.object_ids),
            "color": color,
        },
    }


def _polygons(region: Region) -> list[list[Any]]:
    """Each outline with the holes in it."""
    polygons = [[_ring(outline, 1.0)] for outline in region.outlines]
    for hole in region.holes:
        polygons[_holder(hole, region.outlines)].append(_ring(hole, -1.0))
    return polygons


def _holder(hole: F64, outlines: tuple[F64, ...]) -> int:
    """The smallest outline that most of a hole's corners lie in; where none does, the largest."""
    around = [i for i, outline in enumerate(outlines) if _inside(hole, outline).mean() > 0.5]
    sizes = [abs(_signed_area(outline)) for outline in outlines]
    return min(around, key=lambda i: sizes[i]) if around else int(np.argmax(sizes))


def _ring(ring: F64, turn: float) -> Any:
    """A closed ring; turn: 1 counter-clockwise, -1 clockwise."""
    turned = ring if turn * _signed_area(ring) > 0 else ring[::-1]
    return numbers(np.concatenate([turned, turned[:1]]))


def _signed_area(ring: F64) -> float:
    """Positive where an open ring `(N, 2)` runs counter-clockwise."""
    following = np.roll(ring, -1, axis=0)
    return float(0.5 * (ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]).sum())


def _inside(points: F64, ring: F64) -> Bools:
    """Whether each of `(N, 2)` points lies in a ring (even-odd rule)."""
    x, y = points[:, None, 0], points[:, None, 1]
    start, end = ring[None], np.roll(ring, -1, axis=0)[None]
    spans = (start[..., 1] > y) != (end[..., 1] > y)
    rise = np.where(spans, end[..., 1] - start[..., 1], 1.0)
    at = start[..., 0] + (y - start[..., 1]) / rise * (end[..., 0] - start[..., 0])
    odd: Bools = (spans & (x < at)).sum(axis=1) % 2 == 1
    return odd
