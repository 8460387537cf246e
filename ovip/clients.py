"""Typed clients of every service, for services and the SDK; protobuf and gRPC stay inside.

All raise the tree of `ovip.errors`. Reads are tried again for a while when a service is away.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Sequence
from typing import Any

import grpc
import numpy as np

from ovip import codec
from ovip.errors import OvipError, Unavailable, from_status
from ovip.scene.answers import (
    FrameRecord,
    GatewayStatus,
    Observation,
    PerceptionStatus,
    Query,
    SceneSummary,
    SearchEvent,
    VlmReply,
)
from ovip.scene.grid import FloorGrid
from ovip.scene.types import F32, U8, Detection, Frame, MapDelta, MapObject, Partition, SceneMap
from ovip.v1 import (
    mapper_pb2,
    mapper_pb2_grpc,
    perception_pb2,
    perception_pb2_grpc,
    regions_pb2,
    regions_pb2_grpc,
    retrieval_pb2,
    retrieval_pb2_grpc,
    types_pb2,
    vlm_pb2,
    vlm_pb2_grpc,
)
from ovip.wire import decode_depth, decode_rgb

MAX_MESSAGE_BYTES = 16 * 1024 * 1024
_READ_SECONDS = 30.0
_SLOW_SECONDS = 600.0
_PURPOSES = {
    "search": vlm_pb2.AskRequest.PURPOSE_SEARCH,
    "enumerate": vlm_pb2.AskRequest.PURPOSE_ENUMERATE,
    "group": vlm_pb2.AskRequest.PURPOSE_GROUP,
}


def connect(address: str, api_key: str | None = None) -> Any:
    """An asyncio channel to `host:port` that carries the key and survives a restart of the other side."""
    return grpc.aio.insecure_channel(
        address,
        options=[
            ("grpc.max_receive_message_length", MAX_MESSAGE_BYTES),
            ("grpc.max_send_message_length", MAX_MESSAGE_BYTES),
            ("grpc.initial_reconnect_backoff_ms", 100),
            ("grpc.max_reconnect_backoff_ms", 1000),
            ("grpc.enable_http_proxy", 0),
        ],
        interceptors=_key_interceptors(api_key),
    )


class MapperClient:
    """Reads the map."""

    def __init__(self, channel: Any) -> None:
        self._stub = mapper_pb2_grpc.MapperServiceStub(channel)

    async def list_scenes(self) -> list[SceneSummary]:
        reply = await _read(
            lambda: self._stub.ListScenes(mapper_pb2.ListScenesRequest(), timeout=_READ_SECONDS)
        )
        return [SceneSummary(s.scene, s.map_version, s.objects, s.frames, s.detections) for s in reply.scenes]

    async def get_map(self, scene: str, include_unconfirmed: bool = False) -> SceneMap:
        request = mapper_pb2.GetMapRequest(scene=scene, include_unconfirmed=include_unconfirmed)
        return codec.map_value(await _read(lambda: self._stub.GetMap(request, timeout=_READ_SECONDS)))

    async def get_object(self, scene: str, object_id: str) -> MapObject:
        request = mapper_pb2.GetObjectRequest(scene=scene, object_id=object_id)
        reply = await _read(lambda: self._stub.GetObject(request, timeout=_READ_SECONDS))
        return codec.object_value(reply.object)

    async def get_points(
        self, scene: str, object_ids: Sequence[str] = (), max_points: int = 0
    ) -> dict[str, tuple[F32, U8]]:
        """Points `(N, 3)` and colours `(N, 3)` of objects; none named: of all confirmed ones."""
        request = mapper_pb2.GetObjectPointsRequest(scene=scene, object_ids=object_ids, max_points=max_points)
        reply = await _read(lambda: self._stub.GetObjectPoints(request, timeout=_READ_SECONDS))
        return {
            item.object_id: (codec.floats_value(item.points, 3), codec.colors_value(item.colors))
            for item in reply.objects
        }

    async def watch(self, scene: str, after_version: int) -> AsyncIterator[MapDelta]:
        """Deltas above a version, then live ones, until the caller stops."""
        request = mapper_pb2.WatchMapRequest(scene=scene, after_version=after_version)
        with _errors():
            async for reply in self._stub.WatchMap(request):
                yield codec.delta_value(reply.delta)


class PerceptionClient:
    """Reads the frame history and grounds words in it."""

    def __init__(self, channel: Any) -> None:
        self._stub = perception_pb2_grpc.PerceptionServiceStub(channel)

    async def list_frames(
        self, scene: str, after: str = "", limit: int = 0
    ) -> tuple[list[FrameRecord], dict[str, F32]]:
        """Frames after a log id, and the text feature `(D,)` of every tag word among them."""
        request = perception_pb2.ListFramesRequest(scene=scene, after_log_id=after, limit=limit)
        reply = await _read(lambda: self._stub.ListFrames(request, timeout=_READ_SECONDS))
        features = {word: codec.floats_value(data) for word, data in reply.tag_features.items()}
        return [codec.frame_record_value(f) for f in reply.frames], features

    async def get_frame(self, scene: str, frame_id: str) -> Frame:
        """A frame with its images, decoded."""
        request = perception_pb2.GetFrameRequest(
            scene=scene, frame_id=frame_id, with_rgb=True, with_depth=True
        )
        reply = await _read(lambda: self._stub.GetFrame(request, timeout=_READ_SECONDS))
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
        reply = await _read(lambda: self._stub.GetFrame(request, timeout=_READ_SECONDS))
        return codec.frame_record_value(reply.frame)

    async def get_rgb(self, scene: str, frame_id: str) -> bytes:
        """A frame's colour image as the robot sent it (JPEG or PNG bytes)."""
        request = perception_pb2.GetFrameRequest(scene=scene, frame_id=frame_id, with_rgb=True)
        reply = await _read(lambda: self._stub.GetFrame(request, timeout=_READ_SECONDS))
        return bytes(reply.rgb.data)

    async def ground(
        self, scene: str, frame_ids: Sequence[str], words: Sequence[str]
    ) -> tuple[dict[str, tuple[Detection, ...]], tuple[str, ...]]:
        """Detections of `words` by frame, past the vocabulary gate, and the words the grounder cannot see."""
        request = perception_pb2.GroundRequest(scene=scene, frame_ids=frame_ids, words=words)
        reply = await _read(lambda: self._stub.Ground(request, timeout=_SLOW_SECONDS))
        grounded = {f.frame_id: tuple(codec.detection_value(d) for d in f.detections) for f in reply.frames}
        return grounded, tuple(reply.ungroundable_words)

    async def embed_text(self, texts: Sequence[str]) -> F32:
        """Unit text features `(N, D)` in the space of the object features."""
        request = perception_pb2.EmbedTextRequest(texts=texts)
        reply = await _read(lambda: self._stub.EmbedText(request, timeout=_READ_SECONDS))
        return np.stack([codec.floats_value(data) for data in reply.features])

    async def status(self, scene: str) -> PerceptionStatus:
        request = perception_pb2.GetPerceptionStatusRequest(scene=scene)
        reply = await _read(lambda: self._stub.GetPerceptionStatus(request, timeout=_READ_SECONDS))
        return codec.perception_status_value(reply)


