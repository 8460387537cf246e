"""The map as files and pictures: point clouds, PLY, the scene graph, regions, robots' maps, floor plans."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import StreamingResponse

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN
from ovip.scene.types import SceneMap
from services.api.domain.floorplan import PlanParams
from services.api.domain.grid_pictures import GREY_OF, occupancy_png, regions_png
from services.api.domain.nav2 import nav2_zip
from services.api.domain.ply import PlyFormat, write_ply
from services.api.domain.region_polygons import regions_geojson
from services.api.domain.scene_json import scene_graph_to_json
from services.api.server import models
from services.api.server.etags import etag_of, not_modified, tagged, tagged_file
from services.api.server.parameters import FloorNumber, InFrame, KnownScene, OneFloor, Responses, Service
from services.api.service import FrameName

router = APIRouter(tags=["exports"])
_MAX_POINTS = 1_000_000  # what one gRPC message of 16 MB holds
UNCHANGED: Responses = {304: {"description": "unchanged"}}
_ZIP: Responses = {200: {"content": {"application/zip": {}}, "description": "the archive"}}
_PNG: Responses = {200: {"content": {"image/png": {}}, "description": "the picture"}}
_BYTES: Responses = {200: {"content": {"application/octet-stream": {}}, "description": "the file"}}
_MEANINGS = {"unknown": UNKNOWN, "free": FREE, "occupied": OCCUPIED}


@router.get("/scenes/{scene}/points", response_class=Response, responses=_BYTES)
async def get_points(
    known: KnownScene,
    service: Service,
    object_id: Annotated[list[str] | None, Query(description="only these objects; none: all")] = None,
    max_points: Annotated[
        int, Query(ge=1, le=_MAX_POINTS, description="evenly thinned to at most this many")
    ] = 200_000,
    frame: InFrame = FrameName.WORLD,
) -> Response:
    """The objects' points for drawing, little-endian.

    24 bytes of header: "OVPC", uint32 format 1, uint64 map version, uint32 N, uint32 J. Then N x 3 float32
    (metres), N uint32 (index of the object), N x 3 uint8 (RGB), J bytes of JSON (the object ids).
    """
    shown = await service.output_frame(known.scene, frame)
    packed = await service.packed_points(known, object_id or (), max_points, shown)
    return Response(
        packed, media_type="application/octet-stream", headers={"Cache-Control": "private, no-cache"}
    )


@router.get("/scenes/{scene}/exports/ply", response_class=StreamingResponse, responses=_BYTES)
async def export_ply(
    known: KnownScene,
    service: Service,
    form: Annotated[PlyFormat, Query(alias="format")] = PlyFormat.BINARY,
    frame: InFrame = FrameName.WORLD,
) -> StreamingResponse:
    """All points of all objects as PLY: x y z red green blue object_id; comments name the objects."""
    shown, scene_map = await asyncio.gather(
        service.output_frame(known.scene, frame), service.scene_map(known.scene)
    )
    objects = await service.ply_objects(scene_map, shown)
    comments = [f"scene {known.scene} map version {scene_map.version}", f"frame {shown.name}, metres"]
    return StreamingResponse(
        write_ply(objects, form, comments),
        media_type="application/octet-stream",
        headers=_download(scene_map, "ply"),
    )


@router.get("/scenes/{scene}/exports/scene-graph.json", response_model=models.SceneGraph)
async def export_scene_graph(
    known: KnownScene, service: Service, response: Response, frame: InFrame = FrameName.WORLD
) -> Any:
    """Floors, regions, the openings between them and the objects, in one file."""
    shown, scene_map, partition = await asyncio.gather(
        service.output_frame(known.scene, frame),
        service.scene_map(known.scene),
        service.partition(known.scene),
    )
    response.headers.update(_download(scene_map, "json"))
    return scene_graph_to_json(scene_map, partition, shown)


@router.get("/scenes/{scene}/exports/regions.json", response_model=models.RegionPolygons, responses=UNCHANGED)
async def export_regions(known: KnownScene, service: Service, request: Request) -> Any:
    """The regions' polygons, holes and all, laid out as GeoJSON; its coordinates are metres in the z-up world."""
    cut = await service.cut_floors(known.scene)
    etag = etag_of(cut.partition.map_version, cut.partition.revision)
    return not_modified(request, etag) or tagged(regions_geojson(known.scene, cut.partition), etag)


