"""The frame history: how a frame lies in the log and the blobs, and how it is read back."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass

import numpy as np

from ovip.errors import NotFound
from ovip.scene.answers import FrameRecord
from ovip.scene.types import F64, Frame, Intrinsics
from ovip.store import Entry, Store
from ovip.wire import decode_depth, decode_rgb

STAGE = "perception"
FRAMES, DETECTIONS = "frames", "detections"


@dataclass(frozen=True, slots=True)
class Upload:
    """A frame as a robot sent it: encoded images, not yet decoded. onboard: its own detections as bytes, or empty."""

    sequence: int
    timestamp_ns: int
    world_from_camera: F64
    rgb: bytes
    depth: bytes
    depth_encoding: str
    depth_scale: float
    onboard: bytes = b""


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

    async def load(self, stored: StoredFrame) -> Frame:
        """The frame with its images, decoded."""
        rgb, depth = await asyncio.gather(
            self._store.blobs.get(stored.rgb_ref), self._store.blobs.get(stored.depth_ref)
        )
        return await asyncio.to_thread(_decode, stored, rgb, depth)


def _decode(stored: StoredFrame, rgb: bytes, depth: bytes) -> Frame:
    return Frame(
        frame_id=stored.frame_id,
        timestamp_ns=stored.timestamp_ns,
        intrinsics=stored.intrinsics,
        world_from_camera=stored.world_from_camera,
        rgb=decode_rgb(rgb, stored.intrinsics),
        depth=decode_depth(depth, stored.depth_encoding, stored.depth_scale, stored.intrinsics),
    )
