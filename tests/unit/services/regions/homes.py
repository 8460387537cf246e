"""A scene as regions meets it: batches in the detections log, deltas in the map log, and a map to ask for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ovip.codec import encode_delta, encode_detection_batch
from ovip.errors import NotConfigured, OvipError
from ovip.scene.answers import VlmReply
from ovip.scene.types import F32, Box2, DetectionBatch, Intrinsics, MapDelta, MapObject, SceneMap
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
        name = f"o{len(self.objects)}"
        self.objects.append(mapped(name, label, x, y, z))
        await self.tells(created=(name,))

    async def loses(self, object_id: str) -> None:
        """The mapper gives an object up."""
        self.objects = [o for o in self.objects if o.object_id != object_id]
        await self.tells(removed=(object_id,))

    async def moves(self, object_id: str, x: float, y: float, label: str = "") -> None:
        """The mapper finds an object elsewhere, or another name for it."""
        self.objects = [
            replace(o, centroid=np.array([x, y, 0.5]), label=label or o.label)
            if o.object_id == object_id
            else o
            for o in self.objects
        ]
        await self.tells(updated=(object_id,))

    async def tells(self, **changed: tuple[str, ...]) -> None:
        """The next version of the map, with what it changed."""
        self.version += 1
        delta = encode_delta(MapDelta(self.version, "f0", **changed))  # type: ignore[arg-type]
        await self.logs("map", {"version": self.version, "frame_id": "f0", "kind": "frame", "delta": delta})

    async def logs(self, stream: str, fields: dict[str, bytes | str | int]) -> None:
        """An entry of another stage's log, in a step of that stage."""
        stage = {"detections": "perception", "map": "mapper"}[stream]
        lease = await self._store.acquire_lease(SCENE, stage, "test", 60.0)
        assert lease is not None
        step = await self._store.length(SCENE, stream) + 1
        await self._store.commit(lease, f"{step}-0", [Append(stream, fields)])


def mapped(name: str, label: str, x: float, y: float, z: float = 0.5) -> MapObject:
    """An object as the mapper has it."""
    centre = np.array([x, y, z])
    return MapObject(
        object_id=name,
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
        version=1,
    )


class PlainMap:
    """A map that is what it is told to be."""

    def __init__(self, *objects: MapObject) -> None:
        self.objects = objects
        self.version = 1
        self.asked = 0

    async def get_map(self, scene: str) -> SceneMap:
        self.asked += 1
        return SceneMap(scene, self.version, self.objects, "hash", 0, 0, "0-0")


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
        self,
        purpose: str,
        prompt: str,
        *,
        schema: object = None,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
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
