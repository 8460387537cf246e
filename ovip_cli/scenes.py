"""`ovip scenes`: what is mapped."""

from __future__ import annotations

import asyncio

from ovip.client import Addresses, AsyncClient
from ovip.jsonable import to_json
from ovip.scene.answers import SceneSummary
from ovip_cli.stacks import DataDir, Json, Standalone, print_json, stack_for


def scenes(standalone: Standalone = False, data_dir: DataDir = None, json: Json = False) -> None:
    """List the scenes of a stack."""
    with stack_for(standalone, data_dir) as addresses:
        found = asyncio.run(_scenes(addresses))
    if json:
        print_json({"scenes": to_json(found)})
        return
    print(f"{'scene':24} {'version':>8} {'objects':>8} {'frames':>8} {'detections':>11}")
    for s in found:
        print(f"{s.scene:24} {s.map_version:8} {s.objects:8} {s.frames:8} {s.detections:11}")


async def _scenes(addresses: Addresses) -> list[SceneSummary]:
    async with AsyncClient(addresses) as client:
        return await client.mapper.list_scenes()
