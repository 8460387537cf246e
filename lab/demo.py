"""`python -m lab.demo`, what `make demo` runs: the main job on real input, from frames to answers.

Starts a stack, streams the kitchen recording where it is beside the project, else the recorded tour of a simulated
home and the walk of a robot that can then be sent to look, asks five questions, prints what was answered, and leaves
the dashboard running (DEMO_EXIT=1: ends).
"""

from __future__ import annotations

import asyncio
import contextlib
import subprocess
import sys
from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError
from rich.console import Console
from rich.padding import Padding
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.text import Text

from lab.simulation import SimulatedRobot, SimulatedRoom
from ovip.client import Addresses, AsyncClient, StreamReport
from ovip.client.addresses import running_stack
from ovip.client.replaying import hello_of, outgoing
from ovip.client.streaming import StreamEvent
from ovip.config import explain
from ovip.errors import OvipError
from ovip.recordings import open_recording
from ovip.scene.answers import Answer, Observation, Outcome, PerceptionStatus, Query, Viewpoint
from services.standalone.config import Settings as StandaloneSettings
from services.standalone.process import read_ready, start_stack, stop_stack

KITCHEN = Path(__file__).resolve().parents[2] / "shared" / "data" / "kitchen"
KITCHEN_STRIDE = 3
TOUR = Path(__file__).resolve().parent / "data" / "home_tour"
TOUR_STRIDE = 3
TOUR_QUESTIONS = ("plant", "sofa", "television", "piano")
KITCHEN_QUESTIONS = ("white mug", "chair", "table", "television", "piano")
HOME_QUESTIONS = ("red mug", "bed", "the vase on the bookshelf", "television")
HOME_ABSENT = "blue mug"

OnEvent = Callable[[StreamEvent], None]
console = Console(highlight=False)


class Settings(StandaloneSettings):
    """The stack's settings, and whether to end after the answers."""

    data_dir: Path = Field(Path("demo-data"), description="where the demo's stack keeps its state")
    exit: bool = Field(False, validation_alias="DEMO_EXIT", description="end after the answers")


@dataclass(frozen=True, slots=True)
class Asked:
    """A question and what was answered."""

    text: str
    answer: Answer


@dataclass(frozen=True, slots=True)
class Show:
    """What is mapped and asked. frames: how many there are to stream; search: the question with a robot in it."""

    scene: str
    what: str
    frames: int
    stream: Callable[[OnEvent], Awaitable[StreamReport]]
    questions: Sequence[str]
    search: str = ""
    robot: SimulatedRobot | None = None


def main() -> None:
    """A known error ends with one line and status 1; Ctrl-C ends gently."""
    try:
        settings = Settings()
        with _stack(settings) as (stack, process):
            asyncio.run(_demonstrate(Addresses.of_stack(stack)))
            console.print(f"\ndashboard: {stack['dashboard']}", soft_wrap=True)
            if process and not settings.exit:
                console.print("Ctrl-C stops the stack; what it mapped stays in", settings.data_dir.absolute())
                process.wait()
    except ValidationError as error:
        _fail(str(explain(error)))
    except OvipError as error:
        _fail(str(error))
    except KeyboardInterrupt:
        console.print("stopped")


@contextlib.contextmanager
def _stack(settings: Settings) -> Iterator[tuple[dict[str, Any], subprocess.Popen[str] | None]]:
    """What the demo's stack says of itself; one that runs over the same data already is used and left alone."""
    running = running_stack(settings.data_dir)
    if running:
        console.print(
            f"a stack already runs on {settings.data_dir} (process {running['pid']}): using that one"
        )
        yield running, None
        return
    console.print(f"starting a stack on {settings.data_dir} ...")
    process = start_stack(settings.data_dir, settings.free_ports)
    try:
        yield read_ready(process), process
    finally:
        stop_stack(process)


async def _demonstrate(addresses: Addresses) -> None:
    async with AsyncClient(addresses) as client:
        asked: list[Asked] = []
        for show in _shows(client):
            await _map(client, show)
            asked += [Asked(text, await client.find(Query(show.scene, text))) for text in show.questions]
            if show.robot:
                asked.append(Asked(show.search, await _search(client, show.scene, show.search, show.robot)))
    _print_answers(asked)


def _shows(client: AsyncClient) -> list[Show]:
    """The kitchen where it is there; else the tour, which perception sees, and a robot for the search."""
    if KITCHEN.is_dir():
        return [_kitchen(client)]
    return [_tour(client), _home(client, ())] if TOUR.is_dir() else [_home(client, HOME_QUESTIONS)]


