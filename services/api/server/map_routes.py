"""Scenes, objects, regions and the scene graph."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request

from ovip.answer_json import object_to_json
from ovip.jsonable import to_json
from services.api.domain.cursors import decode_cursor, encode_cursor
from services.api.domain.scene_json import graph_to_json, partition_to_json
from services.api.server import models
from services.api.server.etags import etag_of, not_modified, tagged
from services.api.server.parameters import Cursor, InFrame, KnownScene, Limit, Scene, Service
from services.api.service import FrameName

router = APIRouter(tags=["map"])


@router.get("/scenes", response_model=models.SceneList)
async def list_scenes(service: Service) -> Any:
    """All scenes, by name."""
    return {"scenes": to_json(await service.scenes())}


@router.get("/scenes/{scene}", response_model=models.SceneDetail)
async def get_scene(scene: Scene, service: Service) -> Any:
    """One scene at a glance: how much was seen, with which models, how it is turned."""
    detail = await service.detail(scene)
    perception = to_json(detail.perception)
    names = ("vocabulary", "backend", "feature_space", "world_from_source")
    counts = ("frames_durable", "frames_processed", "frames_skipped")
    return (
        to_json(detail.summary)
        | {name: perception[name] for name in (*counts, *names)}
        | {
            "regions_revision": detail.partition.revision,
            "regions": len(detail.partition.regions),
            "floors": len(detail.partition.floors),
        }
    )


@router.get(
    "/scenes/{scene}/objects", response_model=models.ObjectPage, responses={304: {"description": "unchanged"}}
)
async def list_objects(
    known: KnownScene,
    service: Service,
    request: Request,
    label: Annotated[
        str, Query(max_length=200, description="only objects of this label, in any number")
    ] = "",
    region: Annotated[str, Query(max_length=200, description="only objects of the region with this id")] = "",
    frame: InFrame = FrameName.WORLD,
    cursor: Cursor = None,
    limit: Limit = 200,
) -> Any:
    """Confirmed objects in the order of their ids, page by page. The ETag is the map version."""
    after = decode_cursor("objects", cursor)
    unchanged = not_modified(request, etag_of(known.map_version)) if not region else None
    if unchanged:
        return unchanged
    held = await service.objects_of_region(known.scene, region) if region else None
    shown, scene_map = await asyncio.gather(
        service.output_frame(known.scene, frame), service.scene_map(known.scene)
    )
    page = service.objects(scene_map, label, held, after, limit)
    body = {
        "map_version": scene_map.version,
        "frame": shown.name,
        "objects": [object_to_json(obj, shown.world_from_source) for obj in page.items],
        "next_cursor": encode_cursor("objects", page.end) if page.more else None,
    }
    return tagged(body, etag_of(scene_map.version)) if not region else body


@router.get("/scenes/{scene}/objects/{object_id}", response_model=models.ObjectReply)
async def get_object(scene: Scene, object_id: str, service: Service, frame: InFrame = FrameName.WORLD) -> Any:
    """One object. The id of an object merged into another gives that other one."""
    shown, obj = await asyncio.gather(service.output_frame(scene, frame), service.object(scene, object_id))
    return {"frame": shown.name, "object": object_to_json(obj, shown.world_from_source)}


@router.get(
    "/scenes/{scene}/regions", response_model=models.RegionList, responses={304: {"description": "unchanged"}}
)
async def list_regions(
    known: KnownScene, service: Service, request: Request, frame: InFrame = FrameName.WORLD
) -> Any:
    """The floors cut into regions. The ETag is the map version they were cut from, and their revision."""
    partition = await service.partition(known.scene)
    etag = etag_of(partition.map_version, partition.revision)
    unchanged = not_modified(request, etag)
    if unchanged:
        return unchanged
    return tagged(partition_to_json(partition, await service.output_frame(known.scene, frame)), etag)


@router.get(
    "/scenes/{scene}/graph", response_model=models.Graph, responses={304: {"description": "unchanged"}}
)
async def get_graph(
    known: KnownScene, service: Service, request: Request, frame: InFrame = FrameName.WORLD
) -> Any:
    """Floor -> region -> object. The ETag is the map version and the regions revision."""
    partition = await service.partition(known.scene)
    unchanged = not_modified(request, etag_of(known.map_version, partition.revision))
    if unchanged:
        return unchanged
    shown, scene_map = await asyncio.gather(
        service.output_frame(known.scene, frame), service.scene_map(known.scene)
    )
    return tagged(graph_to_json(scene_map, partition, shown), etag_of(scene_map.version, partition.revision))
