"""`ovip record`: keeps what robots streamed, or any recording, in our own folder form."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated

import typer

from ovip.client import Addresses, AsyncClient
from ovip.errors import InvalidInput, NotFound
from ovip.recordings import (
    RecordedFrame,
    Recording,
    find_layout,
    new_folder,
    open_recording,
    parse_options,
    parse_up,
    write_folder,
)
from ovip.recordings.images import encode_raw_depth
from ovip.recordings.scales import scale_of
from ovip.recordings.sources import depth_units
from ovip.scene.answers import FrameRecord
from ovip.scene.types import Frame
from ovip_cli.recordings import AnyLayout, OptionWords, Stride, UpWord
from ovip_cli.stacks import DataDir, Json, Standalone, print_json, stack_for

_PAGE = 1000
_PNG = b"\x89PNG"
Fetch = Callable[[FrameRecord], tuple[Frame, bytes]]


def record(
    output: Annotated[Path, typer.Option("--output", "-o", help="folder to write; it must not be in use")],
    scene: Annotated[str | None, typer.Option(help="keep the frames of this scene of a stack")] = None,
    source: Annotated[Path | None, typer.Option("--from", help="convert this recording")] = None,
    layout: AnyLayout = None,
    up: UpWord = None,
    option: OptionWords = None,
    stride: Stride = 1,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Write a recording in the form that `ovip replay` reads: z up, one folder. All of it or nothing is written."""
    if (scene is None) == (source is None):
        raise InvalidInput(
            "expected either --scene NAME, to keep what was streamed, or --from PATH, to convert"
        )
    if source is not None:
        parsed = parse_options(option or [])
        recording = open_recording(
            source, layout or find_layout(source), parse_up(up) if up else None, stride, parsed
        )
        written = {str(output): _convert(recording, output)}
    else:
        with stack_for(standalone, data_dir) as addresses:
            written = _keep(addresses, scene or "", output, stride)
    if json:
        print_json({"recordings": [{"folder": folder, "frames": count} for folder, count in written.items()]})
        return
    for folder, count in written.items():
        print(f"{folder}: {count} frames")


def _convert(recording: Recording, output: Path) -> int:
    with new_folder(output) as folder:
        return write_folder(folder, recording.intrinsics, recording)


def _keep(addresses: Addresses, scene: str, output: Path, stride: int) -> dict[str, int]:
    """Writes a scene's frames: one session into `output`, each of several into a folder of its own there."""
    with asyncio.Runner() as runner:
        client = AsyncClient(addresses)
        try:
            sessions = _sessions(runner.run(_history(client, scene)), stride)
            if not sessions:
                raise NotFound(f"scene {scene!r}: expected frames, got none")
            return _write(sessions, lambda record: runner.run(_fetched(client, scene, record)), output)
        finally:
            runner.run(client.close())


def _write(sessions: dict[str, list[FrameRecord]], fetch: Fetch, output: Path) -> dict[str, int]:
    """Folder -> frames written there."""
    written = {}
    with new_folder(output) as folder:
        for name, records in sessions.items():
            part = Path() if len(sessions) == 1 else Path(name)
            frames = _recorded(map(fetch, records))
            written[str(output / part)] = write_folder(folder / part, records[0].intrinsics, frames)
    return written


def _sessions(history: list[FrameRecord], stride: int) -> dict[str, list[FrameRecord]]:
    """The frames of each session (robot.session), in order of sequence, every `stride`-th of them."""
    found: dict[str, list[FrameRecord]] = {}
    for record in sorted(history, key=lambda record: record.frame_id):
        found.setdefault(record.frame_id.rpartition(".")[0], []).append(record)
    return {name: records[::stride] for name, records in found.items()}


async def _history(client: AsyncClient, scene: str) -> list[FrameRecord]:
    found: list[FrameRecord] = []
    while True:
        page, _ = await client.perception.list_frames(scene, found[-1].log_id if found else "", _PAGE)
        if not page:
            return found
        found += page


async def _fetched(client: AsyncClient, scene: str, record: FrameRecord) -> tuple[Frame, bytes]:
    """The frame with its depth, and its colour image as the robot sent it."""
    return await asyncio.gather(
        client.perception.get_frame(scene, record.frame_id), client.perception.get_rgb(scene, record.frame_id)
    )


def _recorded(fetched: Iterable[tuple[Frame, bytes]]) -> Iterator[RecordedFrame]:
    """Frames with their depth in the units that the first one's was sent in."""
    scale = 0.0
    for index, (frame, rgb) in enumerate(fetched):
        scale = scale or scale_of(frame.depth)
        yield RecordedFrame(
            index=index,
            timestamp_ns=frame.timestamp_ns,
            world_from_camera=frame.world_from_camera,
            rgb_bytes=rgb,
            rgb_encoding="png" if rgb.startswith(_PNG) else "jpeg",
            depth_bytes=encode_raw_depth(depth_units(frame.depth, scale)),
            depth_scale=scale,
        )
