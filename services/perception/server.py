"""The gRPC face of perception: decodes, calls, encodes."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from typing import Any

import numpy as np

from ovip import codec
from ovip.errors import InvalidInput
from ovip.scene.types import F64
from ovip.v1 import perception_pb2 as pb
from ovip.v1 import perception_pb2_grpc, types_pb2
from services.perception.history import Upload
from services.perception.onboard import OnboardDetection, OnboardMask
from services.perception.service import Perception, Session

_Outbox = asyncio.Queue[pb.StreamFramesResponse | None]
_TAKEN_AT_ONCE = 4  # frames of one stream
_HELLO_FIRST = "stream: expected a hello first (scene, robot_id, session_id, intrinsics), then frames"


class PerceptionServicer(perception_pb2_grpc.PerceptionServiceServicer):
    """Translates between messages and `Perception`."""

    def __init__(self, perception: Perception) -> None:
        self._perception = perception

    async def StreamFrames(
        self, requests: AsyncIterator[pb.StreamFramesRequest], context: Any
    ) -> AsyncIterator[Any]:
        outbox: _Outbox = asyncio.Queue()
        reader = asyncio.create_task(self._read(requests, outbox))
        reader.add_done_callback(lambda _: outbox.put_nowait(None))
        try:
            while (reply := await outbox.get()) is not None:
                yield reply
            await reader
        finally:
            reader.cancel()
            await asyncio.gather(reader, return_exceptions=True)

    async def ListFrames(self, request: pb.ListFramesRequest, context: Any) -> pb.ListFramesResponse:
        frames, features = await self._perception.list_frames(
            request.scene, request.after_log_id, request.limit
        )
        return pb.ListFramesResponse(
            frames=[codec.frame_record_message(f) for f in frames],
            tag_features={word: codec.floats(feature) for word, feature in features.items()},
        )

    async def GetFrame(self, request: pb.GetFrameRequest, context: Any) -> pb.GetFrameResponse:
        stored, record = await self._perception.find_frame(request.scene, request.frame_id)
        reply = pb.GetFrameResponse(frame=codec.frame_record_message(record))
        if request.with_rgb:
            data = await self._perception.blob(stored.rgb_ref)
            kind = (
                types_pb2.Image.ENCODING_PNG if data.startswith(b"\x89PNG") else types_pb2.Image.ENCODING_JPEG
            )
            reply.rgb.CopyFrom(types_pb2.Image(encoding=kind, data=data))
        if request.with_depth:
            reply.depth.CopyFrom(
                types_pb2.DepthImage(
                    encoding=codec.DEPTH_ENCODING_NUMBERS[stored.depth_encoding],
                    data=await self._perception.blob(stored.depth_ref),
                    scale=stored.depth_scale,
                )
            )
        return reply

    async def Ground(self, request: pb.GroundRequest, context: Any) -> pb.GroundResponse:
        grounded, blind = await self._perception.ground(request.scene, request.frame_ids, request.words)
        return pb.GroundResponse(
            frames=[
                pb.GroundedFrame(
                    frame_id=frame_id, detections=[codec.detection_message(d) for d in detections]
                )
                for frame_id, detections in grounded.items()
            ],
            ungroundable_words=blind,
        )

    async def EmbedText(self, request: pb.EmbedTextRequest, context: Any) -> pb.EmbedTextResponse:
        features = await self._perception.embed_text(request.texts)
        return pb.EmbedTextResponse(
            features=[codec.floats(f) for f in features], feature_space=self._perception.feature_space
        )

    async def GetPerceptionStatus(self, request: pb.GetPerceptionStatusRequest, context: Any) -> Any:
        return codec.perception_status_message(await self._perception.status(request.scene))

    async def _read(self, requests: AsyncIterator[pb.StreamFramesRequest], outbox: _Outbox) -> None:
        """Reads the robot's side until it ends; replies go to the outbox."""
        announcer: asyncio.Task[None] | None = None
        try:
            session: Session | None = None
            async with _raising_alone(), asyncio.TaskGroup() as taking:
                taken: list[asyncio.Task[None]] = []
                async for request in requests:
                    kind = request.WhichOneof("message")
                    if session is None:
                        session, welcome = await self._greet(request)
                        since = await self._perception.newest_map_entry(session.scene)
                        outbox.put_nowait(welcome)
                        announcer = asyncio.create_task(self._announce_applied(session, since, outbox))
                    elif kind == "frame":
                        if len(taken) == _TAKEN_AT_ONCE:
                            await taken.pop(0)
                        before = taken[-1] if taken else None
                        taken.append(
                            taking.create_task(self._take_in(session, request.frame, outbox, before))
                        )
                    else:
                        raise InvalidInput(
                            f"stream: expected frames after the hello, got {kind or 'an empty message'}"
                        )
        finally:
            if announcer:
                announcer.cancel()
                await asyncio.gather(announcer, return_exceptions=True)

    async def _greet(self, request: pb.StreamFramesRequest) -> tuple[Session, pb.StreamFramesResponse]:
        if request.WhichOneof("message") != "hello":
            raise InvalidInput(_HELLO_FIRST)
        hello = request.hello
        session, last = await self._perception.open_session(
            hello.scene,
            hello.robot_id,
            hello.session_id,
            codec.intrinsics_value(hello.intrinsics),
            _source_value(hello),
        )
        welcome = pb.Welcome(
            last_durable_sequence=last,
            credits=await self._perception.credits(session.scene),
            feature_space=self._perception.feature_space,
        )
        return session, pb.StreamFramesResponse(welcome=welcome)

    async def _take_in(
        self,
        session: Session,
        frame: pb.FrameUpload,
        outbox: _Outbox,
        before: asyncio.Task[None] | None,
    ) -> None:
        """Checks and stores a frame beside others; it becomes durable after the one before it."""
        try:
            checked = await self._perception.check(session, _upload_value(frame), _onboard_value(frame))
            await self._acknowledge(session, outbox, pb.Ack.STATUS_RECEIVED, frame.sequence)
            durable = await self._perception.keep(session, checked, before)
        except InvalidInput as error:
            await self._acknowledge(
                session, outbox, pb.Ack.STATUS_REJECTED, frame.sequence, reason=str(error)
            )
            if before:
                await before  # whoever comes after this one comes after that one, too
            return
        await self._acknowledge(
            session,
            outbox,
            pb.Ack.STATUS_DURABLE,
            frame.sequence,
            frame_id=durable.frame_id,
            duplicate=durable.duplicate,
        )

    async def _announce_applied(self, session: Session, since: str, outbox: _Outbox) -> None:
        async for frame_id in self._perception.applied(session, since):
            sequence = int(frame_id.rpartition(".")[2])
            await self._acknowledge(session, outbox, pb.Ack.STATUS_APPLIED, sequence, frame_id=frame_id)

    async def _acknowledge(
        self, session: Session, outbox: _Outbox, status: pb.Ack.Status, sequence: int, **fields: Any
    ) -> None:
        credits = await self._perception.credits(session.scene)
        ack = pb.Ack(sequence=sequence, status=status, credits=credits, **fields)
        outbox.put_nowait(pb.StreamFramesResponse(ack=ack))


