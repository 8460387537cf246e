"""Builders for retrieval's tests: objects, grids, detections, and in-memory stand-ins for other services."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from typing import Any

import cv2
import numpy as np

from ovip.errors import InvalidInput, NotConfigured, NotFound
from ovip.scene.answers import FrameRecord, PerceptionStatus, VlmReply
from ovip.scene.building import Building
from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.types import (
    F32,
    F64,
    Box2,
    Detection,
    Floor,
    Intrinsics,
    MapObject,
    Partition,
    Region,
    SceneMap,
)

MOST_WORDS = 32  # that perception grounds at once
CAMERA = Intrinsics(fx=300.0, fy=300.0, cx=159.5, cy=119.5, width=320, height=240)
WHITE, DARK, RED, BROWN, GREY = (220, 218, 214), (60, 52, 45), (178, 34, 34), (110, 73, 57), (120, 119, 117)


def box_at(x: float, y: float, z: float, side: float = 0.1) -> F64:
    """A cube `(6,)` around a point."""
    half = side / 2
    return np.array([x - half, y - half, z - half, x + half, y + half, z + half])


def mapped(
    object_id: str,
    label: str,
    box: F64,
    color: tuple[int, int, int] = GREY,
    frames: int = 10,
    feature: F32 | None = None,
    best_frame_id: str = "f000",
) -> MapObject:
    """A map object with a box `(6,)`."""
    return MapObject(
        object_id=object_id,
        label=label,
        label_counts={label: frames},
        centroid=(box[:3] + box[3:]) / 2,
        box=box,
        feature=np.zeros(4, np.float32) if feature is None else feature,
        view_weight=1.0,
        observations=frames,
        frames=frames,
        first_seen_ns=0,
        last_seen_ns=1,
        voxels=100,
        mean_color=np.array(color, dtype=np.float64),
        best_frame_id=best_frame_id,
        best_box2=Box2(10, 10, 60, 60),
        version=1,
    )


def detection(
    label: str,
    x: float,
    y: float,
    z: float,
    score: float = 0.8,
    color: tuple[int, int, int] = GREY,
    feature: F32 | None = None,
) -> Detection:
    """A small thing detected at a place: 27 points in a cube of 4 cm."""
    spread = np.array([-0.02, 0.0, 0.02])
    offsets = np.stack(np.meshgrid(spread, spread, spread), axis=-1).reshape(-1, 3)
    points = (np.array([x, y, z]) + offsets).astype(np.float32)
    return Detection(
        detection_id=f"{label}-{x:.2f}-{y:.2f}",
        label=label,
        score=score,
        box2=Box2(10, 10, 60, 60),
        box=box_at(x, y, z, 0.04),
        feature=np.zeros(4, np.float32) if feature is None else feature,
        points=points,
        colors=np.tile(np.array(color, np.uint8), (len(points), 1)),
    )


def grid_of(drawing: str, resolution: float = 0.5, regions: Mapping[str, str] | None = None) -> FloorGrid:
    """A grid from a drawing, first line the highest row: `#` occupied, `?` unknown, else free.

    regions: region id by letter; free cells drawn as that letter belong to it.
    """
    rows = [line.strip() for line in drawing.strip().splitlines()][::-1]
    regions = regions or {}
    ids = tuple(dict.fromkeys(regions.values()))
    occupancy = np.array(
        [[OCCUPIED if c == "#" else UNKNOWN if c == "?" else FREE for c in row] for row in rows], np.uint8
    )
    labels = np.array(
        [[1 + ids.index(regions[c]) if c in regions else 0 for c in row] for row in rows], np.uint16
    )
    return FloorGrid(0, (0.0, 0.0), resolution, occupancy, labels, ids, 1)


def region(
    region_id: str,
    function: str,
    centroid: tuple[float, float] = (0.0, 0.0),
    object_ids: Sequence[str] = (),
    frame_ids: Sequence[str] = (),
    area: float = 4.0,
    floor: int = 0,
) -> Region:
    """A region without outlines."""
    return Region(
        region_id=region_id,
        floor=floor,
        function=function,
        display_name=function,
        area=area,
        centroid=np.array([*centroid, 0.0]),
        outlines=(),
        holes=(),
        object_ids=tuple(object_ids),
        frame_ids=tuple(frame_ids),
    )


def partition(*regions: Region) -> Partition:
    """One floor at height 0 with these regions."""
    return Partition(map_version=7, revision=3, floors=(Floor(0, 0.0, 2.5, 20.0),), regions=regions)


def standing_in(grid: FloorGrid, radius: float = 0.25, z: float = 0.0) -> Building:
    """A building of one storey at height `z`, for a robot of `radius` metres."""
    return Building(Partition(0, 0, (Floor(grid.floor, z, None, 1.0),)), {grid.floor: grid}, radius)


def pose_at(x: float, y: float, yaw: float, z: float = 1.2) -> F64:
    """A level camera at a place, looking along `yaw`."""
    forward = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    down = np.array([0.0, 0.0, -1.0])
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = np.cross(down, forward), down, forward, (x, y, z)
    return pose


def frame(frame_id: str, pose: F64 | None = None, tags: Sequence[str] = ()) -> FrameRecord:
    """A frame of the history."""
    pose = pose_at(0.0, 0.0, 0.0) if pose is None else pose
    return FrameRecord(frame_id, 1, pose, CAMERA, tuple(tags), True, f"{int(frame_id[1:]) + 1}-0")


def jpeg() -> bytes:
    """A small grey picture."""
    return bytes(cv2.imencode(".jpg", np.full((240, 320, 3), 128, np.uint8))[1].tobytes())


class World:
    """Mapper, perception and regions of one scene in memory: what retrieval asks of other services."""

    def __init__(
        self,
        objects: Sequence[MapObject] = (),
        regions: Partition | None = None,
        grids: Mapping[int, FloorGrid] | None = None,
        frames: Sequence[FrameRecord] = (),
        seen: Mapping[str, Sequence[Detection]] | None = None,
        groundable: Callable[[str], bool] = lambda _: True,
        features: Mapping[str, F32] | None = None,
        space: str = "",
    ) -> None:
        self.objects = tuple(objects)
        self.partition = regions or Partition(0, 0)
        self.grids = dict(grids or {})
        self.history = list(frames)
        self.seen = {key: tuple(value) for key, value in (seen or {}).items()}
        self.groundable = groundable
        self.features = dict(features or {})
        self.space = space
        self.grounded: list[str] = []
        self.listed: list[str] = []
        self.onboard = False

    async def get_map(self, scene: str, include_unconfirmed: bool = False) -> SceneMap:
        if not self.objects and not self.history:
            raise NotFound(f"scene {scene!r}: nothing mapped yet")
        return SceneMap(scene, 7, self.objects, "hash", len(self.history), 0, "1-0")

    async def get_partition(self, scene: str) -> Partition:
        return self.partition

    async def get_floor_grid(self, scene: str, floor: int) -> FloorGrid:
        if floor not in self.grids:
            raise NotFound(f"floor {floor}: no grid")
        return self.grids[floor]

    async def list_frames(
        self, scene: str, after: str = "", limit: int = 0
    ) -> tuple[list[FrameRecord], dict[str, F32]]:
        self.listed.append(after)
        start = next((k + 1 for k, record in enumerate(self.history) if record.log_id == after), 0)
        return self.history[start : start + 100], {}

    async def get_frame_record(self, scene: str, frame_id: str) -> FrameRecord:
        for record in self.history:
            if record.frame_id == frame_id:
                return record
        raise NotFound(f"frame {frame_id!r}: there is no such frame")

    async def get_rgb(self, scene: str, frame_id: str) -> bytes:
        await self.get_frame_record(scene, frame_id)
        return jpeg()

    async def status(self, scene: str) -> PerceptionStatus:
        return PerceptionStatus(1, 1, 0, (), np.eye(4), "embedded", self.space)

    async def ground(
        self, scene: str, frame_ids: Sequence[str], words: Sequence[str]
    ) -> tuple[dict[str, tuple[Detection, ...]], tuple[str, ...]]:
        if len(words) > MOST_WORDS:
            raise InvalidInput(f"words: expected at most {MOST_WORDS}, got {len(words)}")
        labels = {d.label for f in frame_ids for d in self.seen.get(f, ())} if self.onboard else set()
        blind = tuple(word for word in words if not self.groundable(word) and word not in labels)
        for frame_id in frame_ids:
            await self.get_frame_record(scene, frame_id)
        self.grounded.extend(frame_ids)
        can_see = set(words) - set(blind)
        found = {f: tuple(d for d in self.seen.get(f, ()) if d.label in can_see) for f in frame_ids}
        return found, blind

    async def embed_text(self, texts: Sequence[str]) -> F32:
        return np.stack([self.features.get(text, _arbitrary(text)) for text in texts])


class NoVlm:
    """A gateway without an upstream."""

    async def ask(
        self,
        purpose: str,
        prompt: str,
        images: Sequence[bytes] = (),
        schema: dict[str, Any] | None = None,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
    ) -> VlmReply:
        raise NotConfigured("set OVIP_VLM_UPSTREAMS")


class ScriptedVlm:
    """A gateway whose upstream answers by a function of (prompt, number of images)."""

    def __init__(self, answer: Callable[[str, int], object]) -> None:
        self._answer = answer
        self.asked: list[str] = []

    async def ask(
        self,
        purpose: str,
        prompt: str,
        images: Sequence[bytes] = (),
        schema: dict[str, Any] | None = None,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
    ) -> VlmReply:
        self.asked.append(prompt)
        return VlmReply(self._answer(prompt, len(images)))


async def messages(*items: Any) -> AsyncIterator[Any]:
    """An asynchronous stream of these."""
    for item in items:
        yield item


def _arbitrary(text: str) -> F32:
    vector = np.random.default_rng(sum(text.encode())).normal(size=4).astype(np.float32)
    return np.asarray(vector / np.linalg.norm(vector), np.float32)
