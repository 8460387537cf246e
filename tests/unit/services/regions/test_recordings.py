"""The whole domain on recordings, as far as they are here: a furnished house, and a kitchen seen from a table."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from skimage.measure import points_in_poly

from ovip.scene.camera import backproject
from ovip.scene.types import F32, F64, Bools, Intrinsics
from ovip.scene.voxels import downsample
from ovip.scene.walking import shortest_path
from services.regions.config import Settings
from services.regions.domain.assembly import Cut, PlacedObjects, assemble
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.free_space import FreeSpace
from services.regions.domain.functions import functions_of
from services.regions.domain.partition import PartitionParams
from services.regions.domain.survey import survey

DATA = Path(__file__).resolve().parents[5] / "shared" / "data"
pytestmark = pytest.mark.recording


def recording(name: str) -> Path:
    if not (DATA / name).is_dir():
        pytest.skip(f"../shared/data/{name} is not here: the test on this recording was skipped")
    return DATA / name


def cloud(depth: np.ndarray, camera: Intrinsics, pose: F64) -> F32:
    """A frame's coarse cloud `(N, 3)`, world metres."""
    points, _ = backproject(depth.astype(np.float32), camera, pose)
    return downsample(points, 0.05)[0]


def cut(
    evidence: FloorEvidence,
    objects: PlacedObjects,
    params: PartitionParams | None = None,
    before: Cut | None = None,
) -> Cut:
    """By the function table alone, with the numbers of the service unless others are given."""
    functions = functions_of(objects.labels, objects.centres[:, :2], {})
    params = params or Settings(_env_file=None).partition
    return assemble(survey(evidence), objects, functions, evidence, before or Cut.none(), params)


def function_at(result: Cut, x: float, y: float) -> str:
    (grid,) = result.grids
    number = int(grid.regions[grid.cell_of(np.array([x, y]))])
    return {r.region_id: r.function for r in result.partition.regions}[grid.region_ids[number - 1]]


Walk = list[tuple[str, F32, F64]]


@pytest.fixture(scope="module")
def walk() -> Walk:
    """Every fifth frame of a walk through the house: its name, its coarse cloud and its camera."""
    folder = recording("small_house") / "seq_a"
    k = json.loads((folder / "intrinsics.json").read_text())
    camera = Intrinsics(k["fx"], k["fy"], k["cx"], k["cy"], k["width"], k["height"])
    poses = np.loadtxt(folder / "poses.txt").reshape(-1, 4, 4)
    frames = []
    for number in range(0, len(poses), 5):
        depth = cv2.imread(str(folder / "depth" / f"{number:06d}.png"), cv2.IMREAD_UNCHANGED)
        assert depth is not None
        frames.append((f"f{number:06d}", cloud(depth / 1000.0, camera, poses[number]), poses[number][:3, 3]))
    return frames


@pytest.fixture(scope="module")
def house(walk: Walk) -> tuple[FloorEvidence, PlacedObjects]:
    evidence = FloorEvidence()
    for name, points, camera in walk:
        evidence.add(name, points, camera)
    return evidence, true_objects()


def true_objects() -> PlacedObjects:
    text = (recording("small_house") / "objects.json").read_text()
    truth = [item for item in json.loads(text) if not item["structural"]]
    return PlacedObjects(
        tuple(str(item["object_id"]) for item in truth),
        tuple(item["label"] for item in truth),
        np.array([np.add(item["aabb_low"], item["aabb_high"]) / 2 for item in truth]),
    )


def share_of(result: Cut, area: str, function: str) -> float:
    """The share of an area of the truth that is in regions of a function."""
    zones = json.loads((recording("small_house") / "rooms.json").read_text())["zones"]
    (polygon,) = [np.array(zone["polygon"]) for zone in zones if zone["label"] == area]
    (grid,) = result.grids
    rows, columns = np.nonzero(grid.regions)
    xy = np.asarray(grid.origin) + (np.stack([columns, rows], axis=1) + 0.5) * grid.resolution
    inside = points_in_poly(xy, polygon)
    functions = {r.region_id: r.function for r in result.partition.regions}
    are = np.array([functions[name] == function for name in grid.region_ids])
    return float(are[grid.regions[rows, columns][inside] - 1].mean())


