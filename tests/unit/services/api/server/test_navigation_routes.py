"""Ways through a scene over HTTP."""

from __future__ import annotations

import functools
from dataclasses import replace

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from ovip.clients import RegionsClient, connect
from ovip.serving import grpc_server
from ovip.store import Store
from services.api.service import SceneService
from services.regions.domain.assembly import Cut
from services.regions.server import SERVICE_NAME, register
from services.regions.service import Regions
from services.regions.shelf import STAGE, Answered, Shelf
from tests.unit.ovip.scene.buildings import building, door, stairs, storey
from tests.unit.services.api.flat import SCENE, Flat, backends_of

BASE = "/v1/scenes/flat"
ACROSS = {"from": "3.0,4.5,0", "to": "6.5,5.0,0", "radius": "0.15"}


async def test_a_route_leads_from_room_to_room(client: httpx.AsyncClient) -> None:
    body = (await client.get(f"{BASE}/route", params=ACROSS)).json()
    assert body["region_ids"] == ["r-living", "r-kitchen"]
    assert body["why"] == ""
    assert body["regions_revision"] == 3
    assert body["length"] == pytest.approx(
        float(np.linalg.norm(np.diff(body["path"], axis=0), axis=1).sum()), abs=1e-3
    )
    assert 3.5 < body["length"] < 5.0


async def test_no_way_is_an_answer_with_a_reason(client: httpx.AsyncClient) -> None:
    reply = await client.get(f"{BASE}/route", params={**ACROSS, "radius": "0.6"})
    assert reply.status_code == 200
    assert reply.json()["path"] == []
    assert "a robot of 0.60 m radius needs 1.20 m" in reply.json()["why"]


async def test_a_route_is_asked_for_and_told_in_the_recordings_frame(client: httpx.AsyncClient) -> None:
    world = (await client.get(f"{BASE}/route", params=ACROSS)).json()
    source = (
        await client.get(
            f"{BASE}/route",
            params={**ACROSS, "from": "3.0,-0.5,-4.5", "to": "6.5,-0.5,-5.0", "frame": "source"},
        )
    ).json()
    assert source["frame"] == "source"
    x, y, z = np.array(world["path"]).T
    np.testing.assert_allclose(source["path"], np.column_stack([x, z - 0.5, -y]), atol=1e-3)


@pytest.mark.parametrize(
    ("changed", "status", "says"),
    [
        ({"from": "1,2"}, 422, "from: expected three numbers"),
        ({"to": "1,2,up"}, 422, "to: expected three numbers"),
        ({"to": "1,2,nan"}, 422, "to: expected three numbers"),
        ({"radius": "-1"}, 422, "radius"),
        ({"radius": "2.5"}, 422, "radius"),
    ],
)
async def test_what_is_no_point_or_no_radius_is_a_problem(
    client: httpx.AsyncClient, changed: dict[str, str], status: int, says: str
) -> None:
    reply = await client.get(f"{BASE}/route", params={**ACROSS, **changed})
    assert reply.status_code == status
    assert reply.headers["content-type"] == "application/problem+json"
    assert says in reply.json()["detail"]


async def test_a_route_without_ends_and_an_unknown_scene_are_problems(client: httpx.AsyncClient) -> None:
    missing = await client.get(f"{BASE}/route")
    assert (missing.status_code, missing.headers["content-type"]) == (422, "application/problem+json")
    for path in ("route", "route-graph"):
        unknown = await client.get(f"/v1/scenes/attic/{path}", params=ACROSS)
        assert (unknown.status_code, unknown.json()["type"]) == (404, "urn:ovip:problem:not-found")


async def test_the_whole_way_from_the_store_to_http(app: FastAPI, home: Flat, store: Store) -> None:
    lower = storey("hhhh#kkkk", "hhhhhkkkk", "hhhh#kkkk")
    upper = storey("bbbbbbbbb", floor=1)
    flight = stairs("h", "b", (0.25, 0.25, 0.0), (4.25, 0.25, 3.0))
    partition, grids = building([lower, upper], [door("h", "k", 2.5, 0.75), flight])
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "test", 30.0)
    assert lease is not None
    cut = replace(Cut.none(), partition=partition, grids=tuple(grids.values()))
    await Shelf(store).save_answered(lease, 1, Answered(cut, "0-0", 0))
    serving = functools.partial(register, Regions(store, 1.0, robot_radius=0.2))
    async with (
        grpc_server("regions", SERVICE_NAME, serving, "127.0.0.1", 0, None) as port,
        connect(f"127.0.0.1:{port}") as channel,
        httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://api") as asking,
    ):
        backends = replace(backends_of(home), regions=RegionsClient(channel))
        app.state.service = SceneService(backends)
        route = (
            await asking.get(f"{BASE}/route", params={"from": "4.25,0.75,0", "to": "0.25,0.25,3"})
        ).json()
        graph = (await asking.get(f"{BASE}/route-graph")).json()
    assert route["region_ids"] == ["rk", "rh", "rb"]
    assert [passage["kind"] for passage in route["passages"]] == ["doorway", "stairs"]
    assert route["passages"][1]["upper"] == [4.25, 0.25, 3.0]
    assert [node["floor"] for node in graph["nodes"]] == [0, 0, 1]
    assert [(k["a"], k["b"], k["region_id"]) for k in graph["links"]] == [(0, 1, "rh"), (1, 2, None)]
    assert graph["links"][1]["length"] == pytest.approx(5.0)
