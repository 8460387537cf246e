"""Regions over gRPC, wired as it is when deployed, with nobody else there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from ovip.clients import RegionsClient, connect
from ovip.errors import NotFound
from ovip.store import Store
from services.regions.__main__ import serve
from services.regions.config import Settings
from services.regions.domain.partition import Growth
from services.regions.shelf import STAGE, Answered, Shelf
from tests.unit.services.regions.rooms import two_rooms
from tests.unit.services.regions.test_service import cut_of

SCENE = "home"
NOWHERE = "127.0.0.1:9"


def settings(tmp_path: Path) -> Settings:
    return Settings(
        data_dir=tmp_path,
        regions_port=0,
        mapper_address=NOWHERE,
        perception_address=NOWHERE,
        vlm_gateway_address=NOWHERE,
        _env_file=None,
    )


async def test_the_client_reads_what_the_store_holds(store: Store, tmp_path: Path) -> None:
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "test", 30.0)
    assert lease is not None
    cut = cut_of(two_rooms())
    await Shelf(store).save_answered(lease, 1, Answered(cut, "0-0", 0))
    async with serve(settings(tmp_path), store) as port, connect(f"127.0.0.1:{port}") as channel:
        client = RegionsClient(channel)
        partition = await client.get_partition(SCENE)
        grid = await client.get_floor_grid(SCENE, 0)
        with pytest.raises(NotFound, match="attic"):
            await client.get_partition("attic")
        with pytest.raises(NotFound, match="floors 0 to 0"):
            await client.get_floor_grid(SCENE, 4)
    assert [(r.region_id, r.display_name) for r in partition.regions] == [("r1", "unknown")]
    assert partition.regions[0].area == pytest.approx(cut.partition.regions[0].area)
    assert grid.region_ids == ("r1",)
    assert grid.regions.tolist() == cut.grids[0].regions.tolist()


async def test_a_scene_without_a_partition_answers_with_an_empty_one(store: Store, tmp_path: Path) -> None:
    await store.add_scene(SCENE)
    async with serve(settings(tmp_path), store) as port, connect(f"127.0.0.1:{port}") as channel:
        assert (await RegionsClient(channel).get_partition(SCENE)).revision == 0


async def test_a_watcher_gets_the_newest_partition_and_then_each_new_one(
    store: Store, tmp_path: Path
) -> None:
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "test", 30.0)
    assert lease is not None
    first = cut_of(two_rooms())
    later = replace(first, partition=replace(first.partition, revision=first.partition.revision + 1))
    await Shelf(store).save_answered(lease, 1, Answered(first, "0-0", 0))
    async with serve(settings(tmp_path), store) as port, connect(f"127.0.0.1:{port}") as channel:
        client = RegionsClient(channel)
        watched = client.watch(SCENE)
        assert (await anext(watched)).revision == first.partition.revision
        await Shelf(store).save_answered(lease, 2, Answered(later, "0-0", 0))
        assert (await anext(watched)).revision == later.partition.revision
        with pytest.raises(NotFound, match="attic"):
            await anext(client.watch("attic"))


def test_the_numbers_of_the_partition_come_from_the_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    params = Settings(_env_file=None).partition
    assert params.growth is Growth.DISTANCE
    monkeypatch.setenv("OVIP_REGIONS_GROWTH", "clearance")
    monkeypatch.setenv("OVIP_REGIONS_DILATION", "6")
    monkeypatch.setenv("OVIP_REGIONS_PORT", "0")
    assert Settings(_env_file=None).partition == replace(params, growth=Growth.CLEARANCE, dilation=6)
    assert Settings(_env_file=None).port == 0