class RegionsClient:
    """Reads the partition of a scene and its navigation grids."""

    def __init__(self, channel: Any) -> None:
        self._stub = regions_pb2_grpc.RegionsServiceStub(channel)

    async def get_partition(self, scene: str) -> Partition:
        """The newest partition; revision 0 and no regions before the first."""
        request = regions_pb2.GetRegionsRequest(scene=scene)
        reply = await _read(lambda: self._stub.GetRegions(request, timeout=_READ_SECONDS))
        return codec.partition_value(reply.partition)

    async def recompute(self, scene: str) -> Partition:
        request = regions_pb2.RecomputeRequest(scene=scene)
        reply = await _read(lambda: self._stub.Recompute(request, timeout=_SLOW_SECONDS))
        return codec.partition_value(reply.partition)

    async def watch(self, scene: str, after_revision: int = 0) -> AsyncIterator[Partition]:
        """The newest partition above a revision, then each new one, until the caller stops."""
        request = regions_pb2.WatchRegionsRequest(scene=scene, after_revision=after_revision)
        with _errors():
            async for reply in self._stub.WatchRegions(request):
                yield codec.partition_value(reply.partition)

    async def get_floor_grid(self, scene: str, floor: int) -> FloorGrid:
        request = regions_pb2.GetFloorGridRequest(scene=scene, floor=floor)
        return codec.floor_grid_value(
            await _read(lambda: self._stub.GetFloorGrid(request, timeout=_READ_SECONDS))
        )


