"""The client of perception."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ovip import codec
from ovip.clients.connection import READ_SECONDS, SLOW_SECONDS, read
from ovip.scene.answers import FrameRecord, PerceptionStatus
from ovip.scene.types import F32, Detection, Frame
from ovip.v1 import perception_pb2, perception_pb2_grpc
from ovip.wire import decode_depth, decode_rgb


class PerceptionClient:
    """Reads the frame history and grounds words in it."""

    def __init__(self, channel: Any) -> None:
        self._stub = perception_pb2_grpc.PerceptionServiceStub(channel)

    async def list_frames(
        self, scene: str, after: str = "", limit: int = 0
    ) -> tuple[list[FrameRecord], dict[str, F32]]:
        """Frames after a log id, and the text feature `(D,)` of every tag word among them."""
        request = perception_pb2.ListFramesRequest(scene=scene, after_log_id=after, limit=limit)
        reply = await read(lambda: self._stub.ListFrames(request, timeout=READ_SECONDS))
        features = {word: codec.floats_value(data) for word, data in reply.tag_features.items()}
        return [codec.frame_record_value(f) for f in reply.frames], features

    async def get_frame(self, scene: str, frame_id: str) -> Frame:
        """A frame with its images, decoded."""
        request = perception_pb2.GetFrameRequest(
            scene=scene, frame_id=frame_id, with_rgb=True, with_depth=True
        )
        reply = await read(lambda: self._stub.GetFrame(request, timeout=READ_SECONDS))
        record = codec.frame_record_value(reply.frame)
        return Frame(
            frame_id=record.frame_id,
            timestamp_ns=record.timestamp_ns,
            intrinsics=record.intrinsics,
            world_from_camera=record.world_from_camera,
            rgb=decode_rgb(reply.rgb.data, record.intrinsics),
            depth=decode_depth(
                reply.depth.data,
                codec.DEPTH_ENCODINGS[reply.depth.encoding],
                reply.depth.scale,
                record.intrinsics,
            ),
        )

    async def get_frame_record(self, scene: str, frame_id: str) -> FrameRecord:
        """A frame without its images."""
        request = perception_pb2.GetFrameRequest(scene=scene, frame_id=frame_id)
        reply = await read(lambda: self._stub.GetFrame(request, timeout=READ_SECONDS))
        return codec.frame_record_value(reply.frame)

    async def get_rgb(self, scene: str, frame_id: str) -> bytes:
        """A frame's colour image as the robot sent it (JPEG or PNG bytes)."""
        request = perception_pb2.GetFrameRequest(scene=scene, frame_id=frame_id, with_rgb=True)
        reply = await read(lambda: self._stub.GetFrame(request, timeout=READ_SECONDS))
        return bytes(reply.rgb.data)

    async def ground(
        self, scene: str, frame_ids: Sequence[str], words: Sequence[str]
    ) -> tuple[dict[str, tuple[Detection, ...]], tuple[str, ...]]:
        """Detections of `words` by frame, past the vocabulary gate, and the words the grounder cannot see."""
        request = perception_pb2.GroundRequest(scene=scene, frame_ids=frame_ids, words=words)
        reply = await read(lambda: self._stub.Ground(request, timeout=SLOW_SECONDS))
        grounded = {f.frame_id: tuple(codec.detection_value(d) for d in f.detections) for f in reply.frames}
        return grounded, tuple(reply.ungroundable_words)

    async def embed_text(self, texts: Sequence[str]) -> F32:
        """Unit text features `(N, D)` in the space of the object features."""
        request = perception_pb2.EmbedTextRequest(texts=texts)
        reply = await read(lambda: self._stub.EmbedText(request, timeout=READ_SECONDS))
        return np.stack([codec.floats_value(data) for data in reply.features])

    async def status(self, scene: str) -> PerceptionStatus:
        request = perception_pb2.GetPerceptionStatusRequest(scene=scene)
        reply = await read(lambda: self._stub.GetPerceptionStatus(request, timeout=READ_SECONDS))
        return codec.perception_status_value(reply)
