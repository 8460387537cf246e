"""Opening a recording by its layout; a wrong folder is told what was expected, what is there, what fits."""

from __future__ import annotations

from pathlib import Path

from ovip.errors import InvalidInput
from ovip.recordings.folder import OvipFolder
from ovip.recordings.layout import Layout
from ovip.recordings.recording import Recording, recording_of
from ovip.recordings.replica import Replica
from ovip.recordings.sevenscenes import SevenScenes
from ovip.recordings.text import natural
from ovip.recordings.tum import Tum
from ovip.recordings.up import Up, unit_up

_ALL: tuple[Layout, ...] = (SevenScenes(), Tum(), Replica(), OvipFolder())
LAYOUTS: dict[str, Layout] = {layout.name: layout for layout in _ALL}

_SHOWN = 8


def open_recording(path: str | Path, layout: str, up: Up = None, stride: int = 1) -> Recording:
    """Every `stride`-th frame of the recording in folder `path`, laid out as `layout` (a key of `LAYOUTS`).

    up: the direction that points up in the recording's own frame, or "auto" to find it; None leaves a z-up
    layout as it is and finds up where the layout's world is not z-up. Raises InvalidInput, which says what
    was expected.
    """
    if layout not in LAYOUTS:
        raise InvalidInput(f"layout: expected one of {', '.join(LAYOUTS)}, got {layout!r}")
    if stride < 1:
        raise InvalidInput(f"stride: expected 1 or more, got {stride}")
    if isinstance(up, str) and up != "auto":
        raise InvalidInput(f"up: expected 'auto' or three numbers, got {up!r}")
    if isinstance(up, tuple):
        unit_up(up)
    folder, reader = Path(path), LAYOUTS[layout]
    _check_folder(folder, reader)
    wanted: Up = "auto" if up is None and not reader.z_up else up
    return recording_of(reader.read(folder), folder.resolve().name, layout, wanted, stride)


def _check_folder(folder: Path, reader: Layout) -> None:
    if not folder.is_dir():
        what = "a file" if folder.exists() else "nothing"
        raise InvalidInput(
            f"{folder}: expected a folder with a recording laid out as {reader.name}, got {what} there"
        )
    if not reader.fits(folder):
        raise InvalidInput(
            f"{folder}: expected layout {reader.name} ({reader.expects}); "
            f"found {_listing(folder)}.{_advice(folder, reader)}"
        )


def _listing(folder: Path) -> str:
    names = sorted((path.name + "/" * path.is_dir() for path in folder.iterdir()), key=natural)
    if not names:
        return "an empty folder"
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more


def _advice(folder: Path, reader: Layout) -> str:
    """Which layout fits this folder, or a folder inside it, in words; "" where none does."""
    fitting = [layout.name for layout in _ALL if layout.fits(folder)]
    if fitting:
        return f" This looks like layout {' or '.join(fitting)}."
    inside = sorted((path for path in folder.iterdir() if path.is_dir()), key=lambda path: natural(path.name))
    for path in inside:
        fitting = [layout.name for layout in (reader, *_ALL) if layout.fits(path)]
        if fitting:
            return f" The folder {path.name} inside looks like layout {fitting[0]}."
    return ""
