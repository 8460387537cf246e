"""What each step of perception costs a frame: name, ground, segment, embed, lift (SPEC 1)."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from lab.bench.rows import Row, spread
from lab.simulation import SimulatedRoom, onboard_detections
from ovip.clients import VlmClient, connect
from ovip.recordings import open_recording
from ovip.scene.types import Frame
from ovip.wire import decode_depth, decode_rgb
from services.perception.adapters.model_sets import open_models
from services.perception.config import Settings
from services.perception.detecting import Models
from services.perception.domain.boxes2d import ScoredBox
from services.perception.domain.lifting import LiftParams, lift_all, surface_cloud

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Look:
    """A frame; boxes: what to segment, embed and lift in it, None for what the grounder finds."""

    frame: Frame
    boxes: tuple[ScoredBox, ...] | None = None


async def measure_perception(
    frames: int = 12, recording: Path | None = None, layout: str = "ovip"
) -> list[Row]:
    """One row a step, over `frames` frames spread over a recording, or over the simulated robot's walk.

    In the simulated home the true boxes are segmented, embedded and lifted, because small detectors see
    little of what is rendered. The first frame warms up and does not count.
    """
    settings = Settings()
    gateway = connect(settings.vlm_gateway_address, settings.api_key)
    try:
        models = open_models(settings.model_copy(update={"enumerator": "detector"}), VlmClient(gateway))
        looks = _recorded(recording, layout, frames + 1) if recording else _rendered(frames + 1)
        return await _measure(models, LiftParams(min_confidence=settings.min_confidence), looks)
    finally:
        await gateway.close()


async def _measure(models: Models, params: LiftParams, looks: Iterator[Look]) -> list[Row]:
    times: dict[str, list[float]] = {}
    boxes_seen: list[int] = []
    for look in looks:
        boxes_seen.append(await _look(models, params, look, times))
    return [
        {
            "step": step,
            "models": models.name,
            "frames": len(samples) - 1,
            "boxes_a_frame": round(float(np.mean(boxes_seen[1:])), 1),
            **spread(samples[1:]),
        }
        for step, samples in times.items()
    ]


async def _look(models: Models, params: LiftParams, look: Look, times: dict[str, list[float]]) -> int:
    frame = look.frame
    words = await _timed(times, "enumerate", lambda: models.enumerator.enumerate(frame))
    found = await _timed(times, "ground", lambda: models.grounder.ground(frame, words))
    boxes = found if look.boxes is None else list(look.boxes)
    masks = await _timed(times, "segment", lambda: models.segmenter.segment(frame, [b.box for b in boxes]))
    await _timed(times, "embed", lambda: models.encoder.embed_crops(frame, boxes))
    began = time.perf_counter()
    lift_all(frame, masks, params)
    _note(times, "lift", began)
    began = time.perf_counter()
    surface_cloud(frame, params)
    _note(times, "surface", began)
    return len(boxes)


async def _timed(times: dict[str, list[float]], step: str, work: Callable[[], Awaitable[T]]) -> T:
    began = time.perf_counter()
    done = await work()
    _note(times, step, began)
    return done


def _note(times: dict[str, list[float]], step: str, began: float) -> None:
    times.setdefault(step, []).append((time.perf_counter() - began) * 1e3)


def _rendered(count: int) -> Iterator[Look]:
    room = SimulatedRoom()
    walk = room.walk()
    for number in _spread_over(len(walk), count):
        rgb, depth, ids = room.render(walk[number])
        seen = onboard_detections(room, ids)
        boxes = tuple(ScoredBox(d.label, d.score, d.box2) for d in seen)
        yield Look(Frame(f"bench.{number}", number, room.intrinsics, walk[number], rgb, depth), boxes)


def _recorded(path: Path, layout: str, count: int) -> Iterator[Look]:
    recording = open_recording(path, layout)
    wanted = set(_spread_over(len(recording), count))
    for number, frame in enumerate(recording):
        if number in wanted:
            rgb = decode_rgb(frame.rgb_bytes, recording.intrinsics)
            depth = decode_depth(frame.depth_bytes, "png16", frame.depth_scale, recording.intrinsics)
            pose = frame.world_from_camera
            yield Look(Frame(f"bench.{number}", frame.timestamp_ns, recording.intrinsics, pose, rgb, depth))


def _spread_over(length: int, count: int) -> Sequence[int]:
    return sorted({int(i) for i in np.linspace(0, length - 1, min(count, length)).round()})
