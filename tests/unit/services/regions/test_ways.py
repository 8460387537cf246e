"""Ways over gRPC: what the store holds is walked on, by both clients, whoever asks."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import AsyncIterator
from dataclasses import replace

import numpy as np
import pytest
import pytest_asyncio

from ovip.client import Addresses, AsyncClient, Client
from ovip.clients import RegionsClient, connect
from ovip.errors import InvalidInput, NotFound
from ovip.scene.grid import OCCUPIED
from ovip.scene.navigation import inflated, plan_route
from ovip.scene.route_graph import route_graph
from ovip.serving import grpc_server
from ovip.store import Store
from services.regions.domain.assembly import Cut
from services.regions.server import SERVICE_NAME, register
from services.regions.service import Regions
from services.regions.shelf import STAGE, Answered, Shelf
from tests.builders import same
from tests.unit.ovip.scene.buildings import building, door, stairs, storey

SCENE = "home"
DOWN = storey("hhhh#kkkk", "hhhhhkkkk", "hhhh#kkkk")
UP = storey("bbbbbbbbb", floor=1)
EDGES = [door("h", "k", 2.5, 0.75), stairs("h", "b", (0.25, 0.25, 0.0), (4.25, 0.25, 3.0))]
HOME = building([DOWN, UP], EDGES)
KITCHEN, BEDROOM = np.array([4.25, 0.75, 0.0]), np.array([0.25, 0.25, 3.0])


async def publish(store: Store, home: tuple, step: int) -> None:
    """Puts a building into the store as the newest partition."""
    partition, grids = home
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "test", 30.0)
    assert lease is not None
    cut = replace(Cut.none(), partition=partition, grids=tuple(grids.values()))
    await Shelf(store).save_answered(lease, step, Answered(cut, "0-0", 0))


@pytest_asyncio.fixture
async def address(store: Store) -> AsyncIterator[str]:
    await publish(store, HOME, 1)
    serving = functools.partial(register, Regions(store, 1.0, robot_radius=0.2))
    async with grpc_server("regions", SERVICE_NAME, serving, "127.0.0.1", 0, None) as port:
        yield f"127.0.0.1:{port}"


async def test_the_grid_is_inflated_by_the_radius_asked_for(address: str) -> None:
    async with connect(address) as channel:
        client = RegionsClient(channel)
        plain = await client.get_floor_grid(SCENE, 0)
        for_robot = await client.get_floor_grid(SCENE, 0, robot_radius=0.3)
        assert plain.occupancy.tolist() == DOWN.occupancy.tolist()
        assert for_robot.occupancy.tolist() == inflated(DOWN, 0.3).occupancy.tolist()
        assert (for_robot.occupancy == OCCUPIED).sum() > (plain.occupancy == OCCUPIED).sum()
        for radius in (-0.1, 2.5, float("nan"), float("inf")):
            with pytest.raises(InvalidInput, match="0 to 2 metres"):
                await client.get_floor_grid(SCENE, 0, robot_radius=radius)


async def test_a_way_over_the_stairs_is_planned_where_the_store_has_them(address: str) -> None:
    async with connect(address) as channel:
        route = await RegionsClient(channel).plan_route(SCENE, KITCHEN, BEDROOM)
    assert same(route, plan_route(*HOME, KITCHEN, BEDROOM, 0.2))
    assert route.region_ids == ("rk", "rh", "rb")


async def test_a_robot_that_names_no_radius_has_that_of_the_setting(address: str) -> None:
    async with connect(address) as channel:
        client = RegionsClient(channel)
        assert len((await client.plan_route(SCENE, KITCHEN, BEDROOM)).path)
        wide = await client.plan_route(SCENE, KITCHEN, BEDROOM, robot_radius=0.4)
        assert "needs 0.80 m" in wide.why
        with pytest.raises(InvalidInput, match="0 to 2 metres"):
            await client.plan_route(SCENE, KITCHEN, BEDROOM, robot_radius=-1.0)
        with pytest.raises(InvalidInput, match="finite"):
            await client.plan_route(SCENE, KITCHEN, np.array([np.nan, 0, 0]))
        with pytest.raises(NotFound, match="attic"):
            await client.plan_route("attic", KITCHEN, BEDROOM)


async def test_the_graph_of_passages_is_served(address: str) -> None:
    async with connect(address) as channel:
        client = RegionsClient(channel)
        assert same(await client.get_route_graph(SCENE), route_graph(*HOME, 0.2))
        assert same(await client.get_route_graph(SCENE, robot_radius=0.4), route_graph(*HOME, 0.4))
        with pytest.raises(NotFound, match="attic"):
            await client.get_route_graph("attic")


async def test_a_new_partition_is_walked_on_at_once(store: Store, address: str) -> None:
    regions = Regions(store, 1.0, robot_radius=0.2)
    assert len((await regions.route(SCENE, KITCHEN, BEDROOM)).path)
    partition, grids = building([DOWN, UP], EDGES[:1])
    await publish(store, (replace(partition, revision=4), grids), 2)
    after = await regions.route(SCENE, KITCHEN, BEDROOM)
    assert (after.why, after.revision) == ("no stairs that were seen lead from floor 0 to floor 1", 4)


async def test_before_the_first_partition_there_is_no_way_and_an_empty_graph(store: Store) -> None:
    await store.add_scene(SCENE)
    regions = Regions(store, 1.0)
    assert (await regions.route(SCENE, KITCHEN, BEDROOM)).why == "the scene has no floor grid yet"
    assert not (await regions.route_graph(SCENE)).nodes


async def test_both_clients_ask_for_ways_alike(address: str) -> None:
    def synchronously() -> tuple:
        with Client(Addresses(regions=address)) as client:
            return client.route(SCENE, KITCHEN, BEDROOM, 0.2), client.route_graph(SCENE, 0.2)

    async with AsyncClient(Addresses(regions=address)) as client:
        mine = await client.route(SCENE, KITCHEN, BEDROOM, 0.2), await client.route_graph(SCENE, 0.2)
    assert same(mine, await asyncio.to_thread(synchronously))
    assert same(mine[0], plan_route(*HOME, KITCHEN, BEDROOM, 0.2))
