"""The client of the mapper."""

from __future__ import annotations

from collections.abc import AsyncIterator, Sequence
from typing import Any

from ovip import codec
from ovip.clients.connection import READ_SECONDS, SLOW_SECONDS, errors, read, read_stream
from ovip.scene.answers import SceneSummary
from ovip.scene.edits import EditRequest
from ovip.scene.types import F32, F64, U8, MapDelta, MapObject, SceneMap
from ovip.scene.versions import Alignment, MapDiff, Verification
from ovip.v1 import mapper_pb2, mapper_pb2_grpc

_WHOLE_SECONDS = 120.0
"""For a whole map to arrive."""


class MapperClient:
    """Reads and edits the map."""

    def __init__(self, channel: Any) -> None:
        self._stub = mapper_pb2_grpc.MapperServiceStub(channel)

    async def list_scenes(self) -> list[SceneSummary]:
        request = mapper_pb2.ListScenesRequest()
        reply = await read(lambda: self._stub.ListScenes(request, timeout=READ_SECONDS))
        return [SceneSummary(s.scene, s.map_version, s.objects, s.frames, s.detections) for s in reply.scenes]

    async def get_map(
        self,
        scene: str,
        include_unconfirmed: bool = False,
        at_version: int = 0,
        include_departed: bool = False,
    ) -> SceneMap:
        """The map as it stands (at_version 0) or stood; confirmed objects that are present, unless asked for more."""
        request = mapper_pb2.GetMapRequest(
            scene=scene,
            include_unconfirmed=include_unconfirmed,
            at_version=at_version,
            include_departed=include_departed,
        )
        seconds = SLOW_SECONDS if at_version else _WHOLE_SECONDS
        return codec.map_value(await read_stream(lambda: self._stub.GetMap(request, timeout=seconds)))

    async def get_object(self, scene: str, object_id: str) -> MapObject:
        """One object, by its id or by one that was merged into it."""
        request = mapper_pb2.GetObjectRequest(scene=scene, object_id=object_id)
        reply = await read(lambda: self._stub.GetObject(request, timeout=READ_SECONDS))
        return codec.object_value(reply.object)

    async def get_points(
        self, scene: str, object_ids: Sequence[str] = (), max_points: int = 0
    ) -> dict[str, tuple[F32, U8]]:
        """Points `(N, 3)` and colours `(N, 3)` of objects; none named: of all confirmed ones that are present."""
        request = mapper_pb2.GetObjectPointsRequest(scene=scene, object_ids=object_ids, max_points=max_points)
        parts = await read_stream(lambda: self._stub.GetObjectPoints(request, timeout=_WHOLE_SECONDS))
        _, clouds = codec.points_value(parts)
        return clouds

    async def watch(self, scene: str, after_version: int) -> AsyncIterator[MapDelta]:
        """Deltas above a version, then live ones, until the caller stops."""
        request = mapper_pb2.WatchMapRequest(scene=scene, after_version=after_version)
        with errors():
            async for reply in self._stub.WatchMap(request):
                yield codec.delta_value(reply.delta)

    async def diff(self, scene: str, from_version: int, to_version: int = 0) -> MapDiff:
        """What differs between two versions (to_version 0: as it stands). Its objects come without features."""
        request = mapper_pb2.DiffMapRequest(scene=scene, from_version=from_version, to_version=to_version)
        return codec.diff_value(await read(lambda: self._stub.DiffMap(request, timeout=SLOW_SECONDS)))

    async def verify(self, scene: str) -> Verification:
        """The map in use against the one rebuilt from the first entry of its log."""
        request = mapper_pb2.VerifyMapRequest(scene=scene)
        return codec.verification_value(
            await read(lambda: self._stub.VerifyMap(request, timeout=SLOW_SECONDS))
        )

    async def edit(self, scene: str, request: EditRequest) -> MapDelta:
        """Does an operator's edit. Conflict where what it edits has changed since the version it was made on.

        Sent again while the service is away: its `edit_id` lets it be done once.
        """
        message = codec.edit_request_message(request, scene)
        reply = await read(lambda: self._stub.EditMap(message, timeout=SLOW_SECONDS))
        return codec.delta_value(reply.delta)

    async def join(
        self, scene: str, other_scene: str, world_from_other: F64, edit_id: str
    ) -> tuple[MapDelta, dict[str, str]]:
        """Brings another scene's objects into this map by a rigid `(4, 4)`; its ids -> ids here. Once an `edit_id`."""
        request = mapper_pb2.JoinMapRequest(
            scene=scene,
            other_scene=other_scene,
            world_from_other=codec.matrix_numbers(world_from_other),
            edit_id=edit_id,
        )
        reply = await read(lambda: self._stub.JoinMap(request, timeout=SLOW_SECONDS))
        return codec.delta_value(reply.delta), dict(reply.ids)

    async def align(self, scene: str, other_scene: str, guess: F64 | None = None) -> Alignment:
        """The transform between two scenes that recorded one place. guess: a first `(4, 4)`, else from shapes alone."""
        numbers = [] if guess is None else codec.matrix_numbers(guess)
        request = mapper_pb2.AlignMapRequest(scene=scene, other_scene=other_scene, world_from_other=numbers)
        return codec.alignment_value(await read(lambda: self._stub.AlignMap(request, timeout=SLOW_SECONDS)))
