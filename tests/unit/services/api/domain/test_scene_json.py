"""The scene graph as JSON."""

from __future__ import annotations

import numpy as np

from ovip.answer_json import WORLD, OutputFrame
from ovip.scene.types import Floor, Partition, SceneMap
from services.api.domain.scene_json import graph_to_json, partition_to_json, scene_graph_to_json
from tests.unit.services.api.flat import SCENE, Y_UP, flat, thing


def scene() -> tuple[SceneMap, Partition]:
    home = flat()
    stray = thing("o-099", "kite", (20.0, 20.0, 1.0, 21.0, 21.0, 2.0), (1, 2, 3))
    return (
        SceneMap(SCENE, 12, (*home.objects, stray), "ab", 12, 140, "12-0"),
        Partition(11, 3, (Floor(0, 0.1, None, 47.1),), tuple(home.regions)),
    )


def test_every_object_stands_once_in_the_graph() -> None:
    scene_map, partition = scene()
    graph = graph_to_json(scene_map, partition, WORLD)
    held = [
        obj["id"] for floor in graph["floors"] for region in floor["regions"] for obj in region["objects"]
    ]
    loose = [obj["id"] for obj in graph["unplaced"]]
    assert loose == ["o-099"]
    assert sorted(held + loose) == sorted(obj.object_id for obj in scene_map.objects)


def test_an_object_that_was_merged_away_since_is_left_out_of_its_region() -> None:
    scene_map, partition = scene()
    smaller = SceneMap(SCENE, 13, scene_map.objects[1:], "cd", 12, 140, "13-0")
    graph = graph_to_json(smaller, partition, WORLD)
    assert "o-001" not in {obj["id"] for obj in graph["floors"][0]["regions"][0]["objects"]}


def test_the_export_names_the_region_and_floor_of_each_object() -> None:
    body = scene_graph_to_json(*scene(), WORLD)
    placed = {obj["id"]: (obj["region_id"], obj["floor"]) for obj in body["objects"]}
    assert placed["o-001"] == ("r-living", 0)
    assert placed["o-099"] == (None, None)
    assert (body["map_version"], body["regions_map_version"], body["regions_revision"]) == (12, 11, 3)


def test_outlines_lie_on_their_floor_in_the_recordings_frame() -> None:
    _, partition = scene()
    flat_ring = partition_to_json(partition, WORLD)["regions"][0]["outlines"][0]
    turned = partition_to_json(partition, OutputFrame(Y_UP))["regions"][0]["outlines"][0]
    assert flat_ring[2] == [4.9, 6.0]
    np.testing.assert_allclose(turned[2], [4.9, 0.1 - 0.5, -6.0])


def test_a_scene_without_regions_has_an_empty_graph_of_unplaced_objects() -> None:
    scene_map, _ = scene()
    graph = graph_to_json(scene_map, Partition(0, 0), WORLD)
    assert graph["floors"] == []
    assert len(graph["unplaced"]) == len(scene_map.objects)
