"""A recording: which of its frames can be used, and the frames themselves, read one at a time."""

from __future__ import annotations

import hashlib
import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.frames import RecordedFrame, SkippedFrame
from ovip.recordings.images import ImageHeader, decode_raw_depth, parse_header, without_value
from ovip.recordings.layout import Contents, ImageSource, ListedFrame
from ovip.recordings.onboard import read_onboard
from ovip.recordings.up import Up, find_up, rotation_to_z_up, unit_up
from ovip.scene.camera import check_pose
from ovip.scene.types import F32, F64, I64, Intrinsics

VIEWS_FOR_UP = 20


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """A recording opened for reading; iterating it yields `RecordedFrame`s in order.

    depth_scale: units per metre. world_from_source: `(4, 4)` rotation from the recording's own world to z-up.
    skipped: frames that cannot be used. notes: what the layout had to assume, in words.
    """

    name: str
    layout: str
    intrinsics: Intrinsics
    depth_scale: float
    world_from_source: F64
    stride: int
    skipped: tuple[SkippedFrame, ...]
    notes: tuple[str, ...]
    _contents: Contents
    _used: tuple[int, ...]

    def __len__(self) -> int:
        """How many frames it yields: after the stride, without the skipped."""
        return len(self._used)

    def __iter__(self) -> Iterator[RecordedFrame]:
        return self.frames()

    def frames(self, after: int = -1) -> Iterator[RecordedFrame]:
        """The frames whose `index` is above `after`; for going on where an earlier run stopped."""
        for index in self._used:
            if index > after:
                yield self.load(index)

    @property
    def indices(self) -> tuple[int, ...]:
        """The `index` of every frame that it yields, in order."""
        return self._used

    def names(self) -> tuple[str, ...]:
        """What the recording itself calls the frames that it yields."""
        return tuple(self._contents.frames[index].name for index in self._used)

    def poses(self) -> F64:
        """world_from_camera `(N, 4, 4)` of the frames that it yields; reads no image."""
        return np.array([self._pose(index) for index in self._used])

    def timestamps(self) -> I64:
        """`(N,)` nanoseconds of the frames that it yields."""
        return np.array([self._contents.frames[index].timestamp_ns for index in self._used], np.int64)

    def fingerprint(self) -> str:
        """sha256 (hex) over layout, intrinsics, depth scale, up, all poses and names; not the stride."""
        k, digest = self.intrinsics, hashlib.sha256()
        digest.update(f"ovip-recording 1 {self.layout} {k!r} {self.depth_scale!r}\n".encode())
        digest.update((self.world_from_source.round(6) + 0.0).astype("<f8").tobytes())
        for frame in self._contents.frames:
            pose = np.full((4, 4), np.nan) if frame.pose is None else frame.pose
            digest.update(f"{frame.name}\n".encode())
            digest.update(struct.pack("<16d", *pose.ravel()))
        return digest.hexdigest()

    def load(self, index: int) -> RecordedFrame:
        """One frame, by its `index` (one of `indices`)."""
        listed = self._contents.frames[index]
        assert listed.rgb is not None
        assert listed.depth is not None
        rgb, depth, invalid = listed.rgb.read(), listed.depth.read(), self._contents.invalid_depth
        header = parse_header(rgb)
        if header is None:
            raise InvalidInput(
                f"{listed.rgb.where}: expected a JPEG or PNG image, as when the recording was opened"
            )
        return RecordedFrame(
            index=index,
            timestamp_ns=listed.timestamp_ns,
            world_from_camera=self._pose(index),
            rgb_bytes=rgb,
            rgb_encoding=header.encoding,
            depth_bytes=depth if invalid is None else without_value(depth, invalid),
            depth_scale=self.depth_scale,
            onboard=None if listed.onboard is None else read_onboard(listed.onboard),
        )

    def _pose(self, index: int) -> F64:
        pose = self._contents.frames[index].pose
        assert pose is not None
        return self.world_from_source @ rigid(pose)


