"""The committed tour of a simulated home: small, whole, and true."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest

from lab.demo import TOUR
from ovip.recordings import Recording, open_recording
from ovip.scene.camera import backproject

MOST_BYTES = 12_000_000


@pytest.fixture(scope="module")
def tour() -> Recording:
    return open_recording(TOUR, "ovip")


def ids_of(index: int) -> np.ndarray:
    return np.asarray(cv2.imread(str(TOUR / "instance" / f"{index:06d}.png"), cv2.IMREAD_UNCHANGED))


def test_it_is_small_and_says_who_made_its_furniture() -> None:
    assert sum(path.stat().st_size for path in TOUR.rglob("*") if path.is_file()) <= MOST_BYTES
    lines = (TOUR / "ATTRIBUTION.txt").read_text().splitlines()
    assert len(lines) > 30
    assert all("CC" in line or "Apache" in line for line in lines[2:])


def test_it_opens_with_all_its_frames_and_none_is_skipped(tour: Recording) -> None:
    assert 120 <= len(tour) <= 160
    assert tour.skipped == ()
    assert len(list((TOUR / "instance").iterdir())) == len(tour)


@pytest.mark.parametrize("index", [0, 40, 90])
def test_its_points_lie_in_the_boxes_of_its_objects(tour: Recording, index: int) -> None:
    frame = next(frame for frame in tour if frame.index == index)
    units = cv2.imdecode(np.frombuffer(frame.depth_bytes, np.uint8), cv2.IMREAD_UNCHANGED)
    depth = (units / frame.depth_scale).astype(np.float32)
    points, at = backproject(depth, tour.intrinsics, frame.world_from_camera)
    ids = ids_of(index).ravel()[at]
    things = {thing["object_id"]: thing for thing in json.loads((TOUR / "objects.json").read_text())}
    assert len(np.unique(ids)) > 3
    for object_id in np.unique(ids[ids > 0]).tolist():
        own = points[ids == object_id]
        assert (own >= np.array(things[object_id]["aabb_low"]) - 0.003).all()
        assert (own <= np.array(things[object_id]["aabb_high"]) + 0.003).all()


def test_every_thing_stands_in_an_area_and_relations_name_things() -> None:
    things = {thing["object_id"]: thing for thing in json.loads((TOUR / "objects.json").read_text())}
    areas = {area["area_id"] for area in json.loads((TOUR / "areas.json").read_text())["areas"]}
    furniture = [thing for thing in things.values() if not thing["structural"]]
    assert len(furniture) > 100
    assert sum(thing["area_id"] in areas for thing in furniture) > 0.95 * len(furniture)
    relations = json.loads((TOUR / "relations.json").read_text())
    assert len(relations) > 50
    assert all(one["subject"] in things and one["object"] in things for one in relations)


def test_most_of_the_home_is_seen() -> None:
    things = json.loads((TOUR / "objects.json").read_text())
    visible = json.loads((TOUR / "visibility.json").read_text())
    furniture = [thing["object_id"] for thing in things if not thing["structural"]]
    assert sum(str(object_id) in visible for object_id in furniture) > 0.7 * len(furniture)
