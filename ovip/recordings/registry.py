"""Opening a recording by its layout; a wrong place is told what was expected, what is there, what fits."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from ovip.errors import InvalidInput
from ovip.recordings.folder import OvipFolder
from ovip.recordings.hm3d import Hm3d
from ovip.recordings.layout import NO_OPTIONS, Contents, Layout, Options
from ovip.recordings.openeqa import OpenEqa
from ovip.recordings.record3d import Record3d
from ovip.recordings.recording import Recording, recording_of
from ovip.recordings.replica import Replica
from ovip.recordings.rosbag import ROS1, ROS2
from ovip.recordings.scannet import ScanNet
from ovip.recordings.sevenscenes import SevenScenes
from ovip.recordings.text import natural
from ovip.recordings.tum import Tum
from ovip.recordings.up import Up, unit_up

_ALL: tuple[Layout, ...] = (
    OvipFolder(),
    SevenScenes(),
    Tum(),
    Replica(),
    ScanNet(),
    Hm3d(),
    OpenEqa(),
    Record3d(),
    ROS1,
    ROS2,
)
LAYOUTS: dict[str, Layout] = {layout.name: layout for layout in _ALL}
COMMON_OPTIONS = {"depth_scale": "depth units per metre, instead of what the layout says"}

_SHOWN = 8


def open_recording(
    path: str | Path, layout: str, up: Up = None, stride: int = 1, options: Options = NO_OPTIONS
) -> Recording:
    """Every `stride`-th frame of the recording at `path`, laid out as `layout` (a key of `LAYOUTS`).

    up: the direction that points up in the recording's own frame, or "auto" to find it; None takes what the
    layout knows of its world, and finds up where it knows nothing. options: what the layout takes
    (`Layout.options`), and `COMMON_OPTIONS`. Raises InvalidInput, which says what was expected.
    """
    if layout not in LAYOUTS:
        raise InvalidInput(f"layout: expected one of {', '.join(LAYOUTS)}, got {layout!r}")
    if stride < 1:
        raise InvalidInput(f"stride: expected 1 or more, got {stride}")
    if isinstance(up, str) and up != "auto":
        raise InvalidInput(f"up: expected 'auto' or three numbers, got {up!r}")
    if isinstance(up, tuple):
        unit_up(up)
    place, reader = Path(path), LAYOUTS[layout]
    _check_options(reader, options)
    _check_place(place, reader)
    contents = _with_common(reader.read(place, options), options)
    return recording_of(contents, place.resolve().name, layout, reader.up if up is None else up, stride)


def fitting_layouts(path: str | Path) -> tuple[str, ...]:
    """The layouts that `path` looks like, by name."""
    place = Path(path)
    return tuple(layout.name for layout in _ALL if place.exists() and layout.fits(place))


def find_layout(path: str | Path) -> str:
    """The one layout that `path` looks like; InvalidInput where none or several do, says what is there."""
    place, fitting = Path(path), fitting_layouts(path)
    if len(fitting) == 1:
        return fitting[0]
    if fitting:
        raise InvalidInput(f"{place}: looks like {' and '.join(fitting)}: name one as the layout")
    found = _listing(place) if place.is_dir() else "a file" if place.exists() else "nothing there"
    known = "".join(f"\n  {layout.name}: {layout.expects}" for layout in _ALL)
    hint = _advice(place, _ALL[0])
    raise InvalidInput(f"{place}: expected a recording, found {found}.{hint} Layouts that are known:{known}")


def parse_options(words: list[str]) -> Options:
    """`--option key=value`, as typed, once or more."""
    pairs = [word.partition("=") for word in words]
    for key, sign, _ in pairs:
        if not (key and sign):
            raise InvalidInput(f"option: expected key=value, got {key!r}")
    return {key: value for key, _, value in pairs}


def _check_options(reader: Layout, options: Options) -> None:
    known = {**reader.options, **COMMON_OPTIONS}
    unknown = [key for key in options if key not in known]
    if unknown:
        taken = "; ".join(f"{key} ({meaning})" for key, meaning in known.items())
        raise InvalidInput(f"option: layout {reader.name} takes {taken}; got {', '.join(unknown)}")


def _with_common(contents: Contents, options: Options) -> Contents:
    word = options.get("depth_scale")
    if word is None:
        return contents
    try:
        scale = float(word)
    except ValueError:
        scale = math.nan
    if not (math.isfinite(scale) and scale > 0):
        raise InvalidInput(f"option depth_scale: expected units per metre above 0, got {word!r}")
    return replace(contents, depth_scale=scale)


def _check_place(place: Path, reader: Layout) -> None:
    if place.exists() and reader.fits(place):
        return
    if not place.is_dir():
        what = "a file" if place.exists() else "nothing"
        raise InvalidInput(
            f"{place}: expected a recording laid out as {reader.name} ({reader.expects}), got {what} there"
            f".{_advice(place, reader)}"
        )
    raise InvalidInput(
        f"{place}: expected layout {reader.name} ({reader.expects}); "
        f"found {_listing(place)}.{_advice(place, reader)}"
    )


def _listing(folder: Path) -> str:
    names = sorted((path.name + "/" * path.is_dir() for path in folder.iterdir()), key=natural)
    if not names:
        return "an empty folder"
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more


def _advice(place: Path, reader: Layout) -> str:
    """Which layout fits this place, or a place inside it, in words; "" where none does."""
    fitting = fitting_layouts(place)
    if fitting:
        return f" This looks like layout {' or '.join(fitting)}."
    inside = sorted(place.iterdir(), key=lambda path: natural(path.name)) if place.is_dir() else []
    for path in inside:
        found = [layout.name for layout in (reader, *_ALL) if layout.fits(path)]
        if found:
            kind = "folder" if path.is_dir() else "file"
            return f" The {kind} {path.name} inside looks like layout {found[0]}."
    return ""
