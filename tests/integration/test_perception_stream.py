"""Robots streaming frames over real gRPC into a real store: what is said to them, what survives, what is refused."""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from typing import Any

import grpc
import numpy as np
import pytest

from ovip import codec
from ovip.client import Hello, OutgoingFrame
from ovip.client.streaming import FrameStream, OutgoingDetection, StreamEvent, StreamReport
from ovip.clients import MapperClient, PerceptionClient, connect, error_of
from ovip.codec import decode_detection_batch
from ovip.errors import InvalidInput, NotAuthorized, NotFound, TooLarge, Unavailable
from ovip.scene.answers import PerceptionStatus
from ovip.scene.types import Box2, DetectionBatch, Intrinsics
from ovip.store import Store
from ovip.v1 import perception_pb2 as pb
from ovip.v1 import perception_pb2_grpc, types_pb2
from services.mapper.__main__ import serve as serve_mapper
from services.mapper.config import Settings as MapperSettings
from services.perception import __main__ as perception
from services.perception.config import Settings
from tests.builders import colour_noise, depth_units, hello, jpeg, outgoing, png, pose
from tests.unit.services.perception.painted import K, PaintedModels, painted

SCENE = "kitchen"
SETTINGS = Settings(_env_file=None, perception_port=0, api_key=None, enumerator="detector")
HELLO = hello(SCENE, k=K)
ACK = pb.Ack.Status.Name


@pytest.fixture(autouse=True)
def models(monkeypatch: pytest.MonkeyPatch) -> PaintedModels:
    """The painted world's models behind the seams; everything else is as it runs."""
    made = PaintedModels()
    monkeypatch.setattr(perception, "open_models", lambda settings, vlm: made.as_models())
    monkeypatch.setattr("ovip.stages._LOOK_FOR_SCENES_SECONDS", 0.05)
    return made


@contextlib.asynccontextmanager
async def perception_on(store: Store, **changes: Any) -> AsyncIterator[int]:
    """Perception, serving and processing; yields its port."""
    async with perception.serve(SETTINGS.model_copy(update=changes), store) as port:
        yield port


@contextlib.asynccontextmanager
async def channel_to(port: int, key: str | None = None) -> AsyncIterator[Any]:
    channel = connect(f"127.0.0.1:{port}", key)
    try:
        yield channel
    finally:
        await channel.close()


async def send(
    port: int,
    frames: Iterable[OutgoingFrame],
    say: Hello = HELLO,
    key: str | None = None,
    on_event: Callable[[StreamEvent], None] | None = None,
    resume: bool = True,
    patience_s: float = 10.0,
) -> StreamReport:
    """Streams frames as a robot with our client does."""
    async with channel_to(port, key) as channel:
        return await FrameStream(channel, say, on_event=on_event, patience_s=patience_s).send(frames, resume)


async def processed(port: int, scene: str = SCENE) -> PerceptionStatus:
    """Where perception stands once it has done every frame."""
    async with channel_to(port) as channel, asyncio.timeout(20):
        while True:
            status = await PerceptionClient(channel).status(scene)
            if status.frames_processed + status.frames_skipped == status.frames_durable:
                return status
            await asyncio.sleep(0.05)


async def detections_in(store: Store, scene: str = SCENE) -> list[DetectionBatch]:
    entries = await store.read(scene, "detections", count=1000)
    return [decode_detection_batch(await store.blobs.get(e.fields["batch"].decode())) for e in entries]


