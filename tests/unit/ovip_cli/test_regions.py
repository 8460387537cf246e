"""What `ovip regions` and `ovip export` fetch from an api over the flat, print and write."""

from __future__ import annotations

import asyncio
import contextlib
import io
import json
import os
import stat
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import cast

import grpc
import numpy as np
import pytest
import pytest_asyncio
from PIL import Image
from typer.testing import CliRunner, Result

from ovip.errors import InvalidInput, NotFound, Unavailable
from ovip.scene.types import Frontier, Partition, RegionEvent, RegionEventKind
from ovip.serving import grpc_server
from ovip.v1 import regions_pb2_grpc
from ovip_cli.app import app
from services.api.config import Settings
from services.api.server import create_app
from services.api.server.listening import listening
from services.api.service import SceneService
from services.regions.server import SERVICE_NAME, RegionsServicer
from services.regions.service import Regions
from tests.unit.services.api.flat import Flat, backends_of, flat

NAMES = ("perception", "mapper", "regions", "retrieval", "api")
Run = Callable[..., Awaitable[Result]]


class Recomputing:
    """Stands where the regions service stands: cuts the flat anew when asked to."""

    def __init__(self, home: Flat) -> None:
        self._home = home

    async def recompute(self, scene: str) -> Partition:
        self._home.check(scene)
        self._home.cut_anew()
        return self._home.partition()


@contextlib.asynccontextmanager
async def regions_port(home: Flat) -> AsyncIterator[int]:
    """A running regions server; yields its port."""

    def register(server: grpc.aio.Server) -> None:
        servicer = RegionsServicer(cast(Regions, Recomputing(home)))
        regions_pb2_grpc.add_RegionsServiceServicer_to_server(servicer, server)  # type: ignore[no-untyped-call]

    async with grpc_server("regions", SERVICE_NAME, register, "127.0.0.1", 0, None) as port:
        yield port


@pytest.fixture
def home() -> Flat:
    return flat()


@pytest_asyncio.fixture
async def ovip(home: Flat, tmp_path: Path) -> AsyncIterator[Run]:
    """Runs `ovip WORDS --data-dir ...` over a stack whose api answers with the flat."""
    stopping = asyncio.Event()
    api = create_app(SceneService(backends_of(home)), Settings(api_port=0, _env_file=None), stopping)
    async with listening(api, "127.0.0.1", 0, stopping) as port, regions_port(home) as regions:
        address = f"127.0.0.1:{port}"
        addresses = dict.fromkeys(NAMES, address) | {"regions": f"127.0.0.1:{regions}"}
        stack = {"pid": os.getpid(), "addresses": addresses, "api_key": ""}
        (tmp_path / "stack.json").write_text(json.dumps(stack))

        async def run(*words: str | Path) -> Result:
            command = [*map(str, words), "--data-dir", str(tmp_path)]
            return await asyncio.to_thread(CliRunner().invoke, app, command)

        yield run


async def test_floors_and_regions_are_listed_with_their_ways(ovip: Run, home: Flat) -> None:
    home.upstairs = True
    told = await ovip("regions", "flat")

    assert told.stdout.splitlines() == [
        "flat: map version 11, regions revision 3, 2 floors, 4 regions",
        "",
        "floor 0: 47.1 m² at 0.00 m, ceiling at 2.50 m",
        "  id         name         function          area  objects  ways",
        (
            "  r-living   living room  living room    29.4 m²        7  "
            "kitchen r-kitchen (doorway 0.9 m); storage r-attic (stairs 0.8 m)"
        ),
        "  r-kitchen  kitchen      kitchen         9.0 m²        7  living room r-living (doorway 0.9 m)",
        "  r-bath     bathroom     bathroom        8.7 m²        3  none",
        "",
        "floor 1: 20.0 m² at 2.70 m, no ceiling seen",
        "  id         name         function          area  objects  ways",
        "  r-attic    storage      storage        20.0 m²        0  living room r-living (stairs 0.8 m)",
    ]


async def test_what_is_unexplored_and_what_changed_is_said(ovip: Run, home: Flat) -> None:
    home.frontiers = (Frontier(0, "r-bath", np.array([7.9, 1.0, 0.0]), 1.25),)
    home.events = (
        RegionEvent(RegionEventKind.APPEARED, "r-bath", 0, "bathroom", "r-living"),
        RegionEvent(RegionEventKind.VANISHED, "r-hall", 0, "hallway"),
    )
    lines = (await ovip("regions", "flat")).stdout.splitlines()

    assert "  unexplored: 1.2 m at (7.90, 1.00), bathroom" in lines
    assert lines[-1] == "changed with this revision: bathroom appeared (was living room); hallway is gone"


async def test_json_is_what_the_api_says_and_what_was_written(ovip: Run, tmp_path: Path) -> None:
    plan = tmp_path / "plan.png"
    body = json.loads((await ovip("regions", "flat", "--plot", plan, "--scale", "40", "--json")).stdout)

    assert [region["region_id"] for region in body["regions"]] == ["r-living", "r-kitchen", "r-bath"]
    assert body["written"] == [str(plan)]


