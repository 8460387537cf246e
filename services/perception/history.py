"""The frame history: how a frame lies in the log and the blobs, and how it is read back."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass

import numpy as np

from ovip.errors import NotFound
from ovip.scene.answers import FrameRecord
from ovip.scene.types import F32, F64, U8, Frame, Intrinsics
from ovip.store import Entry, Store
from ovip.wire import decode_depth, decode_rgb

STAGE = "perception"
FRAMES, DETECTIONS = "frames", "detections"
_MOST_FRESH_BYTES = 64 * 2**20  # some 30 frames of 640 x 480
_FRESH_FOR = 512  # frames; more than a scene's backlog
_Key = tuple[str, str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Images:
    """A frame's images, decoded: rgb `(H, W, 3)`; depth `(H, W)` metres, 0 = no measurement."""

    rgb: U8
    depth: F32

    @property
    def nbytes(self) -> int:
        return self.rgb.nbytes + self.depth.nbytes


@dataclass(frozen=True, slots=True)
class Upload:
    """A frame as a robot sent it: encoded images. onboard: its own detections as bytes, or empty.

    images: the same decoded, once they were checked.
    """

    sequence: int
    timestamp_ns: int
    world_from_camera: F64
    rgb: bytes
    depth: bytes
    depth_encoding: str
    depth_scale: float
    onboard: bytes = b""
    images: Images | None = None


@dataclass(frozen=True, slots=True)
class StoredFrame:
    """One entry of the frame log: everything about the frame but its images, and where those are."""

    log_id: str
    frame_id: str
    timestamp_ns: int
    world_from_camera: F64
    intrinsics: Intrinsics
    rgb_ref: str
    depth_ref: str
    depth_encoding: str
    depth_scale: float
    onboard_ref: str

    def record(self, tags: tuple[str, ...] | None) -> FrameRecord:
        """What readers get; `tags` None where it is not processed yet."""
        return FrameRecord(
            self.frame_id,
            self.timestamp_ns,
            self.world_from_camera,
            self.intrinsics,
            tags or (),
            tags is not None,
            self.log_id,
        )


def entry_fields(
    frame_id: str, upload: Upload, intrinsics: Intrinsics, rgb_ref: str, depth_ref: str, onboard_ref: str
) -> dict[str, bytes | str | int]:
    """The fields of a frame's log entry."""
    k = intrinsics
    return {
        "frame_id": frame_id,
        "timestamp_ns": upload.timestamp_ns,
        "pose": upload.world_from_camera.astype("<f8").tobytes(),
        "intrinsics": json.dumps([k.fx, k.fy, k.cx, k.cy, k.width, k.height]),
        "rgb": rgb_ref,
        "depth": depth_ref,
        "depth_encoding": upload.depth_encoding,
        "depth_scale": repr(upload.depth_scale),
        "onboard": onboard_ref,
    }


def stored_frame(entry: Entry) -> StoredFrame:
    """The entry that `entry_fields` made."""
    fields = entry.fields
    fx, fy, cx, cy, width, height = json.loads(fields["intrinsics"])
    return StoredFrame(
        log_id=entry.id,
        frame_id=fields["frame_id"].decode(),
        timestamp_ns=int(fields["timestamp_ns"]),
        world_from_camera=np.frombuffer(fields["pose"], "<f8").reshape(4, 4),
        intrinsics=Intrinsics(fx, fy, cx, cy, int(width), int(height)),
        rgb_ref=fields["rgb"].decode(),
        depth_ref=fields["depth"].decode(),
        depth_encoding=fields["depth_encoding"].decode(),
        depth_scale=float(fields["depth_scale"]),
        onboard_ref=fields["onboard"].decode(),
    )


class FrameHistory:
    """Reads frames of any scene from the store."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._fresh = _FreshImages(_MOST_FRESH_BYTES, _FRESH_FOR)

    async def find(self, scene: str, frame_id: str) -> StoredFrame:
        """NotFound where the scene has no such frame."""
        log_id = await self._store.frame_log_id(scene, frame_id)
        entry = await self._store.read_entry(scene, FRAMES, log_id) if log_id else None
        if entry is None:
            raise NotFound(f"frame {frame_id[:80]!r} is not in scene {scene}")
        return stored_frame(entry)

    async def records(self, scene: str, after: str, limit: int) -> list[FrameRecord]:
        """Frames after a log id, oldest first."""
        frames = [stored_frame(e) for e in await self._store.read(scene, FRAMES, after or "0-0", limit)]
        tags = await self.tags(scene, [f.frame_id for f in frames])
        return [frame.record(tags.get(frame.frame_id)) for frame in frames]

    async def tags(self, scene: str, frame_ids: list[str]) -> dict[str, tuple[str, ...]]:
        """Tag words of the frames that are processed."""
        found = await self._store.values(scene, STAGE, [f"tags:{frame_id}" for frame_id in frame_ids])
        return {name[5:]: tuple(json.loads(value)) for name, value in found.items()}

    def expect(self, rgb_ref: str, depth_ref: str, depth_scale: float, images: Images) -> None:
        """Images that were just stored and will likely be loaded once, soon: they need not be decoded again."""
        self._fresh.put((rgb_ref, depth_ref, depth_scale), images)

    async def load(self, stored: StoredFrame) -> Frame:
        """The frame with its images, decoded."""
        if images := self._fresh.take((stored.rgb_ref, stored.depth_ref, stored.depth_scale)):
            return _frame(stored, images)
        rgb, depth = await asyncio.gather(
            self._store.blobs.get(stored.rgb_ref), self._store.blobs.get(stored.depth_ref)
        )
        return await asyncio.to_thread(_decode, stored, rgb, depth)


class _FreshImages:
    """Decoded images by what names them, each to be taken once; new ones are turned away while there are `most_bytes`.

    What was not taken when `turns` later ones had been put never will be (another process reads it, say): it goes.
    """

    def __init__(self, most_bytes: int, turns: int) -> None:
        self._most_bytes, self._turns = most_bytes, turns
        self._bytes, self._turn = 0, 0
        self._images: dict[_Key, tuple[int, Images]] = {}

    def put(self, key: _Key, images: Images) -> None:
        self._turn += 1
        for oldest, (turn, _) in list(self._images.items())[:2]:
            if self._turn - turn > self._turns:
                self.take(oldest)
        if self._bytes + images.nbytes <= self._most_bytes and key not in self._images:
            self._images[key] = (self._turn, images)
            self._bytes += images.nbytes

    def take(self, key: _Key) -> Images | None:
        turn_and_images = self._images.pop(key, None)
        if turn_and_images is None:
            return None
        self._bytes -= turn_and_images[1].nbytes
        return turn_and_images[1]


def _decode(stored: StoredFrame, rgb: bytes, depth: bytes) -> Frame:
    k = stored.intrinsics
    metres = decode_depth(depth, stored.depth_encoding, stored.depth_scale, k)
    return _frame(stored, Images(decode_rgb(rgb, k), metres))


def _frame(stored: StoredFrame, images: Images) -> Frame:
    return Frame(
        frame_id=stored.frame_id,
        timestamp_ns=stored.timestamp_ns,
        intrinsics=stored.intrinsics,
        world_from_camera=stored.world_from_camera,
        rgb=images.rgb,
        depth=images.depth,
    )