class Raw:
    """The robot's side of a stream, message by message."""

    def __init__(self, call: Any) -> None:
        self.call = call

    async def say(self, **message: Any) -> None:
        await self.call.write(pb.StreamFramesRequest(**message))

    async def hello(self, say: Hello = HELLO) -> pb.Welcome:
        await self.say(
            hello=pb.Hello(
                scene=say.scene,
                robot_id=say.robot_id,
                session_id=say.session_id,
                intrinsics=codec.intrinsics_message(say.intrinsics),
                world_from_source=np.asarray(say.world_from_source).ravel().tolist(),
            )
        )
        reply = await self.read()
        assert reply.WhichOneof("message") == "welcome"
        return reply.welcome

    async def frame(self, frame: OutgoingFrame, **changes: Any) -> None:
        upload = pb.FrameUpload(
            sequence=frame.sequence,
            timestamp_ns=frame.timestamp_ns,
            pose=codec.pose_message(frame.world_from_camera),
            rgb=types_pb2.Image(encoding=types_pb2.Image.ENCODING_PNG, data=frame.rgb),
            depth=types_pb2.DepthImage(
                encoding=types_pb2.DepthImage.ENCODING_PNG16, data=frame.depth, scale=frame.depth_scale
            ),
        )
        for name, value in changes.items():
            getattr(upload, name).CopyFrom(value)
        await self.say(frame=upload)

    async def read(self) -> pb.StreamFramesResponse:
        try:
            async with asyncio.timeout(10):
                reply = await self.call.read()
        except grpc.aio.AioRpcError as error:
            raise error_of(error) from error
        assert isinstance(reply, pb.StreamFramesResponse), "the service ended the stream"
        return reply

    async def acks(self, *statuses: str) -> list[pb.Ack]:
        """The next acks, which must be of these statuses."""
        seen = [(await self.read()).ack for _ in statuses]
        assert [ACK(ack.status) for ack in seen] == [f"STATUS_{status}" for status in statuses], seen
        return seen


@contextlib.asynccontextmanager
async def raw_stream(port: int) -> AsyncIterator[Raw]:
    options = [("grpc.max_send_message_length", -1), ("grpc.enable_http_proxy", 0)]
    async with grpc.aio.insecure_channel(f"127.0.0.1:{port}", options) as channel:
        yield Raw(perception_pb2_grpc.PerceptionServiceStub(channel).StreamFrames())


# Hello, welcome


async def test_a_hello_is_welcomed_with_credits_the_last_sequence_and_the_feature_space(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        welcome = await robot.hello()

    assert (welcome.last_durable_sequence, welcome.credits, welcome.feature_space) == (0, 16, "painted")
    assert await store.scenes() == [SCENE]


async def test_a_frame_before_a_hello_is_refused_in_words(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.frame(painted(1, "cup"))
        with pytest.raises(InvalidInput, match="expected a hello first"):
            await robot.read()


async def test_a_second_hello_is_refused_in_words(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.hello()
        await robot.say(hello=pb.Hello(scene=SCENE))
        with pytest.raises(InvalidInput, match="expected frames after the hello, got hello"):
            await robot.read()


async def test_an_empty_stream_ends_quietly(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.call.done_writing()
        assert await robot.call.read() is grpc.aio.EOF
        assert await robot.call.code() is grpc.StatusCode.OK


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"scene": "my kitchen"}, "scene 'my kitchen': expected 1 to 64 letters"),
        ({"robot_id": ""}, "robot_id '': expected"),
        ({"session_id": "a.b"}, "session_id 'a.b': expected"),
        ({"intrinsics": Intrinsics(0, 0, 0, 0, 0, 0)}, "intrinsics: expected width and height of 16 to 8192"),
        ({"intrinsics": Intrinsics(float("nan"), 90, 48, 36, 96, 72)}, "intrinsics: expected finite"),
        ({"world_from_source": np.full((4, 4), np.nan)}, "pose: expected finite numbers"),
        ({"world_from_source": np.zeros((2, 2))}, "world_from_source: expected 16 numbers .* got 4"),
    ],
)
async def test_a_hello_that_is_wrong_is_refused_in_words_and_makes_no_scene(
    change: dict[str, Any], words: str, store: Store
) -> None:
    async with perception_on(store) as port:
        with pytest.raises(InvalidInput, match=words):
            await send(port, [painted(1, "cup")], dataclasses.replace(HELLO, **change))

    assert await store.scenes() == []


