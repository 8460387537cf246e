"""`ovip export`: a scene as a file, as the api gives it."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ovip_cli.fetching import fetch, write_whole
from ovip_cli.stacks import DataDir, Json, Scene, Standalone, print_json, stack_for


class Format(StrEnum):
    SCENE_GRAPH = "scene-graph"
    PLY = "ply"
    REGIONS = "regions"
    NAV2 = "nav2"
    FLOORPLAN = "floorplan"


_PATHS = {
    Format.SCENE_GRAPH: "exports/scene-graph.json",
    Format.PLY: "exports/ply",
    Format.REGIONS: "exports/regions.json",
    Format.NAV2: "exports/nav2",
    Format.FLOORPLAN: "floorplan.png",
}


def export(
    scene: Scene,
    output: Annotated[Path, typer.Option("--output", "-o", help="file to write")],
    format: Annotated[
        Format,
        typer.Option(
            help="scene-graph: JSON; ply: coloured points; regions: polygons as JSON; nav2: a zip of maps for "
            "ROS 2 nav2; floorplan: a PNG of all floors"
        ),
    ] = Format.SCENE_GRAPH,
    standalone: Standalone = False,
    data_dir: DataDir = None,
    json: Json = False,
) -> None:
    """Write a scene's graph, its object points, its regions, or maps and plans of its floors."""
    with stack_for(standalone, data_dir) as addresses:
        data = fetch(addresses, scene, _PATHS[format])
    write_whole("--output", output, data)
    if json:
        print_json({"scene": scene, "format": format.value, "output": str(output), "bytes": len(data)})
    else:
        print(f"{output}: {len(data)} bytes")
