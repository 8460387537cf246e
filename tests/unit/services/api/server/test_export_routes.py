"""The map as files and pictures over HTTP."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from dataclasses import replace

import httpx
import numpy as np
import pytest
from PIL import Image

from services.api.server import models
from tests.unit.services.api.flat import Flat

BASE = "/v1/scenes/flat"


async def test_points_are_thinned_to_what_was_asked(client: httpx.AsyncClient) -> None:
    reply = await client.get(f"{BASE}/points", params={"max_points": 100})
    _, _, version, count, _ = struct.unpack_from("<4sIQII", reply.content)
    assert version == 12
    assert 0 < count <= 100 + 17


async def test_points_of_chosen_objects(client: httpx.AsyncClient) -> None:
    reply = await client.get(f"{BASE}/points", params={"object_id": ["o-001", "o-003"]})
    _, _, _, count, _ = struct.unpack_from("<4sIQII", reply.content)
    assert count == 240
    assert json.loads(reply.content[24 + 19 * count :]) == ["o-001", "o-003"]


async def test_ply_holds_every_point_of_the_map(client: httpx.AsyncClient) -> None:
    reply = await client.get(f"{BASE}/exports/ply", params={"format": "ascii"})
    head, body = reply.text.split("end_header\n")
    assert f"element vertex {17 * 120}" in head
    assert "comment scene flat map version 12" in head
    assert len(body.splitlines()) == 17 * 120
    assert reply.headers["content-disposition"] == 'attachment; filename="flat-v12.ply"'


async def test_binary_ply_in_the_recordings_frame(client: httpx.AsyncClient) -> None:
    row = np.dtype([("xyz", "<f4", 3), ("rgb", "u1", 3), ("object_id", "<i4")])
    world, source = [
        np.frombuffer(
            (await client.get(f"{BASE}/exports/ply?frame={frame}")).content.split(b"end_header\n")[1], row
        )
        for frame in ("world", "source")
    ]
    x, y, z = world["xyz"].T
    np.testing.assert_allclose(source["xyz"], np.column_stack([x, z - 0.5, -y]), atol=1e-5)


async def test_a_large_map_is_fetched_in_messages_that_fit(client: httpx.AsyncClient, home: Flat) -> None:
    home.objects = [replace(obj, voxels=150_000) for obj in home.objects[:5]]
    home.objects[4] = replace(home.objects[4], voxels=700_000)
    await client.get(f"{BASE}/exports/ply")
    assert home.points_asked == [("o-001", "o-002"), ("o-003", "o-004"), ("o-005",)]


async def test_an_empty_map_exports_an_empty_cloud(client: httpx.AsyncClient, home: Flat) -> None:
    home.objects = []
    reply = await client.get(f"{BASE}/exports/ply")
    assert b"element vertex 0\n" in reply.content


async def test_the_scene_graph_is_a_file(client: httpx.AsyncClient) -> None:
    reply = await client.get(f"{BASE}/exports/scene-graph.json")
    assert reply.headers["content-disposition"] == 'attachment; filename="flat-v12.json"'
    assert reply.json()["format"] == "ovip-scene-graph"


async def test_the_floor_plan_is_a_picture_in_scale(client: httpx.AsyncClient) -> None:
    small, large = [
        Image.open(io.BytesIO((await client.get(f"{BASE}/floorplan.png", params={"scale": scale})).content))
        for scale in (50, 100)
    ]
    assert small.width == 50 * 9.4
    assert large.width == 100 * 9.4


async def test_one_floor_or_all_side_by_side_are_drawn(client: httpx.AsyncClient, home: Flat) -> None:
    home.upstairs = True
    widths = [
        Image.open(
            io.BytesIO((await client.get(f"{BASE}/floorplan.png", params={"scale": 50} | floor)).content)
        ).width
        for floor in ({"floor": 0}, {"floor": 1}, {})
    ]
    assert widths[2] == widths[0] + widths[1]


async def test_maps_for_nav2_come_in_one_archive(client: httpx.AsyncClient, home: Flat) -> None:
    home.upstairs = True
    reply = await client.get(f"{BASE}/exports/nav2")
    assert reply.headers["content-type"] == "application/zip"
    assert reply.headers["content-disposition"] == 'attachment; filename="flat-r3-nav2.zip"'
    with zipfile.ZipFile(io.BytesIO(reply.content)) as files:
        assert len(files.namelist()) == 4
    one = await client.get(f"{BASE}/exports/nav2?floor=1")
    with zipfile.ZipFile(io.BytesIO(one.content)) as files:
        assert files.namelist() == ["floor-1.pgm", "floor-1.yaml"]


async def test_region_polygons_are_what_openapi_promises(client: httpx.AsyncClient) -> None:
    body = (await client.get(f"{BASE}/exports/regions.json")).json()
    assert models.RegionPolygons.model_validate(body).model_dump() == body
    assert [feature["id"] for feature in body["features"]] == ["r-living", "r-kitchen", "r-bath"]


@pytest.mark.parametrize(
    "path",
    [
        "floorplan.png",
        "exports/nav2",
        "exports/regions.json",
        "grid/0",
        "grid/0/occupancy.png",
        "grid/0/regions.png",
    ],
)
async def test_a_file_that_is_unchanged_is_not_sent_again(client: httpx.AsyncClient, path: str) -> None:
    tag = (await client.get(f"{BASE}/{path}")).headers["etag"]
    again = await client.get(f"{BASE}/{path}", headers={"If-None-Match": tag})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)


@pytest.mark.parametrize("path", ["floorplan.png", "exports/nav2", "exports/regions.json"])
async def test_a_new_partition_is_sent_again(client: httpx.AsyncClient, home: Flat, path: str) -> None:
    tag = (await client.get(f"{BASE}/{path}")).headers["etag"]
    home.cut_anew()
    assert (await client.get(f"{BASE}/{path}", headers={"If-None-Match": tag})).status_code == 200


@pytest.mark.parametrize(
    "path", ["floorplan.png?floor=7", "exports/nav2?floor=7", "grid/7", "grid/7/regions.png"]
)
async def test_an_unknown_floor_is_told_which_there_are(
    client: httpx.AsyncClient, home: Flat, path: str
) -> None:
    home.upstairs = True
    reply = await client.get(f"{BASE}/{path}")
    assert reply.status_code == 404
    assert reply.json()["detail"] == "floor 7: no such floor in scene 'flat'; there are: 0, 1"


@pytest.mark.parametrize("path", ["floorplan.png", "exports/nav2", "exports/regions.json", "grid/0"])
async def test_before_the_first_partition_it_is_said_in_words(
    client: httpx.AsyncClient, home: Flat, path: str
) -> None:
    home.regions = []
    reply = await client.get(f"{BASE}/{path}")
    assert reply.status_code == 404
    assert "has no regions yet" in reply.json()["detail"]


async def test_a_plan_too_large_to_draw_is_refused(client: httpx.AsyncClient, home: Flat) -> None:
    home.upstairs = True
    assert (await client.get(f"{BASE}/floorplan.png?scale=400")).status_code == 422


async def test_the_grid_says_where_its_images_are_and_what_they_mean(client: httpx.AsyncClient) -> None:
    grid = (await client.get(f"{BASE}/grid/0")).json()
    assert (grid["rows"], grid["columns"], grid["resolution"]) == (140, 180, 0.05)
    for name in ("occupancy_png", "regions_png"):
        picture = np.asarray(Image.open(io.BytesIO((await client.get(grid[name])).content)))
        assert picture.shape == (140, 180)
    values = set(
        np.unique(np.asarray(Image.open(io.BytesIO((await client.get(grid["occupancy_png"])).content))))
    )
    assert values == set(grid["occupancy_values"].values())


@pytest.mark.parametrize("points", [0, 1_000_001])
async def test_too_many_or_no_points_are_refused(client: httpx.AsyncClient, points: int) -> None:
    assert (await client.get(f"{BASE}/points", params={"max_points": points})).status_code == 422
