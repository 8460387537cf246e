"""Scenes, objects, regions and the graph over HTTP."""

from __future__ import annotations

import httpx
import numpy as np
import pytest

from ovip.scene.types import Frontier, RegionEvent, RegionEventKind
from services.api.server import models
from tests.unit.services.api.flat import Flat

BASE = "/v1/scenes/flat"


async def test_scenes_are_listed(client: httpx.AsyncClient) -> None:
    body = (await client.get("/v1/scenes")).json()
    assert body == {
        "scenes": [{"scene": "flat", "map_version": 12, "objects": 17, "frames": 12, "detections": 140}]
    }


async def test_a_scene_says_how_it_was_seen_and_how_it_is_turned(client: httpx.AsyncClient) -> None:
    body = (await client.get(BASE)).json()
    assert (body["backend"], body["regions"], body["floors"]) == ("embedded", 3, 1)
    assert body["world_from_source"][2] == [0.0, 1.0, 0.0, 0.5]


async def test_every_map_answer_is_what_openapi_promises(client: httpx.AsyncClient) -> None:
    for path, model in (
        ("objects", models.ObjectPage),
        ("objects/o-001", models.ObjectReply),
        ("regions", models.RegionList),
        ("graph", models.Graph),
        ("exports/scene-graph.json", models.SceneGraph),
    ):
        for frame in ("world", "source"):
            reply = await client.get(f"{BASE}/{path}", params={"frame": frame})
            assert reply.status_code == 200
            assert model.model_validate(reply.json()).model_dump() == reply.json()


async def test_pages_together_are_the_whole_map_once(client: httpx.AsyncClient) -> None:
    seen: list[str] = []
    cursor = None
    sizes = []
    while True:
        page = (
            await client.get(f"{BASE}/objects", params={"limit": 5} | ({"cursor": cursor} if cursor else {}))
        ).json()
        sizes.append(len(page["objects"]))
        seen += [obj["id"] for obj in page["objects"]]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert sizes == [5, 5, 5, 2]
    assert seen == sorted(set(seen))
    assert len(seen) == 17


async def test_a_page_that_ends_with_the_map_has_no_next(client: httpx.AsyncClient) -> None:
    assert (await client.get(f"{BASE}/objects", params={"limit": 17})).json()["next_cursor"] is None


@pytest.mark.parametrize(("label", "count"), [("mug", 2), (" Mugs ", 2), ("sofa", 1), ("piano", 0)])
async def test_a_label_is_matched_in_its_normal_form(
    client: httpx.AsyncClient, label: str, count: int
) -> None:
    page = (await client.get(f"{BASE}/objects", params={"label": label})).json()
    assert len(page["objects"]) == count


async def test_objects_of_one_region_can_be_asked_for(client: httpx.AsyncClient) -> None:
    page = (await client.get(f"{BASE}/objects", params={"region": "r-bath"})).json()
    assert [obj["label"] for obj in page["objects"]] == ["sink", "toilet", "towel"]
    reply = await client.get(f"{BASE}/objects", params={"region": "r-attic"})
    assert reply.status_code == 404
    assert "r-living, r-kitchen, r-bath" in reply.json()["detail"]


async def test_an_objects_position_in_the_recordings_frame(client: httpx.AsyncClient) -> None:
    world = (await client.get(f"{BASE}/objects/o-001")).json()["object"]
    source = (await client.get(f"{BASE}/objects/o-001?frame=source")).json()["object"]
    x, y, z = world["position"]
    assert source["position"] == pytest.approx([x, z - 0.5, -y])


async def test_the_id_of_a_merged_object_gives_its_survivor(client: httpx.AsyncClient, home: Flat) -> None:
    home.aliases["o-900"] = "o-001"
    assert (await client.get(f"{BASE}/objects/o-900")).json()["object"]["id"] == "o-001"


@pytest.mark.parametrize("path", ["objects", "regions", "graph"])
async def test_what_is_unchanged_is_not_sent_again(client: httpx.AsyncClient, home: Flat, path: str) -> None:
    first = await client.get(f"{BASE}/{path}")
    tag = first.headers["etag"]
    again = await client.get(f"{BASE}/{path}", headers={"If-None-Match": f'"1", W/{tag}'})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
    home.grow("lamp", (1, 1, 0, 2, 2, 1), "r-living")
    home.revision += 1
    assert (await client.get(f"{BASE}/{path}", headers={"If-None-Match": tag})).status_code == 200


async def test_the_tag_of_the_objects_is_the_map_version(client: httpx.AsyncClient) -> None:
    assert (await client.get(f"{BASE}/objects")).headers["etag"] == '"12"'


async def test_a_scene_before_its_first_partition_has_no_regions_and_no_error(
    client: httpx.AsyncClient, home: Flat
) -> None:
    home.regions = []
    body = (await client.get(f"{BASE}/regions")).json()
    assert (body["regions"], body["regions_revision"]) == ([], 0)
    assert len((await client.get(f"{BASE}/graph")).json()["unplaced"]) == 17


async def test_regions_carry_their_ways_frontiers_and_what_changed(
    client: httpx.AsyncClient, home: Flat
) -> None:
    home.upstairs = True
    home.frontiers = (
        Frontier(0, "r-bath", np.array([8.0, 1.0, 0.0]), 1.2),
        Frontier(0, "", np.array([4.0, 6.0, 0.0]), 0.7),
    )
    home.events = (RegionEvent(RegionEventKind.APPEARED, "r-bath", 0, "bathroom", "r-living"),)
    regions = (await client.get(f"{BASE}/regions")).json()
    graph = (await client.get(f"{BASE}/graph")).json()

    door, stairs = regions["edges"]
    assert (door["kind"], door["upper"]) == ("doorway", None)
    assert (stairs["kind"], stairs["upper"]) == ("stairs", [3.0, 3.2, 2.7])
    assert [frontier["region_id"] for frontier in regions["frontiers"]] == ["r-bath", None]
    assert regions["events"][0]["kind"] == "appeared"
    assert regions["regions"][3]["seen_by"] == ["robot.walk.2"]
    for name in ("edges", "frontiers", "events"):
        assert graph[name] == regions[name]
    assert graph["floors"][1]["regions"][0]["seen_by"] == ["robot.walk.2"]


async def test_frontiers_and_stairs_in_the_recordings_frame(client: httpx.AsyncClient, home: Flat) -> None:
    home.upstairs = True
    home.frontiers = (Frontier(0, "r-bath", np.array([8.0, 1.0, 0.0]), 1.2),)
    body = (await client.get(f"{BASE}/regions?frame=source")).json()
    assert body["frontiers"][0]["position"] == pytest.approx([8.0, -0.5, -1.0])
    assert body["edges"][1]["upper"] == pytest.approx([3.0, 2.2, -3.2])