class RetrievalClient:
    """Asks where things are."""

    def __init__(self, channel: Any) -> None:
        self._stub = retrieval_pb2_grpc.RetrievalServiceStub(channel)

    async def find(self, query: Query) -> AsyncIterator[tuple[str, SearchEvent]]:
        """(search id, event) pairs; the last event is the Answer."""
        with _errors():
            async for reply in self._stub.Find(codec.query_message(query), timeout=_SLOW_SECONDS):
                yield reply.search_id, codec.event_value(reply.event)

    async def search(
        self,
        start: Query | str,
        observe: Callable[[SearchEvent], Awaitable[Observation | None]],
    ) -> AsyncIterator[tuple[str, SearchEvent]]:
        """A search with a robot: `observe` is called for each event and answers viewpoints; the Answer comes last.

        start: a new query, or "SCENE/SEARCH_ID" to go on with a stored search. `observe` returning None for a
        viewpoint cancels the search.
        """
        call = self._stub.Search()
        with _errors():
            if isinstance(start, Query):
                await call.write(retrieval_pb2.SearchRequest(start=codec.query_message(start)))
            else:
                await call.write(retrieval_pb2.SearchRequest(resume_search_id=start))
            async for reply in call:
                event = codec.event_value(reply.event)
                yield reply.search_id, event
                if reply.event.WhichOneof("event") != "viewpoint":
                    continue
                seen = await observe(event)
                if seen is None:
                    await call.write(retrieval_pb2.SearchRequest(cancel=True))
                    continue
                await call.write(
                    retrieval_pb2.SearchRequest(
                        observation=retrieval_pb2.Observation(
                            viewpoint_id=seen.viewpoint_id,
                            frame_id=seen.frame_id,
                            unreachable=seen.unreachable,
                        )
                    )
                )

    async def get_search(self, scene: str, search_id: str) -> tuple[str, bool, Any]:
        """Text, whether it is done, and the Answer if so."""
        request = retrieval_pb2.GetSearchRequest(scene=scene, search_id=search_id)
        reply = await _read(lambda: self._stub.GetSearch(request, timeout=_READ_SECONDS))
        return reply.text, reply.done, codec.answer_value(reply.answer) if reply.HasField("answer") else None


class VlmClient:
    """Asks the VLM gateway."""

    def __init__(self, channel: Any) -> None:
        self._stub = vlm_pb2_grpc.VlmGatewayServiceStub(channel)

    async def ask(
        self,
        purpose: str,
        prompt: str,
        images: Sequence[bytes] = (),
        schema: dict[str, Any] | None = None,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
    ) -> VlmReply:
        """A reply that satisfies `schema`. images: JPEG bytes. NotConfigured where there is no upstream."""
        request = vlm_pb2.AskRequest(
            purpose=_PURPOSES[purpose],
            prompt=prompt,
            images=[types_pb2.Image(encoding=types_pb2.Image.ENCODING_JPEG, data=data) for data in images],
            json_schema=json.dumps(schema or {}),
            max_output_tokens=max_output_tokens,
            deadline_s=deadline_s,
        )
        with _errors():
            reply = await self._stub.Ask(request, timeout=(deadline_s or _SLOW_SECONDS) + 5.0)
        return VlmReply(
            value=json.loads(reply.json),
            cached=reply.cached,
            route=reply.route,
            prompt_tokens=reply.prompt_tokens,
            output_tokens=reply.output_tokens,
            ms=reply.milliseconds,
        )

    async def status(self) -> GatewayStatus:
        request = vlm_pb2.GetGatewayStatusRequest()
        reply = await _read(lambda: self._stub.GetGatewayStatus(request, timeout=_READ_SECONDS))
        return GatewayStatus(
            reply.configured, tuple(reply.routes), reply.calls, reply.cache_hits, reply.refused
        )


async def _read(call: Callable[[], Awaitable[Any]]) -> Any:
    """The reply of a call that changes nothing; tried four times over two seconds while the service is away."""
    for pause in (0.1, 0.5, 1.5):
        try:
            with _errors():
                return await call()
        except Unavailable:
            await asyncio.sleep(pause)
    with _errors():
        return await call()


@contextlib.contextmanager
def _errors() -> Iterator[None]:
    try:
        yield
    except grpc.aio.AioRpcError as error:
        raise error_of(error) from error


def error_of(error: grpc.aio.AioRpcError) -> OvipError:
    """The error of our tree that a gRPC status stands for."""
    trailing = dict(error.trailing_metadata() or ())
    slug = str(trailing.get("ovip-error", ""))
    return from_status(error.code().name, error.details() or error.code().name, slug)


def _key_interceptors(api_key: str | None) -> list[Any]:
    if not api_key:
        return []
    kinds = ("UnaryUnary", "UnaryStream", "StreamUnary", "StreamStream")
    return [_key_interceptor(kind, f"Bearer {api_key}") for kind in kinds]


def _key_interceptor(kind: str, value: str) -> Any:
    base = getattr(grpc.aio, f"{kind}ClientInterceptor")

    async def intercept(_self: Any, continuation: Any, details: Any, request: Any) -> Any:
        metadata = grpc.aio.Metadata(*(details.metadata or ()))
        metadata.add("authorization", value)
        return await continuation(details._replace(metadata=metadata), request)

    name = {"UnaryUnary": "unary_unary", "UnaryStream": "unary_stream", "StreamUnary": "stream_unary"}.get(
        kind, "stream_stream"
    )
    return type(f"Key{kind}", (base,), {f"intercept_{name}": intercept})()
