"""`ovip scenes join` and `align`: two recordings of one place, one map."""

from __future__ import annotations

import asyncio
import json as json_text
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ovip.client import Addresses, AsyncClient
from ovip.errors import InvalidInput
from ovip.ids import uuid7
from ovip.jsonable import to_json
from ovip.scene.types import F64, MapDelta
from ovip.scene.versions import Alignment
from ovip_cli.stacks import DataDir, Json, SceneName, Standalone, print_json, stack_for

OtherScene = Annotated[str, typer.Argument(metavar="OTHER", help="name of the other scene")]


def join(
    name: SceneName,
    other: OtherScene,
    transform: Annotated[
        Path | None,
        typer.Option(
            help="file with the 4x4 that takes OTHER's world to NAME's: 16 numbers, or JSON", dir_okay=False
        ),
    ] = None,
    align: Annotated[bool, typer.Option("--align", help="find the transform from the recordings")] = False,
    edit_id: Annotated[
        str, typer.Option(help="id of this join: given again, the map is not joined again")
    ] = "",
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Bring all objects of OTHER's map into NAME's by a known transform, or by one found from the shapes."""
    if (transform is None) == (not align):
        raise InvalidInput("expected either --transform FILE or --align")
    known = read_transform(transform) if transform else None
    with stack_for(standalone, data_dir) as addresses:
        delta, ids, alignment = asyncio.run(_join(addresses, name, other, known, edit_id or uuid7()))
    if json:
        found = None if alignment is None else to_json(alignment)
        print_json({"scene": name, "other": other, "delta": to_json(delta), "ids": ids, "alignment": found})
        return
    if alignment is not None:
        print(_quality(alignment))
    new = len(delta.created)
    print(
        f"{name}: version {delta.version}: {len(ids)} objects of {other} came in, {new} of them new, "
        f"{len(ids) - new} into objects that were here"
    )


def align(
    name: SceneName,
    other: OtherScene,
    guess: Annotated[
        Path | None, typer.Option(help="file with a first 4x4; else found from the shapes", dir_okay=False)
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="file to write the 4x4 to, for join --transform")
    ] = None,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Find the transform that takes OTHER's world to NAME's, where both recorded one place."""
    first = read_transform(guess) if guess else None
    with stack_for(standalone, data_dir) as addresses:
        found = asyncio.run(_align(addresses, name, other, first))
    if output is not None:
        _write_transform(output, found.world_from_other)
    if json:
        print_json({"scene": name, "other": other, **to_json(found)})
        return
    print(_quality(found))
    for row in found.world_from_other:
        print("  ".join(f"{number:10.6f}" for number in row))


def read_transform(path: Path) -> F64:
    """`(4, 4)` from 16 numbers between blanks, a JSON list, or the JSON that `ovip scenes align --json` prints."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be read: {error.strerror}") from error
    try:
        matrix = np.array(_numbers(text), dtype=np.float64)
    except (ValueError, TypeError) as error:
        raise InvalidInput(f"{path}: expected the 16 numbers of a 4x4, got {text[:60]!r}") from error
    if matrix.size != 16:
        raise InvalidInput(f"{path}: expected the 16 numbers of a 4x4, got {matrix.size}")
    return matrix.reshape(4, 4)


def _numbers(text: str) -> Any:
    try:
        value = json_text.loads(text)
    except json_text.JSONDecodeError:
        return text.split()
    return value.get("world_from_other") if isinstance(value, dict) else value


def _write_transform(path: Path, matrix: F64) -> None:
    try:
        path.write_text(json_text.dumps(matrix.tolist()), encoding="utf-8")
    except OSError as error:
        raise InvalidInput(f"--output: {path} cannot be written: {error.strerror}") from error


async def _join(
    addresses: Addresses, name: str, other: str, known: F64 | None, edit_id: str
) -> tuple[MapDelta, dict[str, str], Alignment | None]:
    async with AsyncClient(addresses) as client:
        alignment = await client.mapper.align(name, other) if known is None else None
        transform = known if alignment is None else alignment.world_from_other
        assert transform is not None  # one of the two is there
        delta, ids = await client.mapper.join(name, other, transform, edit_id)
        return delta, ids, alignment


async def _align(addresses: Addresses, name: str, other: str, guess: F64 | None) -> Alignment:
    async with AsyncClient(addresses) as client:
        return await client.mapper.align(name, other, guess)


def _quality(found: Alignment) -> str:
    return f"aligned: {100 * found.overlap:.0f} % of the smaller surface lies on the other, rmse {found.rmse:.3f} m"
