"""A robot in the simulated home: it streams its walk, and answers the viewpoints of an active search."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from lab.simulation.camera import pose_looking
from lab.simulation.room import EYE_HEIGHT, PITCH, SimulatedRoom
from lab.simulation.writing import recorded_frames
from ovip.client import AsyncClient, Hello, StreamReport
from ovip.client.replaying import outgoing
from ovip.client.streaming import StreamEvent
from ovip.errors import InvalidInput
from ovip.scene.answers import Observation, Viewpoint
from ovip.scene.types import F64

_STEP = 0.05  # metres between places where a way is checked


class SimulatedRobot:
    """Speaks to a real stack, over gRPC like any robot, and sends what it detects on board with each frame.

    radius: metres that it keeps from everything. pose: `(4, 4)` of its camera; it starts where its walk ends.
    travelled: metres driven to viewpoints.
    """

    def __init__(
        self, room: SimulatedRoom, client: AsyncClient, scene: str, robot_id: str = "sim", radius: float = 0.2
    ) -> None:
        self._room = room
        self._client = client
        self._scene = scene
        self._robot_id = robot_id
        self._walk = room.walk()
        self._radius = radius
        self._next: int | None = None
        self.pose: F64 = self._walk[-1]
        self.travelled = 0.0

    @property
    def walk_length(self) -> int:
        """Frames of the walk."""
        return len(self._walk)

    async def walk(self, on_event: Callable[[StreamEvent], None] | None = None) -> StreamReport:
        """Streams its round through the home; what is durable already is not sent again."""
        frames = outgoing(recorded_frames(self._room, self._walk))
        report = await self._client.stream(self._hello("walk"), frames, on_event=on_event)
        self.pose = self._walk[-1]
        return report

    async def look(self, viewpoint: Viewpoint) -> Observation:
        """Drives to the viewpoint and sends what it sees there; unreachable where something is in the way.

        Returns once the frame is durable. InvalidInput where perception rejects it.
        """
        way = self._way_to(viewpoint)
        if not self._is_clear(way):
            return Observation(viewpoint.viewpoint_id, unreachable=True)
        self.travelled += float(np.hypot(*np.diff(way, axis=0).T).sum())
        self.pose = pose_looking((way[-1][0], way[-1][1], EYE_HEIGHT), viewpoint.yaw, PITCH)
        return Observation(viewpoint.viewpoint_id, await self._send())

    async def _send(self) -> str:
        """The frame id of what is seen from where it stands, durable."""
        hello = self._hello("search")
        if self._next is None:  # where an earlier run of this robot stopped
            known = (await self._client.stream(hello, [])).resumed_after
            self._next = max(known, len(self._walk))
        frames = outgoing(recorded_frames(self._room, [self.pose], first=self._next))
        report = await self._client.stream(hello, frames)
        if report.rejected:
            raise InvalidInput(f"the robot's frame was rejected: {report.rejected[0].reason}")
        self._next += 1
        return report.last_frame_id

    def _hello(self, purpose: str) -> Hello:
        session = f"{purpose}-{self._room.seed}"
        return Hello(self._scene, self._robot_id, session, self._room.intrinsics)

    def _way_to(self, viewpoint: Viewpoint) -> F64:
        """Floor points `(N, 2)`: from where it stands, along the given path, straight where there is none."""
        along = (point[:2] for point in viewpoint.path)
        return np.array([self.pose[:2, 3], *along, viewpoint.position[:2]], dtype=np.float64)

    def _is_clear(self, way: F64) -> bool:
        return all(self._room.is_free(p, self._radius) for a, b in pairwise(way) for p in _between(a, b))


def _between(a: F64, b: F64) -> F64:
    """Points `(N, 2)` from `a` to `b`, both included, close enough to check."""
    count = int(np.ceil(np.hypot(*(b - a)) / _STEP)) + 1
    return np.linspace(a, b, count)
