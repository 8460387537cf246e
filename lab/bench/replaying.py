"""Frames a second from a robot's hand to the map: a recording with detections given, through the whole stack."""

from __future__ import annotations

import dataclasses
import os
import tempfile
import time
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from lab.bench.replaying_masks import PieceParams, with_pieces
from lab.bench.rows import Row
from ovip.client import Addresses, AsyncClient, Hello, OutgoingFrame
from ovip.client.replaying import hello_of, outgoing
from ovip.recordings import Recording, open_recording
from services.standalone.process import read_ready, start_stack, stop_stack

TOUR = Path(__file__).resolve().parents[1] / "data" / "home_tour"
DETECTIONS = (4, 20)  # a frame: as many as small models find in a kitchen, and a full house
_WARM_UP = 24  # frames of a scene of its own, streamed first


@dataclass(frozen=True, slots=True, eq=False)
class Robot:
    """What a robot will send: frames with detections of its own, all made."""

    hello: Hello
    frames: tuple[OutgoingFrame, ...]

    def into(self, scene: str, frames: int | None = None) -> Robot:
        """The same robot in another scene, with its first `frames` frames only."""
        return Robot(dataclasses.replace(self.hello, scene=scene), self.frames[:frames])

    @property
    def detections_a_frame(self) -> float:
        return sum(len(frame.detections or ()) for frame in self.frames) / len(self.frames)

    @property
    def kilobytes_a_frame(self) -> float:
        return sum(len(frame.rgb) + len(frame.depth) for frame in self.frames) / len(self.frames) / 1000


async def measure_replay(
    recording: Path = TOUR,
    layout: str = "ovip",
    frames: int | None = None,
    detections: Sequence[int] = DETECTIONS,
) -> list[Row]:
    """A row for each number of detections a frame: from the first frame sent until the last one is in the map.

    The stack is the one that `ovip up` runs, in a process of its own on an empty store; the robot is in this one, and
    what it sends is made before. A recording that holds a robot's own detections is sent with those, once.
    stack_cpu_ms: processor time a frame of all services and the store; the robot's is not in it.
    """
    opened = open_recording(recording, layout)
    robots = [robot_of(opened, most, frames) for most in ((0,) if _detects(opened) else detections)]
    with tempfile.TemporaryDirectory() as folder:
        process = start_stack(Path(folder), free_ports=True)
        try:
            async with AsyncClient(Addresses.of_stack(read_ready(process))) as client:
                await _seconds(client, robots[0].into("warm-up", _WARM_UP))
                return [
                    await _measure(client, process.pid, robot.into(f"replay{number}"), opened.name)
                    for number, robot in enumerate(robots)
                ]
        finally:
            stop_stack(process)


def robot_of(recording: Recording, most: int, frames: int | None = None) -> Robot:
    """A robot that sends the first `frames` of a recording with its own detections, or `most` pieces a frame."""
    recorded = islice(recording, frames)
    if not _detects(recording):
        recorded = islice(with_pieces(recording, recording.intrinsics, most, PieceParams()), frames)
    return Robot(hello_of(recording, "bench", "bench"), tuple(outgoing(recorded)))


def _detects(recording: Recording) -> bool:
    return next(iter(recording)).onboard is not None


async def _measure(client: AsyncClient, stack: int, robot: Robot, name: str) -> Row:
    before = _cpu_seconds(stack)
    durable_s, mapped_s = await _seconds(client, robot)
    cpu_s = _cpu_seconds(stack) - before
    made = await client.get_map(robot.hello.scene)
    return {
        "recording": name,
        "frames": len(robot.frames),
        "frame_kb": round(robot.kilobytes_a_frame),
        "detections": round(robot.detections_a_frame, 1),
        "frames_per_second": round(len(robot.frames) / mapped_s, 1),
        "durable_per_second": round(len(robot.frames) / durable_s, 1),
        "lag_s": round(mapped_s - durable_s, 2),
        "stack_cpu_ms": round(1e3 * cpu_s / len(robot.frames), 1),
        "mapped": made.detections,
        "objects": len(made.objects),
        "cores": os.cpu_count() or 1,
        "load": round(os.getloadavg()[0], 1),
    }


async def _seconds(client: AsyncClient, robot: Robot) -> tuple[float, float]:
    """Seconds from the first frame on until all are durable, and until all are in the map."""
    began = time.perf_counter()
    report = await client.stream(robot.hello, robot.frames)
    durable = time.perf_counter()
    waiting = report.durable
    async for frame_id in _mapped(client, robot.hello.scene):
        waiting -= bool(frame_id)
        if not waiting:
            break
    return durable - began, time.perf_counter() - began


async def _mapped(client: AsyncClient, scene: str) -> AsyncIterator[str]:
    """Ids of the frames in the map, as they come; empty for a version that no frame made."""
    async for delta in client.mapper.watch(scene, 0):
        yield delta.frame_id


def _cpu_seconds(pid: int) -> float:
    """Processor time of a process and of what it started, its store (Linux)."""
    user, system = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    lists = Path(f"/proc/{pid}/task").glob("*/children")
    children = [int(child) for path in lists for child in path.read_text().split()]
    ticks = int(user) + int(system)
    return ticks / os.sysconf("SC_CLK_TCK") + sum(_cpu_seconds(child) for child in children)
