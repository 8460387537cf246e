from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from ovip.errors import Conflict, Corrupt, NotFound
from ovip.scene.answers import Answer, Candidate, Outcome, Query, TierReport, TierResult
from ovip.scene.types import Box2
from ovip.store import Store
from services.retrieval.adapters.searches import StoredSearches, decode_search, encode_search
from services.retrieval.domain.coverage import View
from services.retrieval.domain.goals import NO_PATH
from services.retrieval.domain.search import Phase, Search, Waypoint
from services.retrieval.domain.votes import sight
from services.retrieval.ports import StoredSearch
from tests.unit.services.retrieval.builders import detection, pose_at


def full_search() -> Search:
    rejected = Candidate("cup", np.array([1.0, 2, 3]), 0.5, "too red", "o1", None, "f1", Box2(1, 2, 3, 4))
    account = Answer(
        Outcome.UNRESOLVED,
        4,
        None,
        None,
        NO_PATH,
        (TierReport(1, TierResult.MISSING, "no", 0, 1.5),),
        rejected=(rejected,),
        fallbacks=("priors: table",),
        map_version=7,
    )
    feature = np.array([0.6, 0.8], np.float32)
    return Search(
        search_id="s1",
        query=Query("home", "white mug", pose_at(1, 2, 0.5), 0.3, "kitchen", 1, 4, 5, 60),
        phase=Phase.SEARCHING,
        account=account,
        vlm_calls=3,
        priors={"r1": 0.8},
        waypoints=(Waypoint("w000", "r1", 0, np.array([1.0, 2.0, 0.0])),),
        seen={"w000.1": "f9", "w000.0": "f8"},
        unreachable=frozenset({"w000.2"}),
        views=(View(0, 1.0, 2.0, 0.5, 1.0),),
        sightings=(sight("f9", detection("cup", 0.3, 0.4, 0.5, feature=feature)),),
        place=np.array([1.0, 2.0, 0.0]),
        floor=0,
        budget=60,
    )


def test_a_search_is_plain_json_and_comes_back_whole() -> None:
    search = full_search()
    data = encode_search(search)
    assert json.loads(data)["format"] == 1
    back = decode_search(data)
    assert encode_search(back) == data
    assert back.query.text == "white mug"
    assert back.query.robot_pose is not None
    np.testing.assert_allclose(back.query.robot_pose, pose_at(1, 2, 0.5))
    assert list(back.seen or {}) == ["w000.1", "w000.0"]
    assert back.account.rejected[0].why == "too red"
    np.testing.assert_array_equal(back.sightings[0].feature, search.sightings[0].feature)
    assert back.sightings[0].voxels == search.sightings[0].voxels


def test_an_unknown_format_is_refused() -> None:
    with pytest.raises(Corrupt, match="format 1"):
        decode_search(b'{"format": 99}')


async def test_saving_on_an_old_revision_is_a_conflict(store: Store) -> None:
    searches = StoredSearches(store, 60.0)
    first = await searches.save(StoredSearch("home", full_search(), 0))
    await searches.save(replace(first, search=replace(first.search, vlm_calls=4)))
    with pytest.raises(Conflict):
        await searches.save(first)
    loaded = await searches.load("home", "s1")
    assert loaded.search.vlm_calls == 4
    assert loaded.revision == 2


async def test_a_search_that_is_not_there_is_not_found(store: Store) -> None:
    with pytest.raises(NotFound, match="nowhere"):
        await StoredSearches(store, 60.0).load("home", "nowhere")


async def test_a_plain_answer_is_remembered_for_a_while(store: Store) -> None:
    searches = StoredSearches(store, 60.0)
    assert await searches.recall("home", "s2") is None
    await searches.remember("home", "s2", "mug", full_search().account)
    kept = await searches.recall("home", "s2")
    assert kept is not None
    assert kept[0] == "mug"
    assert kept[1].map_version == 7
    assert await searches.recall("elsewhere", "s2") is None