async def test_another_world_from_source_is_refused_and_the_scene_s_own_is_reported(store: Store) -> None:
    turned = dataclasses.replace(HELLO, world_from_source=pose(yaw=0.5))
    async with perception_on(store) as port:
        await send(port, [painted(1, "cup")], turned)
        with pytest.raises(InvalidInput, match="begun with another world_from_source"):
            await send(port, [painted(1, "cup")], dataclasses.replace(HELLO, session_id="s2"))
        await send(port, [painted(1, "cup")], dataclasses.replace(turned, session_id="s3"))
        status = await processed(port)

    assert status.world_from_source == pytest.approx(pose(yaw=0.5))
    assert status.frames_durable == 2


async def test_without_the_key_no_frame_is_taken(store: Store) -> None:
    async with perception_on(store, api_key="key") as port:
        for key in (None, "wrong"):
            with pytest.raises(NotAuthorized, match="authorization: Bearer KEY"):
                await send(port, [painted(1, "cup")], key=key)
        assert (await send(port, [painted(1, "cup")], key="key")).durable == 1


# Acks


async def test_a_frame_is_received_then_durable_then_applied(store: Store) -> None:
    mapper = MapperSettings(_env_file=None, mapper_port=0, api_key=None)
    async with perception_on(store) as port, serve_mapper(mapper, store), raw_stream(port) as robot:
        await robot.hello()
        await robot.frame(painted(7, "cup"))
        received, durable, applied = await robot.acks("RECEIVED", "DURABLE", "APPLIED")

    assert received.sequence == durable.sequence == applied.sequence == 7
    assert durable.frame_id == applied.frame_id == "r1.s1.00000007"
    assert 1 <= durable.credits <= 16
    assert not durable.duplicate


async def test_durable_is_said_only_once_the_frame_is_in_the_log_with_its_images(store: Store) -> None:
    sent = painted(1, "cup")
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.hello()
        await robot.frame(sent)
        await robot.acks("RECEIVED", "DURABLE")
        (entry,) = await store.read(SCENE, "frames")
        assert await store.blobs.get(entry.fields["rgb"].decode()) == sent.rgb
        assert await store.blobs.get(entry.fields["depth"].decode()) == sent.depth


