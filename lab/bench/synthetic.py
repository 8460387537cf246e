"""A made-up scene of any number of objects, as the services that retrieval asks would give it."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.errors import NotConfigured
from ovip.scene.answers import FrameRecord, PerceptionStatus, VlmReply
from ovip.scene.features import normalize
from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.types import F32, F64, Box2, Detection, Floor, MapObject, Partition, SceneMap

SCENE = "synthetic"
SIDE = 12.0  # metres of the square floor
_RESOLUTION = 0.05
_BLOCKS = 30  # pieces of furniture on the grid, whatever the number of objects

Embed = Callable[[Sequence[str]], Awaitable[F32]]


def synthetic_map(labels: Sequence[str], features: F32, seed: int = 0) -> SceneMap:
    """One object a label, somewhere on the floor. features: `(N, D)` of the labels; noise is added to each."""
    rng = np.random.default_rng(seed)
    noisy = normalize(
        features + rng.normal(0, 0.3 / np.sqrt(features.shape[1]), features.shape).astype(np.float32)
    )
    low = np.column_stack([rng.uniform(0, SIDE - 0.5, (len(labels), 2)), rng.uniform(0, 1.5, len(labels))])
    high = low + rng.uniform(0.05, 0.5, low.shape)
    things = tuple(
        _object(number, label, np.concatenate([low[number], high[number]]), noisy[number])
        for number, label in enumerate(labels)
    )
    return SceneMap(SCENE, 1, things, "", len(things), 5 * len(things), "1-0")


def synthetic_floor(seed: int = 0) -> FloorGrid:
    """A square floor with walls around it and blocks on it."""
    rng = np.random.default_rng(seed)
    cells = round(SIDE / _RESOLUTION)
    occupancy = np.full((cells, cells), FREE, np.uint8)
    occupancy[[0, -1]] = occupancy[:, [0, -1]] = OCCUPIED
    for row, column, height, width in rng.integers([0, 0, 4, 4], [cells, cells, 20, 20], (_BLOCKS, 4)):
        occupancy[row : row + height, column : column + width] = OCCUPIED
    return FloorGrid(0, (0.0, 0.0), _RESOLUTION, occupancy, np.zeros_like(occupancy, np.uint16))


@dataclass(frozen=True, slots=True)
class SyntheticScene:
    """Stands for mapper, perception and regions of one scene, in this process. It has no frames."""

    scene_map: SceneMap
    floor: FloorGrid
    embed: Embed

    async def scenes(self) -> list[str]:
        return [SCENE]

    async def get_map(self, scene: str, include_unconfirmed: bool = False) -> SceneMap:
        return self.scene_map

    async def get_partition(self, scene: str) -> Partition:
        return Partition(1, 1, floors=(Floor(0, 0.0, None, SIDE**2),))

    async def get_floor_grid(self, scene: str, floor: int) -> FloorGrid:
        return self.floor

    async def status(self, scene: str) -> PerceptionStatus:
        frames = self.scene_map.frames
        return PerceptionStatus(frames, frames, 0, (), np.eye(4), "synthetic", "synthetic")

    async def list_frames(
        self, scene: str, after: str = "", limit: int = 0
    ) -> tuple[list[FrameRecord], dict[str, F32]]:
        return [], {}

    async def get_frame_record(self, scene: str, frame_id: str) -> FrameRecord:
        raise NotConfigured("a synthetic scene has no frames")

    async def get_rgb(self, scene: str, frame_id: str) -> bytes:
        raise NotConfigured("a synthetic scene has no frames")

    async def ground(
        self, scene: str, frame_ids: Sequence[str], words: Sequence[str]
    ) -> tuple[dict[str, tuple[Detection, ...]], tuple[str, ...]]:
        return {}, tuple(words)

    async def embed_text(self, texts: Sequence[str]) -> F32:
        return await self.embed(texts)


class NoVlm:
    """What the gateway says without an upstream."""

    async def ask(self, purpose: str, prompt: str, *_: object, **__: object) -> VlmReply:
        raise NotConfigured("no VLM")


def _object(number: int, label: str, box: F64, feature: F32) -> MapObject:
    return MapObject(
        object_id=f"o{number:06d}",
        label=label,
        label_counts={label: 5},
        centroid=(box[:3] + box[3:]) / 2,
        box=box,
        feature=feature,
        view_weight=1.0,
        observations=5,
        frames=5,
        first_seen_ns=1,
        last_seen_ns=2,
        voxels=100,
        mean_color=np.full(3, 128.0),
        best_frame_id="f",
        best_box2=Box2(0, 0, 10, 10),
        version=1,
    )