@router.get("/scenes/{scene}/exports/nav2", response_class=Response, responses=_ZIP | UNCHANGED)
async def export_nav2(
    known: KnownScene, service: Service, request: Request, floor: OneFloor = None
) -> Response:
    """Maps for ROS 2 nav2's map server in a zip: floor-N.pgm and floor-N.yaml for each floor."""
    cut = await service.cut_floors(known.scene, floor)
    etag = etag_of(cut.partition.map_version, cut.partition.revision)
    return not_modified(request, etag) or tagged_file(
        nav2_zip(cut.grids), "application/zip", etag, f"{known.scene}-r{cut.partition.revision}-nav2.zip"
    )


@router.get("/scenes/{scene}/floorplan.png", response_class=Response, responses=_PNG | UNCHANGED)
async def draw_plan(
    known: KnownScene,
    service: Service,
    request: Request,
    floor: OneFloor = None,
    scale: Annotated[
        float | None,
        Query(ge=5, le=400, description="pixels a metre; none: 80, or what keeps a floor below 2800 pixels"),
    ] = None,
) -> Response:
    """A floor, or all side by side, as a picture, larger y up: regions with names and areas, walls, doorways with their
    widths, stairs, what is unexplored, objects."""
    etag = etag_of(known.map_version, (await service.partition(known.scene)).revision)
    return not_modified(request, etag) or tagged_file(
        await service.floorplan(known.scene, floor, PlanParams(pixels_per_metre=scale)), "image/png", etag
    )


@router.get("/scenes/{scene}/grid/{floor}", response_model=models.Grid, responses=UNCHANGED)
async def get_grid(known: KnownScene, floor: FloorNumber, service: Service, request: Request) -> Any:
    """What the cells of a floor are, and where its images lie."""
    grid = await service.floor_grid(known.scene, floor)
    here = f"/v1/scenes/{known.scene}/grid/{floor}"
    etag = etag_of(grid.revision)
    body = {
        "floor": grid.floor,
        "origin": list(grid.origin),
        "resolution": grid.resolution,
        "rows": grid.occupancy.shape[0],
        "columns": grid.occupancy.shape[1],
        "revision": grid.revision,
        "region_ids": list(grid.region_ids),
        "occupancy_png": f"{here}/occupancy.png",
        "occupancy_values": {name: GREY_OF[cell] for name, cell in _MEANINGS.items()},
        "regions_png": f"{here}/regions.png",
    }
    return not_modified(request, etag) or tagged(body, etag)


@router.get("/scenes/{scene}/grid/{floor}/occupancy.png", response_class=Response, responses=_PNG | UNCHANGED)
async def get_occupancy(
    known: KnownScene, floor: FloorNumber, service: Service, request: Request
) -> Response:
    """Unknown, free and occupied cells as grey values; the first image row is row 0, the smallest y."""
    grid = await service.floor_grid(known.scene, floor)
    etag = etag_of(grid.revision)
    return not_modified(request, etag) or tagged_file(occupancy_png(grid), "image/png", etag)


@router.get("/scenes/{scene}/grid/{floor}/regions.png", response_class=Response, responses=_PNG | UNCHANGED)
async def get_region_labels(
    known: KnownScene, floor: FloorNumber, service: Service, request: Request
) -> Response:
    """Region labels of the cells as 16-bit grey; the first image row is row 0, the smallest y."""
    grid = await service.floor_grid(known.scene, floor)
    etag = etag_of(grid.revision)
    return not_modified(request, etag) or tagged_file(regions_png(grid), "image/png", etag)


def _download(scene_map: SceneMap, suffix: str) -> dict[str, str]:
    name = f"{scene_map.scene}-v{scene_map.version}.{suffix}"
    return {"Content-Disposition": f'attachment; filename="{name}"'}
