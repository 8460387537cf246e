"""An operator at the command line over a real mapper: look, edit, look back, compare, prove, join."""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from ovip.client import Addresses, AsyncClient
from ovip.errors import Conflict, InvalidInput, OvipError
from ovip.scene.types import SceneMap
from ovip.store import Store
from ovip_cli.app import app
from services.mapper.__main__ import serve
from tests.builders import random_run
from tests.integration.mappers import OTHER, RUN, SCENE, SETTINGS, map_at, shifted, write


class Operator:
    """`ovip` over one stack."""

    def __init__(self, data_dir: Path) -> None:
        self._data_dir = data_dir

    async def run(self, *words: str) -> Result:
        command = [*words, "--data-dir", str(self._data_dir)]
        return await asyncio.to_thread(CliRunner().invoke, app, command)

    async def json(self, *words: str) -> Any:
        result = await self.run(*words, "--json")
        assert result.exit_code == 0, result.exception
        return json.loads(result.stdout)

    async def refusal(self, *words: str) -> OvipError:
        result = await self.run(*words)
        assert isinstance(result.exception, OvipError)
        return result.exception


@pytest.fixture
async def address(store: Store) -> AsyncIterator[str]:
    async with serve(SETTINGS, store) as port:
        yield f"127.0.0.1:{port}"


@pytest.fixture
async def kitchen(store: Store, address: str) -> SceneMap:
    """The map of twenty frames, and another of eight."""
    newest, there = await write(store, RUN), await write(store, random_run(11, 8), OTHER)
    async with AsyncClient(Addresses(mapper=address)) as client:
        await map_at(client.mapper, there, OTHER)
        return await map_at(client.mapper, newest)


@pytest.fixture
async def operator(address: str, kitchen: SceneMap, tmp_path: Path) -> Operator:
    names = ("perception", "mapper", "regions", "retrieval", "api")
    stack = {"pid": os.getpid(), "addresses": dict.fromkeys(names, address), "api_key": ""}
    (tmp_path / "stack.json").write_text(json.dumps(stack))
    return Operator(tmp_path)


async def test_a_renamed_object_is_shown_so_now_and_otherwise_before(
    operator: Operator, kitchen: SceneMap
) -> None:
    name = kitchen.objects[0].object_id
    done = await operator.json("edit", SCENE, "rename", name, "teapot")
    now = await operator.json("scenes", "show", SCENE)
    then = await operator.json("scenes", "show", SCENE, "--at", str(kitchen.version))
    changed = await operator.json(
        "scenes", "diff", SCENE, str(kitchen.version), str(done["delta"]["version"])
    )

    labels = {o["id"]: (o["label"], o["label_given"]) for o in now["objects"]}
    assert labels[name] == ("teapot", True)
    assert then["state_hash"] == kitchen.state_hash
    assert {o["id"]: o["label"] for o in then["objects"]}[name] == kitchen.objects[0].label
    (change,) = changed["changes"]
    assert (change["id"], change["after"]["label"]) == (name, "teapot")
    assert "label" in change["fields"]


async def test_an_edit_made_on_a_map_that_has_gone_on_is_refused_and_the_map_stays(
    operator: Operator, kitchen: SceneMap
) -> None:
    name = kitchen.objects[0].object_id
    await operator.json("edit", SCENE, "rename", name, "teapot")
    before = await operator.json("scenes", "show", SCENE)

    refused = await operator.refusal("edit", SCENE, "delete", name, "--made-on", str(kitchen.version))

    assert isinstance(refused, Conflict)
    assert name in str(refused)
    assert (await operator.json("scenes", "show", SCENE))["state_hash"] == before["state_hash"]


async def test_objects_are_merged_split_pinned_and_deleted_and_the_log_makes_the_same_map_again(
    operator: Operator, kitchen: SceneMap
) -> None:
    first, second, third = (o.object_id for o in kitchen.objects[:3])
    low, high = kitchen.objects[2].box[:3], kitchen.objects[2].box[3:]
    half = np.concatenate([low, [(low[0] + high[0]) / 2, *high[1:]]])

    merged = await operator.json("edit", SCENE, "merge", first, second)
    part = await operator.json("edit", SCENE, "split", third, "--label", "lid", "--box", *map(str, half))
    await operator.json("edit", SCENE, "pin", first)
    removed = await operator.json("edit", SCENE, "delete", third)
    shown = await operator.json("scenes", "show", SCENE, "--unconfirmed")
    proof = await operator.run("scenes", "verify", SCENE)

    assert merged["delta"]["aliases"] == {second: first}
    (lid,) = part["delta"]["created"]
    assert removed["delta"]["removed"] == [third]
    by_id = {o["id"]: o for o in shown["objects"]}
    assert second not in by_id
    assert third not in by_id
    assert by_id[first]["pinned"]
    assert by_id[lid]["label"] == "lid"
    assert proof.exit_code == 0
    assert "the same, bit for bit" in proof.stdout


async def test_another_map_is_joined_once_however_often_it_is_asked_for(
    operator: Operator, kitchen: SceneMap, tmp_path: Path
) -> None:
    np.savetxt(tmp_path / "far.txt", shifted(50.0))
    words = ("scenes", "join", SCENE, OTHER, "--transform", str(tmp_path / "far.txt"), "--edit-id", "j1")
    there = await operator.json("scenes", "show", OTHER)

    first, again = await operator.json(*words), await operator.json(*words)
    now = await operator.json("scenes", "show", SCENE)

    assert first == again
    assert {o["id"] for o in there["objects"]} <= set(first["ids"])
    assert len(now["objects"]) == len(kitchen.objects) + len(there["objects"])
    assert (await operator.run("scenes", "verify", SCENE)).exit_code == 0


async def test_a_version_that_never_was_is_refused_in_words(operator: Operator, kitchen: SceneMap) -> None:
    refused = await operator.refusal("scenes", "show", SCENE, "--at", "99999")

    assert isinstance(refused, InvalidInput)
    assert str(kitchen.version) in str(refused)
