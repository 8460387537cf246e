"""How many frames a second become durable, and how long an ack takes (DESIGN 7: 16 robots, 300 kB)."""

from __future__ import annotations

import asyncio
import tempfile
import time
from collections.abc import AsyncIterator, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from lab.bench.rows import Row, spread
from ovip.client import Addresses, AsyncClient, Hello, OutgoingFrame
from ovip.client.streaming import StreamEvent
from ovip.scene.types import U8, U16, Intrinsics
from ovip.wire import encode_depth
from services.standalone.process import read_ready, start_stack, stop_stack

BUDGET_FPS = 250.0
_CAMERA = Intrinsics(585.0, 585.0, 319.5, 239.5, 640, 480)
_SECOND = 10**9


@dataclass(frozen=True, slots=True)
class Pictures:
    """An encoded frame."""

    rgb: bytes
    depth: bytes

    @property
    def kilobytes(self) -> float:
        return (len(self.rgb) + len(self.depth)) / 1000


async def measure_ingest(
    robots: int = 16, kilobytes: int = 300, seconds: float = 6.0, rate: float = BUDGET_FPS
) -> list[Row]:
    """Robots stream for `seconds` each: as fast as credits let them, then `rate` frames a second together.

    An ack is counted from handing the frame to the SDK until it is durable, waiting for credits included.
    Every frame's bytes are its own, for a blob that is there already costs nothing.
    """
    paces = (("as fast as it goes", None), (f"{rate:g} a second", rate / robots))
    with tempfile.TemporaryDirectory() as folder:
        process = start_stack(Path(folder), free_ports=True, module="lab.bench.intake")
        try:
            address = str(read_ready(process)["address"])
            return [
                {"pace": pace, **await _measure(address, f"bench{number}", robots, kilobytes, seconds, each)}
                for number, (pace, each) in enumerate(paces)
            ]
        finally:
            stop_stack(process)


async def _measure(
    address: str, scene: str, robots: int, kilobytes: int, seconds: float, rate: float | None
) -> Row:
    each = int(np.ceil(seconds * (rate or BUDGET_FPS / robots))) + 1
    pictures = await asyncio.to_thread(make_pictures, robots * each, kilobytes)
    async with AsyncClient(Addresses(perception=address)) as client:
        streams = [
            _Robot(scene, f"r{number:02d}", pictures[number * each : (number + 1) * each], rate)
            for number in range(robots)
        ]
        began = time.perf_counter()
        await asyncio.gather(*(robot.stream(client) for robot in streams))
        took = time.perf_counter() - began
    acks = [ms for robot in streams for ms in robot.acks_ms]
    return {
        "robots": robots,
        "frame_kb": round(float(np.mean([p.kilobytes for p in pictures]))),
        "frames": len(acks),
        "frames_a_second": round(len(acks) / took, 1),
        **spread(acks, "ack"),
    }


class _Robot:
    """Streams its pictures, all at once or `rate` a second, and notes how long each took to be durable."""

    def __init__(self, scene: str, robot_id: str, pictures: Sequence[Pictures], rate: float | None) -> None:
        self._hello = Hello(scene, robot_id, "s", _CAMERA)
        self._pictures = pictures
        self._rate = rate
        self._given: dict[int, float] = {}
        self.acks_ms: list[float] = []

    async def stream(self, client: AsyncClient) -> None:
        await client.stream(self._hello, self._frames(), on_event=self._note)

    async def _frames(self) -> AsyncIterator[OutgoingFrame]:
        began = time.perf_counter()
        for sequence, picture in enumerate(self._pictures, start=1):
            if self._rate:
                await asyncio.sleep(max(0.0, began + (sequence - 1) / self._rate - time.perf_counter()))
            self._given[sequence] = time.perf_counter()
            yield OutgoingFrame(
                sequence, sequence * _SECOND, np.eye(4), picture.rgb, picture.depth, 1000.0, "shuffle_zstd"
            )

    def _note(self, event: StreamEvent) -> None:
        if event.status == "durable":
            self.acks_ms.append((time.perf_counter() - self._given.pop(event.sequence)) * 1e3)


def make_pictures(count: int, kilobytes: int) -> list[Pictures]:
    """`count` different VGA frames of about `kilobytes` each: noise shifted about, JPEG and packed depth."""
    rng = np.random.default_rng(0)
    rgb, depth = _noisy_scene(rng)
    quality = _quality_for(rgb, kilobytes * 1000 - len(encode_depth(depth)))
    shifts = rng.permutation(_CAMERA.width * _CAMERA.height)[:count]
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(lambda shift: _pictures(rgb, depth, quality, int(shift)), shifts))


def _noisy_scene(rng: np.random.Generator) -> tuple[U8, U16]:
    """A ramp of colours and one of depths, both as noisy as a small sensor's."""
    v, u = np.mgrid[: _CAMERA.height, : _CAMERA.width]
    smooth = np.stack([u * 0.3 + 20, v * 0.4 + 20, (u + v) * 0.2 + 10], axis=2)
    rgb = np.clip(smooth + rng.normal(0, 12, smooth.shape), 0, 255).astype(np.uint8)
    depth = (1500 + 2 * v + rng.normal(0, 2, v.shape)).astype(np.uint16)
    return rgb, depth


def _quality_for(rgb: U8, size: int) -> int:
    """The JPEG quality whose bytes come nearest to `size`."""
    return min(_qualities(), key=lambda quality: abs(len(_jpeg(rgb, quality)) - size))


def _qualities() -> Iterator[int]:
    yield from range(20, 101, 4)


def _pictures(rgb: U8, depth: U16, quality: int, shift: int) -> Pictures:
    by = (shift // _CAMERA.width, shift % _CAMERA.width)
    return Pictures(_jpeg(np.roll(rgb, by, (0, 1)), quality), encode_depth(np.roll(depth, by, (0, 1))))


def _jpeg(rgb: U8, quality: int) -> bytes:
    return cv2.imencode(".jpg", rgb, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
