"""The frame history and its images."""

from __future__ import annotations

import asyncio
from typing import Any

from fastapi import APIRouter, Response

from services.api.domain.cursors import decode_cursor, encode_cursor
from services.api.domain.scene_json import frame_to_json
from services.api.server import models
from services.api.server.parameters import Cursor, FrameId, InFrame, KnownScene, Limit, Scene, Service
from services.api.service import FrameName

router = APIRouter(tags=["frames"])
_JPEG_START = b"\xff\xd8"


@router.get("/scenes/{scene}/frames", response_model=models.FramePage)
async def list_frames(
    known: KnownScene,
    service: Service,
    frame: InFrame = FrameName.WORLD,
    cursor: Cursor = None,
    limit: Limit = 200,
) -> Any:
    """Frames in order of arrival, page by page."""
    after = decode_cursor("frames", cursor)
    shown, page, region_of = await asyncio.gather(
        service.output_frame(known.scene, frame),
        service.frames(known.scene, after, limit),
        service.regions_of_frames(known.scene),
    )
    end = encode_cursor("frames", page.end) if page.end else None
    return {
        "frame": shown.name,
        "frames": [frame_to_json(record, shown, region_of.get(record.frame_id)) for record in page.items],
        "next_cursor": end if page.more else None,
        "end_cursor": end,
    }


@router.get(
    "/scenes/{scene}/frames/{frame_id}/rgb",
    response_class=Response,
    responses={
        200: {"content": {"image/jpeg": {}, "image/png": {}}, "description": "the image as it was sent"}
    },
)
async def get_frame_image(scene: Scene, frame_id: FrameId, service: Service) -> Response:
    """A frame's colour image, as the robot sent it."""
    image = await service.frame_image(scene, frame_id)
    media_type = "image/jpeg" if image.startswith(_JPEG_START) else "image/png"
    return Response(image, media_type=media_type, headers={"Cache-Control": "private, max-age=3600"})
