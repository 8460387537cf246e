"""The whole domain on recordings, as far as they are here: a furnished house, and a kitchen seen from a table."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from ovip.scene.camera import backproject
from ovip.scene.types import F64, Intrinsics
from ovip.scene.voxels import downsample
from ovip.scene.walking import shortest_path
from services.regions.domain.assembly import Cut, PlacedObjects, assemble
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.functions import functions_of
from services.regions.domain.partition import PartitionParams, Relief
from services.regions.domain.survey import survey

DATA = Path(__file__).resolve().parents[5] / "shared" / "data"
pytestmark = pytest.mark.recording


def recording(name: str) -> Path:
    if not (DATA / name).is_dir():
        pytest.skip(f"../shared/data/{name} is not here: the test on this recording was skipped")
    return DATA / name


def add(evidence: FloorEvidence, name: str, depth: np.ndarray, camera: Intrinsics, pose: F64) -> None:
    points, _ = backproject(depth.astype(np.float32), camera, pose)
    evidence.add(name, downsample(points, 0.05)[0], pose[:3, 3])


def cut(evidence: FloorEvidence, objects: PlacedObjects, relief: Relief) -> Cut:
    functions = functions_of(objects.labels, objects.centres[:, :2], {})
    return assemble(
        survey(evidence), objects, functions, evidence.cameras, Cut.none(), PartitionParams(relief=relief)
    )


def function_at(result: Cut, x: float, y: float) -> str:
    (grid,) = result.grids
    number = int(grid.regions[grid.cell_of(np.array([x, y]))])
    return {r.region_id: r.function for r in result.partition.regions}[grid.region_ids[number - 1]]


@pytest.fixture(scope="module")
def house() -> tuple[FloorEvidence, PlacedObjects]:
    folder = recording("small_house")
    walk = folder / "seq_a"
    k = json.loads((walk / "intrinsics.json").read_text())
    camera = Intrinsics(k["fx"], k["fy"], k["cx"], k["cy"], k["width"], k["height"])
    poses = np.loadtxt(walk / "poses.txt").reshape(-1, 4, 4)
    evidence = FloorEvidence()
    for number in range(0, len(poses), 5):
        depth = cv2.imread(str(walk / "depth" / f"{number:06d}.png"), cv2.IMREAD_UNCHANGED)
        assert depth is not None
        add(evidence, f"f{number:06d}", depth / 1000.0, camera, poses[number])
    truth = [item for item in json.loads((folder / "objects.json").read_text()) if not item["structural"]]
    return evidence, PlacedObjects(
        tuple(str(item["object_id"]) for item in truth),
        tuple(item["label"] for item in truth),
        np.array([np.add(item["aabb_low"], item["aabb_high"]) / 2 for item in truth]),
    )


def test_the_house_has_the_areas_that_people_see_in_it(house: tuple[FloorEvidence, PlacedObjects]) -> None:
    result = cut(*house, Relief.ARRIVAL)
    (floor,) = result.partition.floors
    assert floor.z == pytest.approx(0.0, abs=0.03)
    assert floor.ceiling_z == pytest.approx(2.7, abs=0.05)
    assert 150 < floor.area < 215
    assert function_at(result, -6.0, 1.5) == "bedroom"
    assert function_at(result, 0.5, -1.0) == "living room"
    assert function_at(result, 6.8, 1.5) == "dining area"
    assert function_at(result, 8.0, -3.5) == "kitchen"
    assert function_at(result, 3.0, 3.5) == "gym"


def test_the_papers_relief_keeps_what_walls_enclose_and_gives_the_open_plan_to_its_middle(
    house: tuple[FloorEvidence, PlacedObjects],
) -> None:
    result = cut(*house, Relief.CLEARANCE)
    assert function_at(result, -6.0, 1.5) == "bedroom"
    assert function_at(result, 0.5, -1.0) == "living room"
    assert function_at(result, 8.0, -3.5) == "living room"


def test_a_robot_finds_its_way_from_bed_to_stove(house: tuple[FloorEvidence, PlacedObjects]) -> None:
    (grid,) = cut(*house, Relief.ARRIVAL).grids
    path = shortest_path(grid, np.array([-6.0, 0.0]), np.array([8.0, -3.5]), radius=0.25)
    assert len(path) > 250
    assert np.linalg.norm(path[-1] - (8.0, -3.5)) < 0.8


def test_a_kitchen_seen_from_its_table_is_one_region_with_everything_in_it() -> None:
    folder = recording("kitchen")
    up = np.array([0.007, -0.893, -0.450]) / np.linalg.norm([0.007, -0.893, -0.450])
    right = np.array([1.0, 0.0, 0.0]) - up * up[0]
    right /= np.linalg.norm(right)
    upright = np.eye(4)
    upright[:3, :3] = np.stack([right, np.cross(up, right), up])
    camera = Intrinsics(585.0, 585.0, 320.0, 240.0, 640, 480)
    evidence = FloorEvidence()
    for path in sorted(folder.glob("*.pose.txt"))[::5]:
        depth = cv2.imread(str(path).replace("pose.txt", "depth.png"), cv2.IMREAD_UNCHANGED)
        assert depth is not None
        add(
            evidence,
            path.name,
            np.where(depth < 10000, depth, 0) / 1000.0,
            camera,
            upright @ np.loadtxt(path),
        )
    centres = np.array([[-0.71, -0.17, 1.95], [-0.49, -0.30, 2.26], [-0.2, -0.1, 1.9]]) @ upright[:3, :3].T
    objects = PlacedObjects(("a", "b", "c"), ("cup", "chair", "dining table"), centres)
    result = cut(evidence, objects, Relief.ARRIVAL)
    (floor,) = result.partition.floors
    assert floor.z == pytest.approx(-1.53, abs=0.06)
    (region,) = result.partition.regions
    assert region.function == "dining area"
    assert region.object_ids == ("a", "b", "c")
    assert len(region.frame_ids) == 35
    nothing = cut(evidence, PlacedObjects.none(), Relief.ARRIVAL)
    assert [r.function for r in nothing.partition.regions] == ["unknown"]