async def test_a_frame_sent_again_is_durable_a_duplicate_and_changes_nothing(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.hello()
        for sequence in (1, 2, 1, 2):
            await robot.frame(painted(sequence, "cup"))
        acks = [(await robot.read()).ack for _ in range(8)]

    durable = [ack for ack in acks if ack.status == pb.Ack.STATUS_DURABLE]
    assert [ack.sequence for ack in durable] == [1, 2, 1, 2]
    assert [ack.duplicate for ack in durable] == [False, False, True, True]
    assert await store.length(SCENE, "frames") == 2


async def test_a_sequence_that_was_passed_over_is_rejected_not_called_durable(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.hello()
        await robot.frame(painted(5, "cup"))
        await robot.frame(painted(3, "cup"))
        acks = [(await robot.read()).ack for _ in range(4)]

    last = {ack.sequence: ack for ack in acks}
    assert last[5].status == pb.Ack.STATUS_DURABLE
    assert last[3].status == pb.Ack.STATUS_REJECTED
    assert last[3].reason == "sequence: expected above 5, the session's last, got 3"
    assert await store.length(SCENE, "frames") == 1


async def test_frames_taken_in_at_once_are_durable_in_order_whichever_of_them_is_rejected(
    store: Store,
) -> None:
    frames = [painted(n, "cup") for n in range(1, 13)]
    for n in (3, 4, 9):
        frames[n] = dataclasses.replace(frames[n], rgb=frames[n].rgb[:50])
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.hello()
        for frame in frames:
            await robot.frame(frame)
        acks = [(await robot.read()).ack for _ in range(9 + 9 + 3)]

    good = [n for n in range(1, 13) if n - 1 not in (3, 4, 9)]
    assert [ack.sequence for ack in acks if ack.status == pb.Ack.STATUS_DURABLE] == good
    assert {ack.sequence for ack in acks if ack.status == pb.Ack.STATUS_REJECTED} == {4, 5, 10}
    entries = await store.read(SCENE, "frames")
    assert [int(e.fields["frame_id"].decode().rpartition(".")[2]) for e in entries] == good


async def test_playing_a_whole_recording_again_changes_nothing(store: Store) -> None:
    frames = [painted(n, "cup", "chair") for n in range(1, 6)]
    async with perception_on(store) as port:
        first = await send(port, frames)
        before = await processed(port)
        log = await store.read(SCENE, "detections", count=1000)
        again = await send(port, frames)
        forced = await send(port, frames, resume=False)
        after = await processed(port)

    assert (first.sent, first.durable, first.resumed_after) == (5, 5, 0)
    assert (again.sent, again.resumed_after) == (0, 5)
    assert (forced.sent, forced.durable) == (5, 5)
    assert dataclasses.replace(after, world_from_source=before.world_from_source) == before
    assert await store.read(SCENE, "detections", count=1000) == log


# Frames that are wrong

GOOD = painted(9, "cup")
WRONG = {
    "a NaN pose": ({"world_from_camera": np.full((4, 4), np.nan)}, "pose: expected finite numbers"),
    "a pose that is not rigid": ({"world_from_camera": np.diag([2.0, 2, 2, 1])}, "pose: expected a rigid"),
    "a pose of 3x3": ({"world_from_camera": np.eye(3)}, "pose: expected 16 numbers .* got 9"),
    "depth of another size": (
        {"depth": png(depth_units(hello().intrinsics))},
        "depth image: expected 96x72 .* got 64x48",
    ),
    "depth of 8 bits": (
        {"depth": png(np.zeros((72, 96), np.uint8))},
        "depth image: expected one channel of 16 bits",
    ),
    "a depth scale of 0": ({"depth_scale": 0.0}, "depth image: expected a scale"),
    "colour of another size": (
        {"rgb": jpeg(colour_noise(hello().intrinsics))},
        "colour image: expected 96x72",
    ),
    "a truncated JPEG": ({"rgb": jpeg(colour_noise(K))[:900]}, "colour image: expected a whole JPEG"),
    "no colour": ({"rgb": b""}, "colour image: expected JPEG or PNG bytes, got 0 bytes"),
    "garbage for zstd": (
        {"depth": b"no", "depth_encoding": "shuffle_zstd"},
        "depth image: .* do not decompress",
    ),
    "a sequence too large": ({"sequence": 10**8}, "sequence: expected 1 to 99999999"),
    "a time too large": ({"timestamp_ns": 2**64 - 1}, "timestamp_ns: expected nanoseconds"),
    "a score of 2": (
        {"detections": (OutgoingDetection("cup", 2.0, Box2(0, 0, 9, 9)),)},
        "detection 0 .cup.: expected a score of 0 to 1, got 2.0",
    ),
    "a mask that is no PNG": (
        {"detections": (OutgoingDetection("cup", 0.9, Box2(0, 0, 9, 9), mask_png=b"mask"),)},
        "mask of 'cup': expected a PNG",
    ),
}


@pytest.mark.parametrize("what", WRONG)
async def test_a_wrong_frame_is_rejected_with_its_reason_and_the_stream_goes_on(
    what: str, store: Store
) -> None:
    change, words = WRONG[what]
    events: list[StreamEvent] = []
    frames = [dataclasses.replace(GOOD, **{"sequence": 1, **change}), painted(10, "cup")]
    async with perception_on(store) as port:
        report = await send(port, frames, on_event=events.append)

    (rejected,) = report.rejected
    assert rejected.sequence == frames[0].sequence
    with pytest.raises(InvalidInput, match=words):
        raise InvalidInput(rejected.reason)
    assert report.durable == 1
    assert [e.fields["frame_id"] for e in await store.read(SCENE, "frames")] == [b"r1.s1.00000010"]


async def test_an_unset_depth_encoding_is_rejected_in_words(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.hello()
        await robot.frame(GOOD, depth=types_pb2.DepthImage(data=GOOD.depth, scale=1000))
        (rejected,) = await robot.acks("REJECTED")
        await robot.frame(painted(10, "cup"))
        await robot.acks("RECEIVED", "DURABLE")

    assert "expected encoding png16 or shuffle_zstd, got 'unspecified'" in rejected.reason


async def test_sequences_start_at_one(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as robot:
        await robot.hello()
        await robot.frame(dataclasses.replace(GOOD, sequence=0))
        (rejected,) = await robot.acks("REJECTED")

    assert rejected.reason == "sequence: expected 1 to 99999999, got 0"


async def test_a_20_mb_message_ends_its_stream_in_words_and_nothing_else(store: Store) -> None:
    async with perception_on(store) as port, raw_stream(port) as other:
        await other.hello(dataclasses.replace(HELLO, session_id="other"))
        async with raw_stream(port) as robot:
            await robot.hello()
            await robot.frame(dataclasses.replace(GOOD, rgb=b"\x89PNG\r\n\x1a\n" + b"x" * 20_000_000))
            with pytest.raises(TooLarge, match="larger than max"):
                await robot.read()
        with pytest.raises(TooLarge, match="frame 2: expected at most 16 MB a frame, got 19.1 MB"):
            await send(
                port, [painted(1, "cup"), dataclasses.replace(GOOD, sequence=2, rgb=b"x" * 20_000_000)]
            )
        await other.frame(painted(1, "cup"))
        await other.acks("RECEIVED", "DURABLE")
        assert (await send(port, [painted(3, "cup")])).durable == 1


# Losing the connection


class Wire:
    """A network between a robot and the service, that can be cut."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._open: set[asyncio.StreamWriter] = set()

    async def take(self, near_in: asyncio.StreamReader, near_out: asyncio.StreamWriter) -> None:
        far_in, far_out = await asyncio.open_connection("127.0.0.1", self._port)
        self._open |= {near_out, far_out}
        await asyncio.gather(_carry(near_in, far_out), _carry(far_in, near_out))

    def cut(self) -> None:
        for writer in self._open:
            writer.transport.abort()
        self._open.clear()


async def _carry(source: asyncio.StreamReader, sink: asyncio.StreamWriter) -> None:
    with contextlib.suppress(OSError):
        while data := await source.read(65536):
            sink.write(data)
            await sink.drain()


async def test_a_stream_goes_on_over_lost_connections_without_loss_or_repeat(store: Store) -> None:
    frames = [painted(n, "cup") for n in range(1, 41)]
    events: list[StreamEvent] = []
    async with perception_on(store) as port:
        wire = Wire(port)

        def cut_now_and_then(event: StreamEvent) -> None:
            events.append(event)
            if event.status == "durable" and event.sequence in {5, 6, 20, 33} and not event.duplicate:
                wire.cut()

        network = await asyncio.start_server(wire.take, "127.0.0.1", 0)
        report = await send(network.sockets[0].getsockname()[1], frames, on_event=cut_now_and_then)
        wire.cut()
        network.close()

    assert report.reconnects >= 2
    assert report.durable == 40
    assert report.rejected == []
    ids = [e.fields["frame_id"].decode() for e in await store.read(SCENE, "frames", count=100)]
    assert ids == [f"r1.s1.{n:08d}" for n in range(1, 41)]


async def test_a_robot_that_was_waiting_goes_on_when_the_service_was_restarted(store: Store) -> None:
    restarted = asyncio.Event()
    first_is_durable = asyncio.Event()

    async def live() -> AsyncIterator[OutgoingFrame]:
        yield painted(1, "cup")
        await restarted.wait()
        yield painted(2, "cup")

    def note(event: StreamEvent) -> None:
        if event.status == "durable":
            first_is_durable.set()

    async with perception_on(store) as port:
        sending = asyncio.create_task(_send_live(port, live(), note))
        await first_is_durable.wait()
    async with perception_on(store, perception_port=port):
        restarted.set()
        report = await asyncio.wait_for(sending, 20)

    assert (report.durable, report.rejected) == (2, [])
    assert report.reconnects >= 1


async def _send_live(
    port: int, frames: AsyncIterator[OutgoingFrame], on_event: Callable[[StreamEvent], None]
) -> StreamReport:
    async with channel_to(port) as channel:
        return await FrameStream(channel, HELLO, keep="newest", on_event=on_event).send(frames)


async def test_a_robot_that_starts_anew_resumes_its_session_where_it_was(store: Store) -> None:
    frames = [painted(n, "cup") for n in range(1, 8)]
    async with perception_on(store) as port:
        await send(port, frames[:3])
    async with perception_on(store) as port:
        report = await send(port, frames)

    assert (report.resumed_after, report.sent, report.durable) == (3, 4, 4)
    assert await store.length(SCENE, "frames") == 7


async def test_a_service_that_stays_away_is_unavailable_in_words(store: Store) -> None:
    async with perception_on(store) as port:
        pass
    for key in (None, "key"):
        with pytest.raises(Unavailable):
            await send(port, [painted(1, "cup")], key=key, patience_s=0.5)


async def test_frames_that_cannot_be_read_raise_their_error_after_those_before_are_durable(
    store: Store,
) -> None:
    def broken() -> Iterator[OutgoingFrame]:
        yield painted(1, "cup")
        raise OSError("the disk is gone")

    async with perception_on(store) as port:
        with pytest.raises(OSError, match="the disk is gone"):
            await send(port, broken())

    assert await store.length(SCENE, "frames") <= 1


async def test_a_live_robot_keeps_the_newest_and_drops_what_found_no_credit(store: Store) -> None:
    async def live() -> AsyncIterator[OutgoingFrame]:
        for n in range(1, 41):
            yield painted(n, "cup")

    async with perception_on(store, window=1) as port, channel_to(port) as channel:
        report = await FrameStream(channel, HELLO, keep="newest").send(live())

    sequences = [int(e.fields["frame_id"][-8:]) for e in await store.read(SCENE, "frames", count=100)]
    assert report.dropped > 0
    assert report.dropped + report.durable == 40
    assert len(sequences) == report.durable
    assert sequences == sorted(sequences)
    assert sequences[-1] == 40


async def test_a_robot_never_has_more_in_flight_than_its_credits(store: Store) -> None:
    in_flight: list[int] = []
    open_ = 0

    class Counting:
        def __init__(self, channel: Any) -> None:
            self._channel = channel

        def stream_stream(self, *args: Any, **kwargs: Any) -> Any:
            make = self._channel.stream_stream(*args, **kwargs)

            def call() -> Any:
                made = make()
                write = made.write

                async def counted_write(message: pb.StreamFramesRequest) -> None:
                    nonlocal open_
                    if message.HasField("frame"):
                        open_ += 1
                        in_flight.append(open_)
                    await write(message)

                made.write = counted_write
                return made

            return call

        def __getattr__(self, name: str) -> Any:
            return getattr(self._channel, name)

    def done(event: StreamEvent) -> None:
        nonlocal open_
        open_ -= event.status == "durable"

    async with perception_on(store, window=3) as port, channel_to(port) as channel:
        await FrameStream(Counting(channel), HELLO, on_event=done).send(
            painted(n, "cup") for n in range(1, 16)
        )

    assert max(in_flight) <= 3


async def test_credits_shrink_as_the_backlog_fills(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("services.perception.service._CREDITS_SECONDS", 0.0)
    monkeypatch.setattr(perception, "follow_scenes", lambda *_: asyncio.sleep(3600))
    async with perception_on(store, max_backlog=5, window=4) as port, raw_stream(port) as robot:
        credits = [(await robot.hello()).credits]
        for n in range(1, 7):
            await robot.frame(painted(n, "cup"))
            credits.append((await robot.acks("RECEIVED", "DURABLE"))[1].credits)

    assert credits == [4, 4, 3, 2, 1, 1, 1]


# From frames to detections, and back out


async def test_frames_become_detections_through_the_gate_with_late_ones_caught_up(
    store: Store, models: PaintedModels
) -> None:
    frames = [painted(1, "cup"), painted(2, "cup", "logo"), painted(3, "cup", "chair"), painted(4, "cup")]
    async with perception_on(store) as port:
        await send(port, frames)
        status = await processed(port)

    batches = await detections_in(store)
    assert [(b.frame_id[-1], b.late, [d.label for d in b.detections]) for b in batches] == [
        ("1", False, []),
        ("2", False, []),
        ("3", False, ["cup"]),
        ("1", True, ["cup"]),
        ("2", True, ["cup"]),
        ("4", False, ["cup"]),
    ]
    assert status.vocabulary == ("cup",)
    assert (status.frames_durable, status.frames_processed, status.frames_skipped, status.detections) == (
        4,
        4,
        0,
        4,
    )
    assert len({d.detection_id for b in batches for d in b.detections}) == 4
    assert all(len(b.surface) > 0 for b in batches if not b.late)
    assert not any(len(b.surface) for b in batches if b.late)
    cup = batches[2].detections[0]
    assert cup.points[:, 0] == pytest.approx(2.0)  # two metres ahead of a camera that looks along x
    assert sorted(models.grounded) == sorted({(f"r1.s1.{n:08d}", "cup") for n in range(1, 5)})


async def test_a_map_grows_from_a_stream(store: Store) -> None:
    mapper = MapperSettings(_env_file=None, mapper_port=0, api_key=None)
    async with perception_on(store) as port, serve_mapper(mapper, store) as mapper_port:
        await send(port, [painted(n, "cup", "chair") for n in range(1, 6)])
        status = await processed(port)
        async with channel_to(mapper_port) as channel, asyncio.timeout(10):
            seen = await MapperClient(channel).get_map(SCENE)
            while seen.applied_log_id != status.newest_detections_id:
                await asyncio.sleep(0.05)
                seen = await MapperClient(channel).get_map(SCENE)

    assert sorted((o.label, o.frames) for o in seen.objects) == [("chair", 5), ("cup", 5)]


async def test_a_robot_that_detects_on_board_skips_the_models_and_the_gate(
    store: Store, models: PaintedModels
) -> None:
    mug = OutgoingDetection(
        "Coffee Mugs",
        0.8,
        Box2(20, 20, 60, 60),
        feature=(0.0,) * 7 + (2.0,),
        second_feature=(3.0, 4.0),
    )
    frame = dataclasses.replace(
        painted(1, "cup"), rgb=png(np.full((72, 96, 3), 90, np.uint8)), detections=(mug,)
    )
    empty = dataclasses.replace(painted(2, "cup"), detections=())
    async with perception_on(store) as port:
        await send(port, [frame, empty])
        status = await processed(port)

    one, other = await detections_in(store)
    assert [d.label for d in one.detections] == ["coffee mug"]
    assert one.detections[0].feature.tolist() == [0.0] * 7 + [1.0]
    assert one.detections[0].second_feature == pytest.approx([0.6, 0.8])
    assert other.detections == ()
    assert status.detections == 1
    assert models.grounded == []


async def test_the_history_gives_back_what_was_sent(store: Store) -> None:
    frames = [painted(n, "cup", "table") for n in range(1, 4)]
    async with perception_on(store) as port, channel_to(port) as channel:
        await send(port, frames)
        await processed(port)
        client = PerceptionClient(channel)
        records, features = await client.list_frames(SCENE)
        rest, _ = await client.list_frames(SCENE, after=records[0].log_id)
        first, _ = await client.list_frames(SCENE, limit=1)
        whole = await client.get_frame(SCENE, records[0].frame_id)
        rgb = await client.get_rgb(SCENE, records[0].frame_id)

        assert [r.frame_id for r in records] == [f"r1.s1.{n:08d}" for n in (1, 2, 3)]
        assert all(r.processed and r.tags == ("cup", "table") for r in records)
        assert [r.frame_id for r in rest] == [r.frame_id for r in records[1:]]
        assert [r.frame_id for r in first] == [records[0].frame_id]
        assert sorted(features) == ["cup", "table"]
        assert whole.depth == pytest.approx(np.full((72, 96), 2.0))
        assert whole.world_from_camera == pytest.approx(frames[0].world_from_camera)
        assert rgb == frames[0].rgb
        with pytest.raises(NotFound, match="frame 'r1.s1.00000099' is not in scene kitchen"):
            await client.get_frame(SCENE, "r1.s1.00000099")
        with pytest.raises(NotFound, match="there is no scene 'attic'; known: kitchen"):
            await client.list_frames("attic")
        for bad in ("yesterday", "²-1", "1" * 30 + "-0"):
            with pytest.raises(InvalidInput, match="after_log_id: expected an id like"):
                await client.list_frames(SCENE, after=bad)


async def test_words_are_grounded_in_the_history_past_the_gate(store: Store) -> None:
    async with perception_on(store) as port, channel_to(port) as channel:
        await send(port, [painted(1, "cup"), painted(2, "chair")])
        await processed(port)
        client = PerceptionClient(channel)
        records, _ = await client.list_frames(SCENE)
        grounded, blind = await client.ground(SCENE, [r.frame_id for r in records], ["Cups", "unicorn"])

        assert {frame: [d.label for d in found] for frame, found in grounded.items()} == {
            "r1.s1.00000001": ["cup"],
            "r1.s1.00000002": [],
        }
        assert blind == ("unicorn",)
        with pytest.raises(InvalidInput, match="words: expected 1 to 32 non-empty words, got 0"):
            await client.ground(SCENE, [], [])
        with pytest.raises(InvalidInput, match="frame_ids: expected at most 64, got 65"):
            await client.ground(SCENE, ["f"] * 65, ["cup"])
        with pytest.raises(InvalidInput, match="texts: expected"):
            await client.embed_text([])
        with pytest.raises(InvalidInput, match="texts: expected 1 to 1000 characters each"):
            await client.embed_text(["x" * 1001])


async def test_two_robots_stream_into_one_scene_at_once(store: Store) -> None:
    async with perception_on(store) as port:
        await asyncio.gather(
            *(
                send(
                    port, [painted(n, "cup") for n in range(1, 6)], dataclasses.replace(HELLO, robot_id=robot)
                )
                for robot in ("r1", "r2")
            )
        )
        status = await processed(port)

    assert (status.frames_durable, status.frames_processed) == (10, 10)
    assert len({b.frame_id for b in await detections_in(store)}) == 10


async def test_a_noise_image_without_things_is_processed_too(store: Store) -> None:
    async with perception_on(store) as port:
        await send(port, [outgoing(1, K, rgb=jpeg(colour_noise(K)), depth=png(depth_units(K, 0.0)))])
        status = await processed(port)

    assert (status.frames_processed, status.detections) == (1, 0)
    (only,) = await detections_in(store)
    assert (only.detections, len(only.surface)) == ((), 0)
