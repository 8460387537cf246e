"""`ovip scenes`: what is mapped, as it stands or stood, and whether the log still makes the same map."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

import typer

from ovip.answer_json import object_to_json
from ovip.client import Addresses, AsyncClient
from ovip.jsonable import to_json
from ovip.scene.answers import SceneSummary
from ovip.scene.types import SceneMap
from ovip.scene.versions import MapDiff, ObjectChange, Verification
from ovip_cli.joining import align, join
from ovip_cli.object_words import object_line, objects_table
from ovip_cli.stacks import DataDir, Json, SceneName, Standalone, print_json, stack_for

app = typer.Typer(help="What is mapped: scenes, their objects, their versions.", no_args_is_help=False)
app.command("join")(join)
app.command("align")(align)


@app.callback(invoke_without_command=True)
def scenes(
    context: typer.Context, standalone: Standalone = False, data_dir: DataDir = None, json: Json = False
) -> None:
    """List the scenes of a stack, or look into one."""
    if context.invoked_subcommand is None:
        list_scenes(standalone, data_dir, json)
    elif standalone or data_dir is not None or json:
        raise typer.BadParameter(f"options stand behind the word {context.invoked_subcommand!r}")


@app.command("list")
def list_scenes(standalone: Standalone = False, data_dir: DataDir = None, json: Json = False) -> None:
    """List the scenes of a stack."""
    with stack_for(standalone, data_dir) as addresses:
        found = asyncio.run(_scenes(addresses))
    if json:
        print_json({"scenes": to_json(found)})
        return
    print(f"{'scene':24} {'version':>8} {'objects':>8} {'frames':>8} {'detections':>11}")
    for s in found:
        print(f"{s.scene:24} {s.map_version:8} {s.objects:8} {s.frames:8} {s.detections:11}")


@app.command("show")
def show(
    name: SceneName,
    at: Annotated[int, typer.Option("--at", min=0, help="the map as of this version; 0: as it stands")] = 0,
    departed: Annotated[bool, typer.Option("--departed", help="also what was moved or removed")] = False,
    unconfirmed: Annotated[
        bool, typer.Option("--unconfirmed", help="also what too few frames saw to be believed")
    ] = False,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Show the objects of a scene: where, how large, how often seen, how they stand to each other."""
    with stack_for(standalone, data_dir) as addresses:
        scene_map = asyncio.run(_map(addresses, name, at, departed, unconfirmed))
    if json:
        print_json(_map_json(scene_map))
        return
    print(
        f"{scene_map.scene}: version {scene_map.version}, {len(scene_map.objects)} objects from "
        f"{scene_map.frames} frames"
    )
    for line in objects_table(scene_map.objects):
        print(line)


@app.command("verify")
def verify(
    name: SceneName, standalone: Standalone = False, data_dir: DataDir = None, json: Json = False
) -> None:
    """Rebuild a map from the first entry of its log and compare; exit status 1 where it is not the same."""
    with stack_for(standalone, data_dir) as addresses:
        found = asyncio.run(_verification(addresses, name))
    if json:
        print_json({"scene": name, "holds": found.holds, **to_json(found)})
    else:
        print(_verdict(name, found))
    if not found.holds:
        raise typer.Exit(1)


@app.command("diff")
def diff(
    name: SceneName,
    from_version: Annotated[int, typer.Argument(metavar="FROM", min=0, help="a version of the map")],
    to_version: Annotated[
        int, typer.Argument(metavar="TO", min=0, help="a later one; none or 0: as it stands")
    ] = 0,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Show what differs between two versions of a map."""
    with stack_for(standalone, data_dir) as addresses:
        found = asyncio.run(_diff(addresses, name, from_version, to_version))
    if json:
        print_json(_diff_json(name, found))
        return
    print(f"{name}: version {found.from_version} -> {found.to_version}, {len(found.changes)} objects differ")
    for change in found.changes:
        print(_change_line(change))


async def _scenes(addresses: Addresses) -> list[SceneSummary]:
    async with AsyncClient(addresses) as client:
        return await client.mapper.list_scenes()


async def _map(addresses: Addresses, name: str, at: int, departed: bool, unconfirmed: bool) -> SceneMap:
    async with AsyncClient(addresses) as client:
        return await client.mapper.get_map(name, unconfirmed, at, departed)


async def _verification(addresses: Addresses, name: str) -> Verification:
    async with AsyncClient(addresses) as client:
        return await client.verify(name)


async def _diff(addresses: Addresses, name: str, from_version: int, to_version: int) -> MapDiff:
    async with AsyncClient(addresses) as client:
        return await client.diff(name, from_version, to_version)


def _map_json(scene_map: SceneMap) -> dict[str, Any]:
    return {
        "scene": scene_map.scene,
        "map_version": scene_map.version,
        "state_hash": scene_map.state_hash,
        "frames": scene_map.frames,
        "detections": scene_map.detections,
        "objects": [object_to_json(o) for o in scene_map.objects],
    }


def _diff_json(name: str, found: MapDiff) -> dict[str, Any]:
    return {
        "scene": name,
        "from_version": found.from_version,
        "to_version": found.to_version,
        "changes": [
            {
                "id": change.object_id,
                "before": None if change.before is None else object_to_json(change.before),
                "after": None if change.after is None else object_to_json(change.after),
                "fields": list(change.fields),
                "merged_into": change.merged_into or None,
            }
            for change in found.changes
        ],
    }


def _verdict(name: str, found: Verification) -> str:
    start = f"{name}: version {found.version}, {found.steps} steps rebuilt, {found.snapshots} snapshots compared: "
    if found.holds:
        return f"{start}the same, bit for bit ({found.state_hash[:16]})"
    wrong = []
    if found.state_hash != found.rebuilt_hash:
        wrong.append(f"in use {found.state_hash[:16]}, rebuilt {found.rebuilt_hash[:16]}")
    if found.differing_versions:
        wrong.append("snapshots that differ at version " + ", ".join(map(str, found.differing_versions)))
    return f"{start}NOT the same: {'; '.join(wrong)}"


def _change_line(change: ObjectChange) -> str:
    if change.after is None:
        gone = change.before
        into = f" (merged into {change.merged_into})" if change.merged_into else ""
        return f"- {object_line(gone) if gone else change.object_id}{into}"
    if change.before is None:
        return f"+ {object_line(change.after)}"
    renamed = f" (was {change.before.label})" if change.before.label != change.after.label else ""
    return f"~ {object_line(change.after)}{renamed}: {', '.join(change.fields)}"
