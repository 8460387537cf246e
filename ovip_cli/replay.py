"""`ovip replay`: streams a recording into a scene as a robot would."""

from __future__ import annotations

import asyncio
import time
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from ovip.client import Addresses, AsyncClient, StreamReport
from ovip.client.replaying import hello_of, outgoing
from ovip.client.streaming import StreamEvent
from ovip.recordings import LAYOUTS, Recording, open_recording, parse_options, parse_up
from ovip.scene.answers import PerceptionStatus
from ovip.scene.types import SceneMap
from ovip_cli.recordings import OptionWords, Stride, UpWord
from ovip_cli.stacks import DataDir, Json, Scene, Standalone, print_json, stack_for


def replay(
    path: Annotated[Path, typer.Argument(help="the recording: a folder, or a bag file")],
    scene: Scene,
    layout: Annotated[str, typer.Option(help=f"how the folder is laid out: {', '.join(LAYOUTS)}")] = "ovip",
    up: UpWord = None,
    option: OptionWords = None,
    stride: Stride = 1,
    robot: Annotated[str, typer.Option(help="robot id to stream as")] = "replay",
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Stream a recording; the same recording again changes nothing, and an interrupted one goes on where it was."""
    recording = open_recording(
        path, layout, parse_up(up) if up else None, stride, parse_options(option or [])
    )
    with stack_for(standalone, data_dir) as addresses:
        result = asyncio.run(_replay(recording, addresses, scene, robot, quiet=json))
    if json:
        print_json(result)
    else:
        _say(result)


async def _replay(
    recording: Recording, addresses: Addresses, scene: str, robot: str, quiet: bool
) -> dict[str, Any]:
    began = time.monotonic()
    hello = hello_of(recording, scene, robot)
    console = Console(stderr=True, quiet=quiet)
    for note in recording.notes:
        console.print(f"note: {note}")
    async with AsyncClient(addresses) as client:
        with _Bars(console, len(recording)) as bars:
            report = await client.stream(hello, outgoing(recording), on_event=bars.on_event)
            bars.streamed(report)
            scene_map = await client.wait_until_applied(scene, on_progress=bars.on_progress)
        partition = await client.regions.recompute(scene)
    for refused in report.rejected:
        console.print(f"frame {refused.sequence} was rejected: {refused.reason}")
    return _result(recording, report, scene_map, len(partition.regions), time.monotonic() - began)


def _result(
    recording: Recording, report: StreamReport, scene_map: SceneMap, regions: int, seconds: float
) -> dict[str, Any]:
    return {
        "frames": scene_map.frames,
        "detections": scene_map.detections,
        "objects": len(scene_map.objects),
        "regions": regions,
        "map_version": scene_map.version,
        "state_hash": scene_map.state_hash,
        "seconds": round(seconds, 2),
        "sent": report.sent,
        "resumed_after": report.resumed_after,
        "rejected": [{"sequence": r.sequence, "reason": r.reason} for r in report.rejected],
        "skipped": [{"frame": s.name, "reason": s.reason} for s in recording.skipped],
    }


def _say(result: dict[str, Any]) -> None:
    print(
        f"{result['frames']} frames, {result['detections']} detections -> {result['objects']} objects in "
        f"{result['regions']} regions (map version {result['map_version']}, {result['seconds']:.0f} s)"
    )
    if result["resumed_after"]:
        print(f"resumed: frames up to {result['resumed_after']} were already there")


class _Bars:
    """Two bars: frames streamed (durable), frames in the map."""

    def __init__(self, console: Console, frames: int) -> None:
        self._progress = Progress(
            TextColumn("{task.description:10}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=console,
            disable=console.quiet,
        )
        self._streamed = self._progress.add_task("streamed", total=frames)
        self._mapped = self._progress.add_task("mapped", total=frames)
        self._frames = frames

    def __enter__(self) -> _Bars:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def on_event(self, event: StreamEvent) -> None:
        if event.status in {"durable", "rejected"}:
            self._progress.advance(self._streamed)
        elif event.status == "applied":
            self._progress.advance(self._mapped)

    def streamed(self, report: StreamReport) -> None:
        self._progress.update(self._streamed, completed=self._frames - len(report.rejected))

    def on_progress(self, status: PerceptionStatus) -> None:
        done = status.frames_processed + status.frames_skipped
        self._progress.update(self._mapped, completed=done, total=status.frames_durable)
