"""`ovip edit`: an operator's changes to a map, made on a version of it that the operator saw."""

from __future__ import annotations

import asyncio
import getpass
from typing import Annotated

import numpy as np
import typer

from ovip.client import Addresses, AsyncClient
from ovip.errors import NotFound
from ovip.jsonable import to_json
from ovip.scene.edits import Delete, Edit, Merge, Pin, Rename, Split
from ovip.scene.types import MapDelta, MapObject
from ovip_cli.object_words import object_line
from ovip_cli.stacks import DataDir, Json, SceneName, Standalone, print_json, stack_for

app = typer.Typer(
    help="Change a map: an edit survives whatever is detected later; made on an older map than this one, "
    "it is refused where its objects have changed.",
    no_args_is_help=True,
)
ObjectId = Annotated[
    str, typer.Argument(metavar="ID", help="an object's id, as `ovip scenes show` prints it")
]
MadeOn = Annotated[
    int, typer.Option("--made-on", min=0, help="map version that you saw; 0: the one read and shown now")
]
Operator = Annotated[str, typer.Option(help="who edits, kept in the log; else the login name")]


@app.callback()
def edit(context: typer.Context, scene: SceneName) -> None:
    """Rename, merge, split, delete or pin objects of SCENE."""
    context.obj = scene


@app.command("rename")
def rename(
    context: typer.Context,
    object_id: ObjectId,
    label: Annotated[str, typer.Argument(help="the new label; '' lets the detections decide again")],
    made_on: MadeOn = 0,
    operator: Operator = "",
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Call an object LABEL from now on."""
    _edit(context.obj, Rename(object_id, label), [object_id], made_on, operator, standalone, data_dir, json)


@app.command("merge")
def merge(
    context: typer.Context,
    keep_id: ObjectId,
    merged_ids: Annotated[
        list[str], typer.Argument(metavar="ID...", help="the objects that are the same thing")
    ],
    made_on: MadeOn = 0,
    operator: Operator = "",
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Make several objects one, known by the first id."""
    edit = Merge(keep_id, tuple(merged_ids))
    _edit(context.obj, edit, [keep_id, *merged_ids], made_on, operator, standalone, data_dir, json)


@app.command("split")
def split(
    context: typer.Context,
    object_id: ObjectId,
    box: Annotated[
        tuple[float, float, float, float, float, float],
        typer.Option("--box", help="low, then high corner of the part, world metres"),
    ],
    label: Annotated[str, typer.Option(help="what the part is called; else as the whole")] = "",
    made_on: MadeOn = 0,
    operator: Operator = "",
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Make what of an object lies in a box an object of its own."""
    edit = Split(object_id, np.array(box), label)
    _edit(context.obj, edit, [object_id], made_on, operator, standalone, data_dir, json)


@app.command("delete")
def delete(
    context: typer.Context,
    object_id: ObjectId,
    made_on: MadeOn = 0,
    operator: Operator = "",
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Say that there is no such thing, whatever is detected there."""
    _edit(context.obj, Delete(object_id), [object_id], made_on, operator, standalone, data_dir, json)


@app.command("pin")
def pin(
    context: typer.Context,
    object_id: ObjectId,
    off: Annotated[bool, typer.Option("--off", help="let upkeep touch it again")] = False,
    made_on: MadeOn = 0,
    operator: Operator = "",
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Keep upkeep from merging an object away or giving it up."""
    _edit(context.obj, Pin(object_id, not off), [object_id], made_on, operator, standalone, data_dir, json)


def _edit(
    scene: str,
    edit: Edit,
    object_ids: list[str],
    made_on: int,
    operator: str,
    standalone: bool,
    data_dir: DataDir,
    json: bool,
) -> None:
    operator = operator or getpass.getuser()
    with stack_for(standalone, data_dir) as addresses:
        seen, version, delta = asyncio.run(_do(addresses, scene, edit, object_ids, made_on, operator))
    if json:
        edited = {"scene": scene, "operator": operator, "made_on_version": version, "delta": to_json(delta)}
        print_json(edited)
        return
    print(f"{scene} at version {version}:")
    for o in seen:
        print(f"  {object_line(o)}")
    print(f"version {delta.version}: {_delta_words(delta)}")


async def _do(
    addresses: Addresses, scene: str, edit: Edit, object_ids: list[str], made_on: int, operator: str
) -> tuple[list[MapObject], int, MapDelta]:
    """The objects as they are, the version that the edit was made on, and what it changed.

    The version is read before the objects: what changes in between is a conflict, never an edit unseen.
    """
    async with AsyncClient(addresses) as client:
        version = made_on or await _version(client, scene)
        seen = [await client.mapper.get_object(scene, object_id) for object_id in object_ids]
        return seen, version, await client.edit_map(scene, edit, version, operator)


async def _version(client: AsyncClient, scene: str) -> int:
    known = await client.mapper.list_scenes()
    for summary in known:
        if summary.scene == scene:
            return summary.map_version
    names = ", ".join(summary.scene for summary in known) or "none yet"
    raise NotFound(f"there is no scene {scene!r}; known: {names}")


def _delta_words(delta: MapDelta) -> str:
    words = [f"{lost} is now {kept}" for lost, kept in delta.aliases.items()]
    for verb, ids in (("created", delta.created), ("updated", delta.updated), ("removed", delta.removed)):
        if ids:
            words.append(f"{verb} {', '.join(ids)}")
    return "; ".join(words) or "nothing changed"
