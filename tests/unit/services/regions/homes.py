"""A scene as regions meets it: batches in the detections log, deltas in the map log, and a map to ask for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ovip.codec import encode_detection_batch
from ovip.errors import NotConfigured, OvipError
from ovip.scene.answers import VlmReply
from ovip.scene.types import F32, Box2, DetectionBatch, Intrinsics, MapObject, SceneMap
from ovip.store import Append, Store
from services.regions.domain.assembly import PlacedObjects
from services.regions.ports import Grouping
from tests.unit.services.regions.rooms import plane, room, without

SCENE = "home"
CAMERA = Intrinsics(300.0, 300.0, 160.0, 120.0, 320, 240)


class Home:
    """Two rooms and what is in them; writes to the logs as perception and the mapper do."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self.objects: list[MapObject] = []
        self.version = 0
        self.asked = 0
        self.away: OvipError | None = None

    async def get_map(self, scene: str) -> SceneMap:
        assert scene == SCENE
        self.asked += 1
        if self.away is not None:
            raise self.away
        return SceneMap(scene, self.version, tuple(self.objects), "hash", 0, 0, "0-0")

    async def sees(
        self, frame: int, points: F32, camera: tuple[float, float, float], late: bool = False
    ) -> None:
        """A frame of perception."""
        pose = np.eye(4)
        pose[:3, 3] = camera
        surface = np.zeros((0, 3), np.float32) if late else points
        batch = DetectionBatch(f"f{frame}", frame, CAMERA, pose, (), surface, (), late)
        ref = await self._store.blobs.put(encode_detection_batch(batch))
        await self.logs(
            "detections", {"frame_id": f"f{frame}", "batch": ref, "kind": "late" if late else "frame"}
        )

    async def gains(self, label: str, x: float, y: float, z: float = 0.5) -> None:
        """An object of the mapper."""
        self.version += 1
        centre = np.array([x, y, z])
        self.objects.append(
            MapObject(
                object_id=f"o{len(self.objects)}",
                label=label,
                label_counts={label: 3},
                centroid=centre,
                box=np.concatenate([centre - 0.1, centre + 0.1]),
                feature=np.ones(4, np.float32) / 2,
                view_weight=1.0,
                observations=3,
                frames=3,
                first_seen_ns=0,
                last_seen_ns=0,
                voxels=9,
                mean_color=np.zeros(3),
                best_frame_id="f0",
                best_box2=Box2(0, 0, 1, 1),
                version=self.version,
            )
        )
        await self.logs("map", {"version": self.version, "frame_id": "f0", "delta": b"", "state_hash": ""})

    async def logs(self, stream: str, fields: dict[str, bytes | str | int]) -> None:
        """An entry of another stage's log, in a step of that stage."""
        stage = {"detections": "perception", "map": "mapper"}[stream]
        lease = await self._store.acquire_lease(SCENE, stage, "test", 60.0)
        assert lease is not None
        step = await self._store.length(SCENE, stream) + 1
        await self._store.commit(lease, f"{step}-0", [Append(stream, fields)])


def left_room() -> F32:
    """Its own four walls, with a doorway to the right."""
    door = ((4.0, 4.1), (1.6, 2.5), (-0.1, 2.0))
    return np.concatenate([without(room((0.025, 4.025), (0.025, 4.025)), *door), _sill()])


def right_room() -> F32:
    """Its own four walls, with a doorway to the left."""
    door = ((4.2, 4.3), (1.6, 2.5), (-0.1, 2.0))
    return np.concatenate([without(room((4.225, 8.225), (0.025, 4.025)), *door), _sill()])


def _sill() -> F32:
    return plane((4.025, 4.225), (1.6, 2.5), (0.0, 0.0))


class WordsAreFunctions:
    """A grouper for tests of everything else: an object's label is its function."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, ...]] = []

    async def group(self, objects: PlacedObjects) -> Grouping:
        self.asked.append(objects.labels)
        return Grouping(objects.labels, ("grouping: by the word",))


class ScriptedVlm:
    """Answers with what it was given, and keeps the questions."""

    def __init__(self, value: object = None, error: OvipError | None = None) -> None:
        self._value, self._error = value, error
        self.prompts: list[str] = []

    async def ask(
        self, purpose: str, prompt: str, *, schema: object = None, deadline_s: float = 0.0
    ) -> VlmReply:
        assert purpose == "group"
        assert schema
        self.prompts.append(prompt)
        if self._error:
            raise self._error
        return VlmReply(self._value)


class NoEncoder:
    """Perception is away."""

    async def embed_text(self, texts: Sequence[str]) -> F32:
        raise NotConfigured("no perception here")
