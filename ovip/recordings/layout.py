"""The seam between a layout on disk and a recording: what a layout must say about a folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from ovip.scene.types import F64, Intrinsics


@dataclass(frozen=True, slots=True, eq=False)
class FrameFiles:
    """One frame as listed by a layout; only its pose has been read.

    pose: `(4, 4)` world_from_camera in the recording's own frame, camera x right, y down, z forward; NaN
    where tracking was lost; None where the recording has none for this frame. rgb, depth: None where missing.
    """

    name: str
    timestamp_ns: int
    pose: F64 | None
    rgb: Path | None
    depth: Path | None
    onboard: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Contents:
    """All that a layout knows of one recording.

    depth_scale: units per metre. invalid_depth: a raw value that means "no measurement" besides 0.
    notes: what the layout had to assume, in words for the user.
    """

    intrinsics: Intrinsics
    depth_scale: float
    frames: tuple[FrameFiles, ...]
    invalid_depth: int | None = None
    notes: tuple[str, ...] = ()


class Layout(Protocol):
    """One way to lay a recording out in a folder: `expects` in words, `z_up` where its world is z-up."""

    @property
    def name(self) -> str: ...
    @property
    def expects(self) -> str: ...
    @property
    def z_up(self) -> bool: ...

    def fits(self, folder: Path) -> bool:
        """Whether `folder` looks like this layout (its files may still be wrong)."""
        ...

    def read(self, folder: Path) -> Contents:
        """The recording in `folder`; InvalidInput says which file was expected and what was there."""
        ...
