"""The small house as a home agrees with its own recorded walk, pixel by pixel."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.simulation import Renderer, load_small_house
from lab.simulation.home import Home, polygon_area
from ovip.errors import InvalidInput
from ovip.recordings import open_recording

ROOT = Path(__file__).resolve().parents[5] / "shared" / "data" / "small_house"


@pytest.fixture(scope="module")
def house() -> Home:
    if not ROOT.is_dir():
        pytest.skip("the small house is not at ../shared/data/small_house")
    return load_small_house(ROOT)


@pytest.mark.recording
def test_it_has_its_objects_zones_and_spaces(house: Home) -> None:
    assert len(house.objects) == 109
    assert len(house.things) == 89
    assert len({thing.label for thing in house.objects}) == 53
    assert [len(house.rooms), len(house.areas)] == [2, 8]
    assert house.area_at(0, np.array([-6.0, 1.0])).function == "bedroom"  # type: ignore[union-attr]
    assert {area.function for area in house.areas} == {
        "bedroom", "living room", "gym", "balcony", "dining area", "kitchen", "entryway",
    }  # fmt: skip
    assert sum(polygon_area(area.polygon) for area in house.areas) == pytest.approx(
        sum(polygon_area(room.polygon) for room in house.rooms), rel=0.01
    )
    assert len(house.mesh.triangles) == len(house.mesh.object_ids) == 150366


@pytest.mark.recording
def test_every_triangle_lies_in_the_box_of_its_object(house: Home) -> None:
    for thing in house.objects:
        points = house.mesh.vertices[house.mesh.triangles[house.mesh.object_ids == thing.object_id]].reshape(
            -1, 3
        )
        np.testing.assert_allclose(points.min(axis=0), thing.box[:3], atol=2e-3)
        np.testing.assert_allclose(points.max(axis=0), thing.box[3:], atol=2e-3)


@pytest.mark.recording
def test_depth_and_ids_agree_with_the_recorded_walk(house: Home) -> None:
    pytest.importorskip("open3d", reason="rendering needs Open3D")
    recording = open_recording(ROOT / "seq_a", "ovip", stride=100)
    renderer = Renderer(house, recording.intrinsics)
    for frame in recording:
        depth, ids = renderer.depth_and_ids(frame.world_from_camera)
        true_ids = cv2.imread(
            str(ROOT / "seq_a" / "instance" / f"{frame.index:06d}.png"), cv2.IMREAD_UNCHANGED
        )
        true_depth = cv2.imdecode(np.frombuffer(frame.depth_bytes, np.uint8), cv2.IMREAD_UNCHANGED)
        assert (ids == true_ids).mean() > 0.9999
        assert (np.abs(depth - true_depth / frame.depth_scale) < 0.001).mean() > 0.9999


def test_a_folder_without_it_is_told_what_is_missing(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"missing meshes\.npz"):
        load_small_house(tmp_path)
