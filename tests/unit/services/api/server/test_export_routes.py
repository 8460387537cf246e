"""The map as files and pictures over HTTP."""

from __future__ import annotations

import io
import json
import struct
from dataclasses import replace

import httpx
import numpy as np
import pytest
from PIL import Image

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
    reply = await client.get(f"{BASE}/floorplan.png", params={"scale": 50})
    assert reply.headers["content-type"] == "image/png"
    assert Image.open(io.BytesIO(reply.content)).size == (440, 340)


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