def recording_of(contents: Contents, name: str, layout: str, up: Up, stride: int) -> Recording:
    """The recording of `contents`, every `stride`-th frame of it; `up` None means that it is z-up already."""
    used, skipped = _usable(contents, stride)
    if not used:
        counted = Counter(frame.reason for frame in skipped).most_common(3)
        reasons = "; ".join(f"{reason} ({count} frames)" for reason, count in counted)
        raise InvalidInput(f"{name}: expected frames with image, depth and pose, got none to use: {reasons}")
    return Recording(
        name=name,
        layout=layout,
        intrinsics=contents.intrinsics,
        depth_scale=contents.depth_scale,
        world_from_source=_world_from_source(contents, used, up),
        stride=stride,
        skipped=skipped,
        notes=contents.notes,
        _contents=contents,
        _used=used,
    )


def rigid(pose: F64) -> F64:
    """`pose` with its rotation made exactly orthonormal (files round it to a few digits)."""
    u, _, vt = np.linalg.svd(pose[:3, :3])
    exact = np.eye(4)
    exact[:3, :3] = u @ vt
    exact[:3, 3] = pose[:3, 3]
    return exact


def _usable(contents: Contents, stride: int) -> tuple[tuple[int, ...], tuple[SkippedFrame, ...]]:
    used, skipped = [], []
    for index in range(0, len(contents.frames), stride):
        listed = contents.frames[index]
        trouble = _trouble(listed, contents.intrinsics)
        if trouble:
            skipped.append(SkippedFrame(index, listed.name, trouble))
        else:
            used.append(index)
    return tuple(used), tuple(skipped)


def _trouble(listed: ListedFrame, k: Intrinsics) -> str:
    """Why this frame cannot be used, or ""; InvalidInput where it shows that the whole recording is wrong."""
    if listed.pose is None:
        return "no pose"
    if listed.rgb is None or listed.depth is None:
        return "no colour image" if listed.rgb is None else "no depth image"
    rgb, depth = listed.rgb.header(), listed.depth.header()
    if rgb is None:
        return "colour image missing or not a JPEG or PNG"
    if depth is None:
        return "depth image missing or not a PNG"
    _check_size(listed.rgb, rgb, k)
    _check_size(listed.depth, depth, k)
    if not (depth.encoding == "png" and depth.bits == 16 and depth.grey):
        raise InvalidInput(
            f"{listed.depth.where}: expected a 16-bit PNG of one channel, got {depth.bits}-bit {depth.encoding}"
        )
    return _pose_trouble(listed.pose)


def _check_size(image: ImageSource, header: ImageHeader, k: Intrinsics) -> None:
    if (header.width, header.height) != (k.width, k.height):
        raise InvalidInput(
            f"{image.where}: expected {k.width}x{k.height} pixels as the intrinsics say, "
            f"got {header.width}x{header.height}"
        )


def _pose_trouble(pose: F64) -> str:
    if not np.isfinite(pose).all():
        return "pose not finite (tracking lost)"
    try:
        check_pose(pose)
    except InvalidInput as error:
        return str(error)
    return ""


def _world_from_source(contents: Contents, used: tuple[int, ...], up: Up) -> F64:
    if up is None:
        return np.eye(4)
    return rotation_to_z_up(_found_up(contents, used) if up == "auto" else unit_up(up))


def _found_up(contents: Contents, used: tuple[int, ...]) -> F64:
    """Up from frames spread evenly over the recording."""
    some = sorted({used[at] for at in np.linspace(0, len(used) - 1, VIEWS_FOR_UP).round().astype(int)})
    views = (_view(contents, index) for index in some)
    return find_up((view for view in views if view is not None), contents.intrinsics)


def _view(contents: Contents, index: int) -> tuple[F32, F64] | None:
    """Depth in metres and pose of one frame; None where the depth does not decode."""
    listed = contents.frames[index]
    assert listed.pose is not None
    assert listed.depth is not None
    raw = decode_raw_depth(listed.depth.read())
    if raw is None:
        return None
    valid = np.ones(raw.shape, np.bool_) if contents.invalid_depth is None else raw != contents.invalid_depth
    return np.where(valid, raw / contents.depth_scale, 0).astype(np.float32), rigid(listed.pose)
