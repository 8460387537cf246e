"""A robot in a simulated world: it streams its walk, and answers the viewpoints of an active search."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from lab.simulation.camera import EYE_HEIGHT, PITCH, pose_looking
from lab.simulation.world import World
from lab.simulation.writing import recorded_frames
from ovip.client import AsyncClient, Hello, StreamReport
from ovip.client.replaying import outgoing
from ovip.client.streaming import StreamEvent
from ovip.errors import InvalidInput
from ovip.scene.answers import Observation, Viewpoint
from ovip.scene.types import F64

GRID_MARGIN = 0.036
"""Metres: half the diagonal of a 5 cm cell. Where cells' middles are clear of things by a radius, a way between them
may pass that much nearer, so a robot plans with that much more than its body."""


class SimulatedRobot:
    """Speaks to a real stack, over gRPC like any robot, and sends what it detects on board with each frame.

    radius: metres that are planned for it; its body is `GRID_MARGIN` less. walk: the poses of its round, the
    world's own where None. pose: `(4, 4)` of its camera; it starts where its walk ends. travelled: metres driven
    to viewpoints.
    """

    def __init__(
        self,
        world: World,
        client: AsyncClient,
        scene: str,
        robot_id: str = "sim",
        radius: float = 0.2,
        walk: Sequence[F64] | None = None,
    ) -> None:
        self._world = world
        self._client = client
        self._scene = scene
        self._robot_id = robot_id
        self._walk = world.walk() if walk is None else list(walk)
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
        frames = outgoing(recorded_frames(self._world, self._walk))
        report = await self._client.stream(self._hello("walk"), frames, on_event=on_event)
        self.pose = self._walk[-1]
        return report

    async def look(self, viewpoint: Viewpoint) -> Observation:
        """Drives to the viewpoint and sends what it sees there; unreachable where something is in the way.

        Returns once the frame is durable. InvalidInput where perception rejects it.
        """
        way = self._world.way(self._place(), _places(viewpoint), self._radius - GRID_MARGIN)
        if way is None:
            return Observation(viewpoint.viewpoint_id, unreachable=True)
        self.travelled += float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
        x, y, z = way[-1]
        self.pose = pose_looking((x, y, z + EYE_HEIGHT), viewpoint.yaw, PITCH)
        return Observation(viewpoint.viewpoint_id, await self._send())

    async def _send(self) -> str:
        """The frame id of what is seen from where it stands, durable."""
        hello = self._hello("search")
        if self._next is None:  # where an earlier run of this robot stopped
            known = (await self._client.stream(hello, [])).resumed_after
            self._next = max(known, len(self._walk))
        frames = outgoing(recorded_frames(self._world, [self.pose], first=self._next))
        report = await self._client.stream(hello, frames)
        if report.rejected:
            raise InvalidInput(f"the robot's frame was rejected: {report.rejected[0].reason}")
        self._next += 1
        return report.last_frame_id

    def _hello(self, purpose: str) -> Hello:
        session = f"{purpose}-{self._world.seed}"
        return Hello(self._scene, self._robot_id, session, self._world.intrinsics)

    def _place(self) -> F64:
        return np.asarray(self.pose[:3, 3] - [0.0, 0.0, EYE_HEIGHT])


def _places(viewpoint: Viewpoint) -> F64:
    """Floor points `(N, 3)`: along the given path to the viewpoint; straight there where it has none."""
    return np.array([*viewpoint.path, viewpoint.position], dtype=np.float64).reshape(-1, 3)