def test_the_house_has_the_areas_that_people_see_in_it(house: tuple[FloorEvidence, PlacedObjects]) -> None:
    result = cut(*house)
    (floor,) = result.partition.floors
    assert floor.z == pytest.approx(0.0, abs=0.03)
    assert floor.ceiling_z == pytest.approx(2.7, abs=0.05)
    assert 150 < floor.area < 215
    assert share_of(result, "bedroom", "bedroom") > 0.9
    assert share_of(result, "living room", "living room") > 0.7
    assert share_of(result, "dining area", "dining area") > 0.8
    assert share_of(result, "kitchen", "kitchen") > 0.6
    assert share_of(result, "gym corner", "gym") > 0.9


def test_the_papers_last_watershed_gives_the_open_plan_to_the_marker_in_its_middle(
    house: tuple[FloorEvidence, PlacedObjects],
) -> None:
    ours, paper = cut(*house), cut(*house, PartitionParams())
    largest = [max(r.area for r in c.partition.regions) / c.partition.floors[0].area for c in (ours, paper)]
    assert largest[0] < 0.5 < largest[1]
    assert function_at(paper, 8.0, -3.5) == "living room"


def test_while_the_house_is_explored_its_regions_cover_what_was_seen_and_hold_everything_in_it(
    walk: Walk,
) -> None:
    evidence, result, everything = FloorEvidence(), Cut.none(), true_objects()
    areas, ids = [], []
    for part in range(4):
        for name, points, camera in walk[part * len(walk) // 4 : (part + 1) * len(walk) // 4]:
            evidence.add(name, points, camera)
        (storey,) = survey(evidence)
        seen = everything.only(np.flatnonzero(on_floor(storey.space, everything.centres)))
        result = cut(evidence, seen, before=result)
        (grid,) = result.grids
        assert (grid.regions[storey.space.free] > 0).mean() > 0.98
        assert sorted(i for r in result.partition.regions for i in r.object_ids) == sorted(seen.ids)
        assert sorted(i for r in result.partition.regions for i in r.frame_ids) == sorted(evidence.cameras)
        areas.append(result.partition.floors[0].area)
        ids.append({r.region_id for r in result.partition.regions})
    assert areas == sorted(areas)
    assert all(before & after for before, after in pairwise(ids))


def on_floor(space: FreeSpace, centres: F64) -> Bools:
    """Whether there is free floor under each of `(N, 3)` points."""
    cells = np.floor((centres[:, 1::-1] - np.asarray(space.origin)[::-1]) / space.resolution).astype(int)
    inside = ((cells >= 0) & (cells < space.free.shape)).all(axis=1)
    inside[inside] = space.free[tuple(cells[inside].T)]
    return np.asarray(inside)


def test_a_robot_finds_its_way_from_bed_to_stove(house: tuple[FloorEvidence, PlacedObjects]) -> None:
    (grid,) = cut(*house).grids
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
        pose = upright @ np.loadtxt(path)
        points = cloud(np.where(depth < 10000, depth, 0) / 1000.0, camera, pose)
        evidence.add(path.name, points, pose[:3, 3])
    centres = np.array([[-0.71, -0.17, 1.95], [-0.49, -0.30, 2.26], [-0.2, -0.1, 1.9]]) @ upright[:3, :3].T
    objects = PlacedObjects(("a", "b", "c"), ("cup", "chair", "dining table"), centres)
    result = cut(evidence, objects)
    (floor,) = result.partition.floors
    assert floor.z == pytest.approx(-1.53, abs=0.06)
    (region,) = result.partition.regions
    assert region.function == "dining area"
    assert region.object_ids == ("a", "b", "c")
    assert len(region.frame_ids) == 35
    nothing = cut(evidence, PlacedObjects.none())
    assert [r.function for r in nothing.partition.regions] == ["unknown"]
