"""`ovip export`: a scene as a file, as the api gives it."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated
from urllib.parse import quote

import httpx
import typer

from ovip.client import Addresses
from ovip.errors import InvalidInput, Unavailable, from_status
from ovip_cli.stacks import DataDir, Json, Scene, Standalone, print_json, stack_for


class Format(StrEnum):
    SCENE_GRAPH = "scene-graph"
    PLY = "ply"


_PATHS = {Format.SCENE_GRAPH: "scene-graph.json", Format.PLY: "ply"}


def export(
    scene: Scene,
    output: Annotated[Path, typer.Option("--output", "-o", help="file to write")],
    format: Annotated[
        Format, typer.Option(help="scene-graph: JSON; ply: coloured points")
    ] = Format.SCENE_GRAPH,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Write a scene's graph as JSON, or its object points as PLY."""
    with stack_for(standalone, data_dir) as addresses:
        data = _download(addresses, scene, format)
    try:
        output.write_bytes(data)
    except OSError as error:
        raise InvalidInput(f"--output: {output} cannot be written: {error.strerror}") from error
    if json:
        print_json({"scene": scene, "format": format.value, "output": str(output), "bytes": len(data)})
    else:
        print(f"{output}: {len(data)} bytes")


def _download(addresses: Addresses, scene: str, format: Format) -> bytes:
    headers = {"authorization": f"Bearer {addresses.api_key}"} if addresses.api_key else {}
    url = f"http://{addresses.api}/v1/scenes/{quote(scene, safe='')}/exports/{_PATHS[format]}"
    try:
        reply = httpx.get(url, headers=headers, timeout=120.0, trust_env=False)
    except httpx.HTTPError as error:
        raise Unavailable(f"the api at {addresses.api} cannot be reached: {error}") from error
    if reply.is_error:
        problem = reply.json() if "json" in reply.headers.get("content-type", "") else {}
        slug = str(problem.get("type", "")).rpartition(":")[2]
        raise from_status("UNKNOWN", str(problem.get("detail", reply.reason_phrase)), slug)
    return reply.content
