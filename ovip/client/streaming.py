"""Streaming frames to perception: with credits, no loss over reconnects, the newest kept where a robot cannot wait."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Literal

import grpc
import numpy as np

from ovip import codec
from ovip.clients import MAX_MESSAGE_BYTES, error_of
from ovip.errors import InvalidInput, TooLarge, Unavailable
from ovip.scene.types import F64, Box2, Intrinsics
from ovip.v1 import perception_pb2, perception_pb2_grpc, types_pb2

PATIENCE_SECONDS = 60.0
_STATUS = {number: name.removeprefix("STATUS_").lower() for name, number in perception_pb2.Ack.Status.items()}


@dataclass(frozen=True, slots=True)
class Hello:
    """Who streams into which scene. world_from_source: `(4, 4)`, what was done to make the poses z-up."""

    scene: str
    robot_id: str
    session_id: str
    intrinsics: Intrinsics
    world_from_source: F64 = field(default_factory=lambda: np.eye(4))


@dataclass(frozen=True, slots=True)
class OutgoingDetection:
    """A thing that the robot saw itself. mask_png: mask of the pixels from `(mask_x, mask_y)` on; feature: `(D,)`.

    second_feature: `(E,)` of a second encoder (DINO family), which may only veto merges.
    """

    label: str
    score: float
    box: Box2
    mask_png: bytes = b""
    mask_x: int = 0
    mask_y: int = 0
    feature: tuple[float, ...] = ()
    second_feature: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class OutgoingFrame:
    """A frame to send, images encoded (colour JPEG or PNG; depth PNG16 or `ovip.wire.encode_depth`).

    sequence: from 1, growing. detections: None lets the service detect.
    """

    sequence: int
    timestamp_ns: int
    world_from_camera: F64
    rgb: bytes
    depth: bytes
    depth_scale: float
    depth_encoding: Literal["png16", "shuffle_zstd"] = "png16"
    detections: tuple[OutgoingDetection, ...] | None = None


@dataclass(frozen=True, slots=True)
class StreamEvent:
    """What became of a frame: received, durable, applied or rejected."""

    sequence: int
    status: str
    reason: str
    frame_id: str
    duplicate: bool


@dataclass(slots=True)
class StreamReport:
    """What became of a stream. resumed_after: the last durable sequence that the service knew at the start."""

    resumed_after: int = 0
    sent: int = 0
    durable: int = 0
    dropped: int = 0
    reconnects: int = 0
    rejected: list[StreamEvent] = field(default_factory=list)
    last_frame_id: str = ""


class FrameStream:
    """One session of a robot. What is not yet durable is kept and sent again after a lost connection.

    keep "all": waits for credits (recordings). keep "newest": a frame that finds no credit waits only until a
    newer one comes (live robots).
    """

    def __init__(
        self,
        channel: Any,
        hello: Hello,
        keep: Literal["all", "newest"] = "all",
        on_event: Callable[[StreamEvent], None] | None = None,
        patience_s: float = PATIENCE_SECONDS,
    ) -> None:
        self._stub = perception_pb2_grpc.PerceptionServiceStub(channel)
        self._hello = _hello_message(hello)
        self._keep = keep
        self._on_event = on_event or (lambda _event: None)
        self._patience_s = patience_s
        self._waiting: OrderedDict[int, perception_pb2.StreamFramesRequest] = OrderedDict()
        self._in_flight: set[int] = set()
        self._credits = 1
        self._changed = asyncio.Event()
        self._ended = False
        self.report = StreamReport()

    async def send(
        self, frames: AsyncIterator[OutgoingFrame] | Iterable[OutgoingFrame], resume: bool = True
    ) -> StreamReport:
        """Sends all frames and returns when each is durable or rejected.

        resume: frames at or below the last durable sequence are passed over (a recording played again). Raises
        Unavailable where the service stays away for `patience_s`, InvalidInput where the hello is refused.
        """
        last = await self._last_durable()
        self.report.resumed_after = last
        feeder = asyncio.create_task(self._feed(frames, last if resume else 0))
        try:
            await self._until_done(feeder)
            await feeder  # its error, if the last of the frames could not be read
        finally:
            feeder.cancel()
            await asyncio.gather(feeder, return_exceptions=True)
        return self.report

    async def _last_durable(self) -> int:
        deadline = time.monotonic() + self._patience_s
        while True:
            call = self._stub.StreamFrames()
            try:
                last, _ = await self._greet(call)
                return last
            except grpc.aio.AioRpcError as error:
                await _pause_or_raise(error, deadline)
            finally:
                call.cancel()

    async def _until_done(self, feeder: asyncio.Task[None]) -> None:
        deadline = time.monotonic() + self._patience_s
        while not self._done:
            call = self._stub.StreamFrames()
            try:
                last, self._credits = await self._greet(call)
                self._begin_again(last)
                deadline = time.monotonic() + self._patience_s
                reader = asyncio.create_task(self._read(call))
                try:
                    await self._write(call, reader, feeder)
                    await call.done_writing()
                    if feeder.done():
                        feeder.result()
                finally:
                    reader.cancel()
                    await asyncio.gather(reader, return_exceptions=True)
            except (grpc.aio.AioRpcError, asyncio.InvalidStateError) as error:
                self.report.reconnects += 1
                await _pause_or_raise(_final_error(call, error), deadline)
            finally:
                call.cancel()

    @property
    def _done(self) -> bool:
        return self._ended and not self._waiting

    async def _greet(self, call: Any) -> tuple[int, int]:
        with contextlib.suppress(asyncio.InvalidStateError):  # it ended already: its status says why
            await call.write(perception_pb2.StreamFramesRequest(hello=self._hello))
        reply = await call.read()
        if reply is grpc.aio.EOF:
            raise await _status_of(call)
        return reply.welcome.last_durable_sequence, reply.welcome.credits

    def _begin_again(self, last_durable: int) -> None:
        for sequence in [s for s in self._waiting if s <= last_durable and s in self._in_flight]:
            del self._waiting[sequence]
            self.report.durable += 1
        self._in_flight.clear()
        self._changed.set()

    async def _feed(self, frames: AsyncIterator[OutgoingFrame] | Iterable[OutgoingFrame], after: int) -> None:
        try:
            async for frame in _each(frames):
                if frame.sequence <= after:
                    continue
                while self._keep == "all" and len(self._waiting) >= 2 * max(self._credits, 1):
                    await self._change()
                if self._keep == "newest":
                    self._drop_unsent()
                self._waiting[frame.sequence] = _frame_message(frame)
                self._changed.set()
        finally:
            self._ended = True
            self._changed.set()

    def _drop_unsent(self) -> None:
        for sequence in [s for s in self._waiting if s not in self._in_flight]:
            del self._waiting[sequence]
            self.report.dropped += 1

    async def _write(self, call: Any, reader: asyncio.Task[None], feeder: asyncio.Task[None]) -> None:
        while not self._done:
            if feeder.done() and feeder.exception():
                feeder.result()
            if reader.done():
                reader.result()
                raise await _status_of(call)
            unsent = [s for s in self._waiting if s not in self._in_flight]
            if unsent and len(self._in_flight) < self._credits:
                sequence = unsent[0]
                self._in_flight.add(sequence)
                self.report.sent += 1
                await call.write(self._waiting[sequence])
            else:
                await self._change()

    async def _read(self, call: Any) -> None:
        try:
            while (reply := await call.read()) is not grpc.aio.EOF:
                self._note(reply.ack)
        finally:
            self._changed.set()

    def _note(self, ack: perception_pb2.Ack) -> None:
        event = StreamEvent(ack.sequence, _STATUS[ack.status], ack.reason, ack.frame_id, ack.duplicate)
        self._credits = ack.credits
        if event.status in {"durable", "rejected"} and self._waiting.pop(event.sequence, None) is not None:
            self._in_flight.discard(event.sequence)
            if event.status == "durable":
                self.report.durable += 1
                self.report.last_frame_id = event.frame_id
            else:
                self.report.rejected.append(event)
        self._changed.set()
        self._on_event(event)

    async def _change(self) -> None:
        self._changed.clear()
        # not wait_for, which on Python 3.11 can lose a cancellation
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(0.5):
                await self._changed.wait()


async def _each(
    frames: AsyncIterator[OutgoingFrame] | Iterable[OutgoingFrame],
) -> AsyncIterator[OutgoingFrame]:
    if isinstance(frames, AsyncIterator):
        async for frame in frames:
            yield frame
        return
    iterator = iter(frames)
    while (frame_or_end := await asyncio.to_thread(next, iterator, None)) is not None:
        yield frame_or_end


async def _status_of(call: Any) -> grpc.aio.AioRpcError:
    code, details, trailing = await call.code(), await call.details(), await call.trailing_metadata()
    if code is grpc.StatusCode.OK:
        code, details = grpc.StatusCode.UNAVAILABLE, "the service ended the stream"
    return grpc.aio.AioRpcError(code, grpc.aio.Metadata(), trailing or grpc.aio.Metadata(), details)


def _final_error(_call: Any, error: Exception) -> grpc.aio.AioRpcError:
    if isinstance(error, grpc.aio.AioRpcError):
        return error
    return grpc.aio.AioRpcError(
        grpc.StatusCode.UNAVAILABLE, grpc.aio.Metadata(), grpc.aio.Metadata(), f"the stream broke: {error}"
    )


async def _pause_or_raise(error: grpc.aio.AioRpcError, deadline: float) -> None:
    known = error_of(error)
    lost = isinstance(known, Unavailable) or error.code() in {
        grpc.StatusCode.CANCELLED,
        grpc.StatusCode.UNKNOWN,
    }
    # a connection cut in the middle of a write; the service's own INTERNAL has other words
    lost |= error.code() is grpc.StatusCode.INTERNAL and error.details() == "Internal error from Core"
    if not lost or time.monotonic() > deadline:
        raise known from error
    await asyncio.sleep(0.3)


def _hello_message(hello: Hello) -> perception_pb2.Hello:
    return perception_pb2.Hello(
        scene=hello.scene,
        robot_id=hello.robot_id,
        session_id=hello.session_id,
        intrinsics=codec.intrinsics_message(hello.intrinsics),
        world_from_source=np.asarray(hello.world_from_source, np.float64).ravel().tolist(),
    )


def _frame_message(frame: OutgoingFrame) -> perception_pb2.StreamFramesRequest:
    if frame.depth_encoding not in codec.DEPTH_ENCODING_NUMBERS:
        raise InvalidInput(f"depth encoding: expected png16 or shuffle_zstd, got {frame.depth_encoding!r}")
    png = frame.rgb.startswith(b"\x89PNG")
    message = perception_pb2.StreamFramesRequest(
        frame=perception_pb2.FrameUpload(
            sequence=frame.sequence,
            timestamp_ns=frame.timestamp_ns,
            pose=codec.pose_message(frame.world_from_camera),
            rgb=types_pb2.Image(
                encoding=types_pb2.Image.ENCODING_PNG if png else types_pb2.Image.ENCODING_JPEG,
                data=frame.rgb,
            ),
            depth=types_pb2.DepthImage(
                encoding=codec.DEPTH_ENCODING_NUMBERS[frame.depth_encoding],
                data=frame.depth,
                scale=frame.depth_scale,
            ),
        )
    )
    if frame.detections is not None:
        message.frame.onboard.SetInParent()
        message.frame.onboard.detections.extend(_detection_message(d) for d in frame.detections)
    if message.ByteSize() > MAX_MESSAGE_BYTES:
        raise TooLarge(
            f"frame {frame.sequence}: expected at most {MAX_MESSAGE_BYTES // 2**20} MB a frame, "
            f"got {message.ByteSize() / 2**20:.1f} MB"
        )
    return message


def _detection_message(d: OutgoingDetection) -> types_pb2.Detection2D:
    message = types_pb2.Detection2D(
        label=d.label,
        score=d.score,
        box=codec.box2_message(d.box),
        feature=d.feature,
        second_feature=d.second_feature,
    )
    if d.mask_png:
        message.mask.x, message.mask.y, message.mask.png = d.mask_x, d.mask_y, d.mask_png
    return message