@contextlib.asynccontextmanager
async def _raising_alone() -> AsyncIterator[None]:
    """The first error of a group of tasks instead of the group."""
    try:
        yield
    except ExceptionGroup as group:
        raise group.exceptions[0] from None


def _source_value(hello: pb.Hello) -> F64:
    if not hello.world_from_source:
        return np.eye(4)
    return codec.matrix_value(hello.world_from_source, "world_from_source")


def _upload_value(frame: pb.FrameUpload) -> Upload:
    return Upload(
        sequence=frame.sequence,
        timestamp_ns=frame.timestamp_ns,
        world_from_camera=codec.pose_value(frame.pose),
        rgb=frame.rgb.data,
        depth=frame.depth.data,
        depth_encoding=codec.DEPTH_ENCODINGS.get(frame.depth.encoding, "unknown"),
        depth_scale=frame.depth.scale,
    )


def _onboard_value(frame: pb.FrameUpload) -> list[OnboardDetection] | None:
    if not frame.HasField("onboard"):
        return None
    return [
        OnboardDetection(
            label=d.label,
            score=d.score,
            box=codec.box2_value(d.box),
            mask=OnboardMask(d.mask.x, d.mask.y, d.mask.png) if d.HasField("mask") else None,
            feature=tuple(d.feature),
            second_feature=tuple(d.second_feature),
        )
        for d in frame.onboard.detections
    ]
