"""Floors, regions, frames and the scene graph as JSON values, in the world or the recording's frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from ovip.answer_json import OutputFrame, number, numbers, object_to_json
from ovip.jsonable import to_json
from ovip.scene.answers import FrameRecord
from ovip.scene.types import F64, Floor, Frontier, Partition, Region, RegionEdge, SceneMap
from services.api.domain.palette import region_colors


def partition_to_json(partition: Partition, frame: OutputFrame) -> dict[str, Any]:
    """The regions of a scene, flat, with the floors they lie on and the openings between them."""
    colors = region_colors(partition.regions)
    heights = {floor.floor: floor.z for floor in partition.floors}
    return {
        "map_version": partition.map_version,
        "regions_revision": partition.revision,
        "frame": frame.name,
        "floors": [_floor(floor) for floor in partition.floors],
        "regions": [
            _region(region, colors[region.region_id], heights.get(region.floor, 0.0), frame)
            for region in partition.regions
        ],
        "edges": [_edge(edge, frame) for edge in partition.edges],
        "frontiers": [_frontier(frontier, frame) for frontier in partition.frontiers],
        "events": to_json(partition.events),
        "fallbacks": list(partition.fallbacks),
    }


def graph_to_json(scene_map: SceneMap, partition: Partition, frame: OutputFrame) -> dict[str, Any]:
    """Floor -> region -> object, nested; objects of no region stand in `unplaced`."""
    flat = partition_to_json(partition, frame)
    objects = {obj.object_id: obj for obj in scene_map.objects}
    placed = {object_id for region in partition.regions for object_id in region.object_ids}

    def short(object_id: str) -> dict[str, Any]:
        full = object_to_json(objects[object_id], frame.world_from_source)
        return {name: full[name] for name in ("id", "label", "position", "box")}

    def with_objects(region: dict[str, Any]) -> dict[str, Any]:
        held = [short(object_id) for object_id in region["object_ids"] if object_id in objects]
        return {name: value for name, value in region.items() if name != "object_ids"} | {"objects": held}

    return {
        "map_version": scene_map.version,
        "regions_revision": partition.revision,
        "frame": frame.name,
        "floors": [
            floor
            | {
                "regions": [
                    with_objects(region) for region in flat["regions"] if region["floor"] == floor["floor"]
                ]
            }
            for floor in flat["floors"]
        ],
        "edges": flat["edges"],
        "frontiers": flat["frontiers"],
        "events": flat["events"],
        "unplaced": [short(object_id) for object_id in objects if object_id not in placed],
        "fallbacks": flat["fallbacks"],
    }


def scene_graph_to_json(scene_map: SceneMap, partition: Partition, frame: OutputFrame) -> dict[str, Any]:
    """The whole scene in one file, flat: floors, regions, edges, objects with the region that holds each."""
    holder = {object_id: region for region in partition.regions for object_id in region.object_ids}

    def placed(object_json: dict[str, Any]) -> dict[str, Any]:
        region = holder.get(object_json["id"])
        return object_json | {
            "region_id": region.region_id if region else None,
            "floor": region.floor if region else None,
        }

    return {
        "format": "ovip-scene-graph",
        "format_version": 1,
        "scene": scene_map.scene,
        "state_hash": scene_map.state_hash,
        **partition_to_json(partition, frame),
        "map_version": scene_map.version,
        "regions_map_version": partition.map_version,
        "objects": [placed(object_to_json(obj, frame.world_from_source)) for obj in scene_map.objects],
    }


def frame_to_json(record: FrameRecord, frame: OutputFrame, region_id: str | None) -> dict[str, Any]:
    """A frame of the history: when, from where, with which camera, and the words seen in it."""
    pose = frame.pose(record.world_from_camera)
    camera = record.intrinsics
    return {
        "frame_id": record.frame_id,
        "timestamp_ns": record.timestamp_ns,
        "position": numbers(pose[:3, 3]),
        "region_id": region_id,
        "pose": np.asarray(pose, dtype=np.float64).tolist(),
        "intrinsics": {
            "fx": camera.fx,
            "fy": camera.fy,
            "cx": camera.cx,
            "cy": camera.cy,
            "width": camera.width,
            "height": camera.height,
        },
        "tags": list(record.tags),
        "processed": record.processed,
    }


def _floor(floor: Floor) -> dict[str, Any]:
    return {
        "floor": floor.floor,
        "z": number(floor.z),
        "ceiling_z": None if floor.ceiling_z is None else number(floor.ceiling_z),
        "area": number(floor.area),
    }


def _region(region: Region, color: str, floor_z: float, frame: OutputFrame) -> dict[str, Any]:
    return {
        "region_id": region.region_id,
        "floor": region.floor,
        "function": region.function,
        "display_name": region.display_name,
        "area": number(region.area),
        "centroid": numbers(frame.points(region.centroid)[0]),
        "outlines": [_ring(ring, floor_z, frame) for ring in region.outlines],
        "holes": [_ring(ring, floor_z, frame) for ring in region.holes],
        "object_ids": list(region.object_ids),
        "frames": len(region.frame_ids),
        "seen_by": list(region.seen_by),
        "color": color,
    }


def _ring(ring: F64, floor_z: float, frame: OutputFrame) -> Any:
    """`[x, y]` points in the world; `[x, y, z]` on the floor in the source frame, which may not be level."""
    if frame.world_from_source is None:
        return numbers(ring)
    return numbers(frame.points(np.column_stack([ring, np.full(len(ring), floor_z)])))


def _edge(edge: RegionEdge, frame: OutputFrame) -> dict[str, Any]:
    return {
        "a": edge.a,
        "b": edge.b,
        "kind": edge.kind.value,
        "width": number(edge.width),
        "position": numbers(frame.points(edge.position)[0]),
        "upper": None if edge.upper is None else numbers(frame.points(edge.upper)[0]),
    }


def _frontier(frontier: Frontier, frame: OutputFrame) -> dict[str, Any]:
    return {
        "floor": frontier.floor,
        "region_id": frontier.region_id or None,
        "position": numbers(frame.points(frontier.position)[0]),
        "width": number(frontier.width),
    }
