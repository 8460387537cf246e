"""Frames of a recording made small for inspection: grey and depth on one grid of at most 320 columns."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np

from ovip.recordings.images import decode_raw_depth
from ovip.recordings.recording import Recording
from ovip.scene.types import F32, F64, U8, U16, Intrinsics

COLUMNS = 320


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """gray `(h, w)`; raw: depth `(h, w)` in the recording's own units, 0 = none; metres: the same in metres."""

    gray: U8
    raw: U16
    metres: F32


class Views:
    """The frames of a recording by position (0 = the first that it yields), read when asked for and kept.

    k: intrinsics of the small grid. undecoded: positions whose images are broken.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self._seen: dict[int, View | None] = {}
        self.poses: F64 = recording.poses()
        self.step = max(1, -(-recording.intrinsics.width // COLUMNS))
        self.k = _smaller(recording.intrinsics, self.step)

    def __len__(self) -> int:
        return len(self._recording)

    def name(self, position: int) -> str:
        """What the recording calls the frame at `position`."""
        return self._recording.names()[position]

    def at(self, position: int) -> View | None:
        """The view at `position`; None where its images do not decode."""
        if position not in self._seen:
            self._seen[position] = self._load(position)
        return self._seen[position]

    def all_at(self, positions: Iterable[int]) -> list[tuple[int, View]]:
        """The views at `positions` that decode."""
        found = ((int(position), self.at(int(position))) for position in positions)
        return [(position, view) for position, view in found if view is not None]

    @property
    def undecoded(self) -> list[int]:
        return sorted(position for position, view in self._seen.items() if view is None)

    def _load(self, position: int) -> View | None:
        frame = self._recording.load(self._recording.indices[position])
        gray = cv2.imdecode(np.frombuffer(frame.rgb_bytes, np.uint8), cv2.IMREAD_GRAYSCALE)
        raw = decode_raw_depth(frame.depth_bytes)
        if gray is None or raw is None or gray.shape != raw.shape:
            return None
        small = raw[:: self.step, :: self.step]
        soft = cv2.blur(gray, (self.step, self.step))[:: self.step, :: self.step]
        metres = (small / frame.depth_scale).astype(np.float32)
        return View(np.asarray(soft, np.uint8), small, metres)


def spread(count: int, most: int) -> list[int]:
    """At most `most` positions spread evenly over `count`, the first and the last among them."""
    return sorted(set(np.linspace(0, count - 1, min(count, most)).round().astype(int).tolist()))


def turns(first: F64, second: F64) -> F64:
    """Degrees between rotations `(..., 3, 3)`."""
    trace = np.einsum("...ij,...ij->...", first, second)
    return np.asarray(np.degrees(np.arccos(np.clip((trace - 1) / 2, -1, 1))))


def _smaller(k: Intrinsics, step: int) -> Intrinsics:
    """Intrinsics of every `step`-th pixel."""
    width, height = -(-k.width // step), -(-k.height // step)
    return Intrinsics(k.fx / step, k.fy / step, k.cx / step, k.cy / step, width, height)
