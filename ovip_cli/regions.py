"""`ovip regions`: how a scene's floors are cut, as a table, a picture, polygons, and maps for robots."""

from __future__ import annotations

import asyncio
import io
import json as json_text
import zipfile
from pathlib import Path
from typing import Annotated, Any

import typer

from ovip.client import Addresses, AsyncClient
from ovip.errors import NotFound
from ovip_cli.fetching import fetch, write_all, write_whole
from ovip_cli.region_words import regions_table, way_words
from ovip_cli.stacks import DataDir, Json, SceneName, Standalone, print_json, stack_for


def regions(
    name: SceneName,
    plot: Annotated[
        Path | None, typer.Option(help="draw the plan of all floors into this PNG", dir_okay=False)
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option(min=5, max=400, help="of --plot, pixels a metre; else 80, or fewer for a large floor"),
    ] = None,
    polygons: Annotated[
        Path | None,
        typer.Option(help="write the regions' polygons into this JSON file, in metres", dir_okay=False),
    ] = None,
    nav2: Annotated[
        Path | None,
        typer.Option(help="write maps for ROS 2 nav2 (.pgm, .yaml) into this folder", file_okay=False),
    ] = None,
    grid: Annotated[
        Path | None,
        typer.Option(
            help="write each floor's occupancy and regions as PNG into this folder", file_okay=False
        ),
    ] = None,
    route: Annotated[
        tuple[str, str] | None, typer.Option(help='the shortest way from "x,y,z" to "x,y,z", world metres')
    ] = None,
    robot_radius: Annotated[
        float, typer.Option(min=0, max=2, help="of --route, metres; 0: the stack's own setting")
    ] = 0.0,
    recompute: Annotated[bool, typer.Option("--recompute", help="cut the floors anew first")] = False,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """List a scene's floors and regions; draw them, or write them for robots and other programs."""
    with stack_for(standalone, data_dir) as addresses:
        if recompute:
            asyncio.run(_recompute(addresses, name))
        body = json_text.loads(fetch(addresses, name, "regions"))
        if not body["floors"]:
            raise NotFound(
                f"scene {name!r} has no regions yet: its floors are cut once enough of them was seen"
            )
        written = _write(addresses, name, body, plot, scale, polygons, nav2, grid)
        way = None if route is None else _way(addresses, name, route, robot_radius)
    if json:
        print_json(body | {"written": written} | ({} if way is None else {"route": way}))
        return
    print(f"{name}: " + "\n".join(regions_table(body)))
    if way is not None:
        print("\n" + way_words(way, body))
    for file in written:
        print(f"wrote {file}")


def _write(
    addresses: Addresses,
    name: str,
    body: dict[str, Any],
    plot: Path | None,
    scale: float | None,
    polygons: Path | None,
    nav2: Path | None,
    grid: Path | None,
) -> list[str]:
    """Everything is fetched before anything is written. Returns the files, in the order they were."""
    whole: list[tuple[str, Path, bytes]] = []
    if plot is not None:
        whole.append(("--plot", plot, fetch(addresses, name, "floorplan.png", scale=scale)))
    if polygons is not None:
        whole.append(("--polygons", polygons, fetch(addresses, name, "exports/regions.json")))
    folders: list[tuple[str, Path, dict[str, bytes]]] = []
    if nav2 is not None:
        folders.append(("--nav2", nav2, _unpacked(fetch(addresses, name, "exports/nav2"))))
    if grid is not None:
        folders.append(("--grid", grid, _grids(addresses, name, body)))
    for option, file, data in whole:
        write_whole(option, file, data)
    for option, folder, files in folders:
        write_all(option, folder, files)
    return [
        *(str(file) for _, file, _ in whole),
        *(str(folder / file) for _, folder, files in folders for file in files),
    ]


def _unpacked(archive: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(archive)) as files:
        return {name: files.read(name) for name in files.namelist()}


def _grids(addresses: Addresses, name: str, body: dict[str, Any]) -> dict[str, bytes]:
    """The pictures of each floor, and what their cells and values mean."""
    files = {}
    for floor in (floor["floor"] for floor in body["floors"]):
        files[f"floor-{floor}.json"] = fetch(addresses, name, f"grid/{floor}")
        for kind in ("occupancy", "regions"):
            files[f"floor-{floor}-{kind}.png"] = fetch(addresses, name, f"grid/{floor}/{kind}.png")
    return files


def _way(addresses: Addresses, name: str, route: tuple[str, str], radius: float) -> Any:
    start, goal = route
    return json_text.loads(fetch(addresses, name, "route", **{"from": start, "to": goal, "radius": radius}))


async def _recompute(addresses: Addresses, name: str) -> None:
    async with AsyncClient(addresses) as client:
        await client.regions.recompute(name)