def _kitchen(client: AsyncClient) -> Show:
    recording = open_recording(KITCHEN, "7scenes", stride=KITCHEN_STRIDE)
    hello = hello_of(recording, "kitchen", "replay")
    return Show(
        scene="kitchen",
        what=f"the kitchen recording, every {KITCHEN_STRIDE}rd frame",
        frames=len(recording),
        stream=lambda on_event: client.stream(hello, outgoing(recording), on_event=on_event),
        questions=KITCHEN_QUESTIONS,
    )


def _tour(client: AsyncClient) -> Show:
    recording = open_recording(TOUR, "ovip", stride=TOUR_STRIDE)
    hello = hello_of(recording, "tour", "replay")
    return Show(
        scene="tour",
        what=f"a recorded tour of a simulated home, every {TOUR_STRIDE}rd frame (there is no recording in {KITCHEN})",
        frames=len(recording),
        stream=lambda on_event: client.stream(hello, outgoing(recording), on_event=on_event),
        questions=TOUR_QUESTIONS,
    )


def _home(client: AsyncClient, questions: Sequence[str]) -> Show:
    robot = SimulatedRobot(SimulatedRoom(), client, "home")
    return Show(
        scene="home",
        what="a robot's walk through a small simulated home",
        frames=robot.walk_length,
        stream=robot.walk,
        questions=questions,
        search=HOME_ABSENT,
        robot=robot,
    )


async def _map(client: AsyncClient, show: Show) -> None:
    console.print(f"streaming {show.what}")
    with _progress() as progress:
        streamed = progress.add_task("streamed", total=show.frames)
        mapped = progress.add_task("mapped", total=show.frames)

        def on_event(event: StreamEvent) -> None:
            progress.advance(streamed, event.status in {"durable", "rejected"})
            progress.advance(mapped, event.status == "applied")

        def on_progress(status: PerceptionStatus) -> None:
            done = status.frames_processed + status.frames_skipped
            progress.update(mapped, completed=min(done, show.frames))

        report = await show.stream(on_event)
        progress.update(streamed, completed=show.frames)
        scene_map = await client.wait_until_applied(show.scene, on_progress=on_progress)
    if report.resumed_after:
        console.print(f"resumed: {show.frames - report.sent} of {show.frames} frames were already there")
    partition = await client.regions.recompute(show.scene)
    console.print(
        f"{scene_map.frames} frames, {scene_map.detections} detections -> {len(scene_map.objects)} objects in "
        f"{len(partition.regions)} regions"
    )


async def _search(client: AsyncClient, scene: str, text: str, robot: SimulatedRobot) -> Answer:
    """An active search: the robot drives from viewpoint to viewpoint and looks."""
    console.print(f"searching for {text!r} with the robot")
    with _progress() as progress:
        looked = progress.add_task("viewpoints", total=None)

        async def look(viewpoint: Viewpoint) -> Observation:
            progress.update(looked, completed=viewpoint.index - 1, total=viewpoint.total)
            return await robot.look(viewpoint)

        _, answer = await client.search(Query(scene, text, robot_pose=robot.pose), look)
        if answer.coverage:
            progress.update(looked, completed=answer.coverage.visited + answer.coverage.unreachable)
    return answer


def _progress() -> Progress:
    return Progress(
        TextColumn("  {task.description:10}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
    )


def _print_answers(asked: Sequence[Asked]) -> None:
    console.print(f"\n{'asked':26}{'answer':12}{'tier':6}where (x, y, z in metres)")
    for one in asked:
        where = _where(one.answer)
        console.print(f"{one.text:26}{one.answer.outcome.value:12}{one.answer.tier:<6}{where}", markup=False)
        console.print(Padding(Text(_why(one.answer)), (0, 0, 0, 4)))
    for fallback in dict.fromkeys(f for one in asked for f in one.answer.fallbacks):
        console.print(f"fallback: {fallback}", markup=False)


def _where(answer: Answer) -> str:
    if answer.outcome is not Outcome.FOUND or answer.object is None:
        return "-"
    x, y, z = answer.object.position
    return f"{answer.object.label} at {x:.2f}, {y:.2f}, {z:.2f}"


def _why(answer: Answer) -> str:
    """The last word of the tier that answered, what was covered, what is missing."""
    parts = [report.why for report in answer.tiers if report.tier == answer.tier][-1:]
    if answer.coverage and answer.coverage.visited:
        area = sum(region.area for region in answer.coverage.regions)
        seen = sum(region.area * region.seen for region in answer.coverage.regions)
        parts.append(f"{seen:.0f} of {area:.0f} m2 seen, P(present) {answer.coverage.posterior_present:.2f}")
    if answer.needs:
        parts.append(f"needs {answer.needs}")
    return "; ".join(parts)


def _fail(message: str) -> None:
    print(f"demo: {message}", file=sys.stderr)
    raise SystemExit(1)


if __name__ == "__main__":
    main()
