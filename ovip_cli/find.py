"""`ovip find`: asks where something is."""

from __future__ import annotations

import asyncio
from enum import StrEnum
from typing import Annotated, Any

import typer
from rich.console import Console

from ovip.answer_json import answer_to_json
from ovip.client import Addresses, AsyncClient
from ovip.scene.answers import Answer, Query, SearchEvent, TierReport
from ovip_cli.stacks import DataDir, Json, Scene, Standalone, print_json, stack_for


class OutputFrame(StrEnum):
    WORLD = "world"
    SOURCE = "source"


def find(
    text: Annotated[str, typer.Argument(help='what to find, e.g. "white mug"')],
    scene: Scene,
    frame: Annotated[
        OutputFrame, typer.Option(help="world: z-up; source: the recording's own frame")
    ] = OutputFrame.WORLD,
    region: Annotated[str, typer.Option(help="where to look first, e.g. kitchen")] = "",
    max_tier: Annotated[int, typer.Option(help="highest tier to run, 1 to 4")] = 0,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Ask one question; prints the answer, the tier that gave it, and why each earlier one did not."""
    query = Query(scene, text, region_hint=region, max_tier=max_tier)
    with stack_for(standalone, data_dir) as addresses:
        result = asyncio.run(_find(query, addresses, frame, quiet=json))
    if json:
        print_json(result)
    else:
        say_answer(text, result)


async def _find(query: Query, addresses: Addresses, frame: OutputFrame, quiet: bool) -> dict[str, Any]:
    console = Console(stderr=True, quiet=quiet)

    def show(event: SearchEvent) -> None:
        if isinstance(event, TierReport):
            console.print(
                f"  tier {event.tier}: {event.result.value} ({event.why})", highlight=False, markup=False
            )

    async with AsyncClient(addresses) as client:
        search_id, answer = "", None
        async for current_id, event in client.retrieval.find(query):
            show(event)
            search_id, answer = current_id, event if isinstance(event, Answer) else answer
        assert answer is not None  # the last event is the answer
        source = None
        if frame is OutputFrame.SOURCE:
            source = (await client.perception.status(query.scene)).world_from_source
        return answer_to_json(answer, search_id, source)


def say_answer(text: str, result: dict[str, Any]) -> None:
    """The answer in a few lines for a person."""
    found = result["object"]
    if result["outcome"] == "found" and found:
        x, y, z = found["position"]
        print(
            f"{text}: found, tier {result['tier']}: {found['label']} {found['id']} at ({x:.2f}, {y:.2f}, {z:.2f}) m"
        )
    else:
        print(f"{text}: {result['outcome']}, tier {result['tier']}")
    if result["needs"]:
        print(f"  needs: {result['needs']}")
    for fallback in result["fallbacks"]:
        print(f"  fallback: {fallback}")