async def test_the_plan_shows_all_floors_side_by_side(ovip: Run, home: Flat, tmp_path: Path) -> None:
    one, both = tmp_path / "one.png", tmp_path / "both.png"
    await ovip("regions", "flat", "--plot", one)
    home.upstairs = True
    told = await ovip("regions", "flat", "--plot", both)

    assert told.stdout.splitlines()[-1] == f"wrote {both}"
    assert Image.open(both).width > Image.open(one).width + 5 * 80
    assert stat.S_IMODE(both.stat().st_mode) == 0o666 & ~_umask()


async def test_maps_for_nav2_polygons_and_grids_land_where_asked(
    ovip: Run, home: Flat, tmp_path: Path
) -> None:
    home.upstairs = True
    await ovip(
        *("regions", "flat", "--nav2", tmp_path / "a" / "maps", "--grid", tmp_path / "grids"),
        *("--polygons", tmp_path / "rooms.json"),
    )

    maps = sorted(os.listdir(tmp_path / "a" / "maps"))
    assert maps == ["floor-0.pgm", "floor-0.yaml", "floor-1.pgm", "floor-1.yaml"]
    assert (tmp_path / "a" / "maps" / "floor-1.pgm").read_bytes().startswith(b"P5\n104 84\n255\n")
    assert Image.open(tmp_path / "grids" / "floor-0-occupancy.png").size == (180, 140)
    assert json.loads((tmp_path / "grids" / "floor-1.json").read_text())["region_ids"] == ["r-attic"]
    assert json.loads((tmp_path / "rooms.json").read_text())["type"] == "FeatureCollection"


async def test_a_file_that_cannot_be_written_is_named_and_leaves_nothing_behind(
    ovip: Run, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("a file, no folder")
    there = sorted(os.listdir(tmp_path))

    for words in (
        ("regions", "flat", "--plot", tmp_path / "nowhere" / "plan.png"),
        ("regions", "flat", "--nav2", tmp_path / "file" / "maps"),
        ("export", "--scene", "flat", "--format", "nav2", "-o", tmp_path / "nowhere" / "maps.zip"),
    ):
        error = (await ovip(*words)).exception
        assert isinstance(error, InvalidInput)
        assert str(words[-1]) in str(error)
    assert sorted(os.listdir(tmp_path)) == there


async def test_what_was_there_before_stays_where_the_new_cannot_be_had(ovip: Run, tmp_path: Path) -> None:
    plan = tmp_path / "plan.png"
    plan.write_bytes(b"before")

    result = await ovip(
        "regions", "flat", "--plot", plan, "--scale", "400", "--polygons", tmp_path / "p.json"
    )
    refused = await ovip("regions", "attic", "--plot", plan)

    assert result.exit_code == 0
    assert plan.read_bytes() != b"before"
    assert isinstance(refused.exception, NotFound)
    assert Image.open(plan).size[0] > 3000


async def test_an_unknown_scene_and_one_without_regions_are_told(ovip: Run, home: Flat) -> None:
    unknown = (await ovip("regions", "attic")).exception
    home.regions = []
    none = (await ovip("regions", "flat", "--json")).exception

    assert isinstance(unknown, NotFound)
    assert "there are: flat" in str(unknown)
    assert isinstance(none, NotFound)
    assert "has no regions yet" in str(none)


async def test_no_stack_is_told(tmp_path: Path) -> None:
    stack = {"pid": os.getpid(), "addresses": dict.fromkeys(NAMES, "127.0.0.1:1"), "api_key": ""}
    (tmp_path / "stack.json").write_text(json.dumps(stack))
    command = ["regions", "flat", "--data-dir", str(tmp_path)]

    error = (await asyncio.to_thread(CliRunner().invoke, app, command)).exception

    assert isinstance(error, Unavailable)
    assert "127.0.0.1:1 cannot be reached" in str(error)


async def test_the_floors_are_cut_anew_before_they_are_shown(ovip: Run) -> None:
    told = await ovip("regions", "flat", "--recompute")
    unknown = await ovip("regions", "attic", "--recompute")

    assert told.stdout.startswith("flat: map version 11, regions revision 4, ")
    assert isinstance(unknown.exception, NotFound)


async def test_a_way_is_told_by_its_length_and_what_it_leads_through(ovip: Run) -> None:
    told = await ovip("regions", "flat", "--route", "3.5,4.0,0", "5.4,3.2,0", "--robot-radius", "0.2")
    wrong = await ovip("regions", "flat", "--route", "3.5,4.0", "5.4,3.2,0")

    length, corners = told.stdout.splitlines()[-2:]
    assert length.endswith(" m through living room, kitchen; by doorway 0.9 m")
    assert 1.9 < float(length.split()[0]) < 3.0
    assert corners.startswith("(3.5")
    assert corners.count(" -> ") >= 1
    assert isinstance(wrong.exception, InvalidInput)


@pytest.mark.parametrize(
    ("form", "start"),
    [
        ("scene-graph", b"{"),
        ("regions", b"{"),
        ("nav2", b"PK"),
        ("floorplan", b"\x89PNG"),
        ("ply", b"ply\n"),
    ],
)
async def test_every_format_is_exported(ovip: Run, tmp_path: Path, form: str, start: bytes) -> None:
    file = tmp_path / "scene.out"
    told = json.loads(
        (await ovip("export", "--scene", "flat", "--format", form, "-o", file, "--json")).stdout
    )

    data = file.read_bytes()
    assert data.startswith(start)
    assert told == {"scene": "flat", "format": form, "output": str(file), "bytes": len(data)}
    assert form != "floorplan" or Image.open(io.BytesIO(data)).size[0] > 640


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
