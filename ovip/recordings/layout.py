"""The seam between a layout on disk and a recording: what a layout must say about a folder or a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Protocol

from ovip.recordings.images import ImageHeader
from ovip.recordings.up import Up
from ovip.scene.types import F64, Intrinsics

Options = Mapping[str, str]
NO_OPTIONS: Options = MappingProxyType({})
OPENGL_FROM_OPENCV = (1.0, -1.0, -1.0, 1.0)
"""Diagonal: an OpenGL camera (x right, y up, z back) from ours (x right, y down, z forward)."""


class ImageSource(Protocol):
    """An encoded image that is read when it is asked for; `where` names it in messages."""

    @property
    def where(self) -> str: ...

    def header(self) -> ImageHeader | None:
        """What the encoded image will be; None where it is missing or of no known kind."""
        ...

    def read(self) -> bytes:
        """The encoded image, PNG or JPEG; InvalidInput where it cannot be had any more."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class ListedFrame:
    """One frame as listed by a layout; only its pose has been read.

    pose: `(4, 4)` world_from_camera in the recording's own frame, camera x right, y down, z forward; NaN
    where tracking was lost; None where the recording has none for this frame. rgb, depth: None where missing.
    """

    name: str
    timestamp_ns: int
    pose: F64 | None
    rgb: ImageSource | None
    depth: ImageSource | None
    onboard: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Contents:
    """All that a layout knows of one recording.

    depth_scale: units per metre. invalid_depth: a raw value that means "no measurement" besides 0.
    notes: what the layout had to assume, in words for the user.
    """

    intrinsics: Intrinsics
    depth_scale: float
    frames: tuple[ListedFrame, ...]
    invalid_depth: int | None = None
    notes: tuple[str, ...] = ()


class Layout(Protocol):
    """One way to lay a recording out: `expects` in words, `options` it takes and what each means.

    up: up in its world; None where that is z, "auto" where it is not known.
    """

    @property
    def name(self) -> str: ...
    @property
    def expects(self) -> str: ...
    @property
    def options(self) -> Options: ...
    @property
    def up(self) -> Up: ...

    def fits(self, path: Path, /) -> bool:
        """Whether `path` looks like this layout (its files may still be wrong)."""
        ...

    def read(self, path: Path, options: Options, /) -> Contents:
        """The recording at `path`; InvalidInput says which file was expected and what was there."""
        ...
