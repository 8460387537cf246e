"""What the api asks of the other services; the clients in `ovip.clients` are the real implementations."""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from ovip.scene.answers import (
    Answer,
    FrameRecord,
    GatewayStatus,
    PerceptionStatus,
    Query,
    SceneSummary,
    SearchEvent,
)
from ovip.scene.grid import FloorGrid
from ovip.scene.navigation import Route
from ovip.scene.route_graph import RouteGraph
from ovip.scene.types import F32, F64, U8, MapDelta, MapObject, Partition, SceneMap


class Frames(Protocol):
    """Perception: the frame history."""

    async def list_frames(
        self, scene: str, after: str = "", limit: int = 0
    ) -> tuple[list[FrameRecord], dict[str, F32]]: ...

    async def get_rgb(self, scene: str, frame_id: str) -> bytes: ...

    async def status(self, scene: str) -> PerceptionStatus: ...


class Objects(Protocol):
    """The mapper: the objects."""

    async def list_scenes(self) -> list[SceneSummary]: ...

    async def get_map(self, scene: str, include_unconfirmed: bool = False) -> SceneMap: ...

    async def get_object(self, scene: str, object_id: str) -> MapObject: ...

    async def get_points(
        self, scene: str, object_ids: Sequence[str] = (), max_points: int = 0
    ) -> dict[str, tuple[F32, U8]]: ...


class MapLog(Protocol):
    """The mapper again: its log, from a version on and then live."""

    def watch(self, scene: str, after_version: int) -> AsyncIterator[MapDelta]: ...


class Regions(Protocol):
    """Regions: the partition, each new one, and the grids of the floors."""

    async def get_partition(self, scene: str) -> Partition: ...

    async def get_floor_grid(self, scene: str, floor: int) -> FloorGrid: ...

    async def plan_route(self, scene: str, start: F64, goal: F64, robot_radius: float = 0.0) -> Route: ...

    async def get_route_graph(self, scene: str, robot_radius: float = 0.0) -> RouteGraph: ...

    def watch(self, scene: str, after_revision: int = 0) -> AsyncIterator[Partition]: ...


class Searches(Protocol):
    """Retrieval: questions and their answers."""

    def find(self, query: Query) -> AsyncIterator[tuple[str, SearchEvent]]: ...

    async def get_search(self, scene: str, search_id: str) -> tuple[str, bool, Answer | None]: ...


class Gateway(Protocol):
    """The VLM gateway: whether one is configured, and what it has done."""

    async def status(self) -> GatewayStatus: ...


class Readiness(Protocol):
    """Which of the other services can be reached now."""

    async def reachable(self) -> Mapping[str, bool]: ...


@dataclass(frozen=True, slots=True)
class Backends:
    """Everyone the api asks."""

    frames: Frames
    objects: Objects
    map_log: MapLog
    regions: Regions
    searches: Searches
    gateway: Gateway
    readiness: Readiness
