"""The recorded tour that comes with the project: sound, in agreement with its truth, and seen by the real models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from ovip.recordings import open_recording
from ovip.scene.camera import backproject
from ovip.wire import decode_depth
from tests.e2e.conftest import ROOT, Cli, Stack

TOUR = ROOT / "lab" / "data" / "home_tour"
STRIDE = 6
MOST_BYTES = 12_000_000


def truth() -> dict[int, dict[str, Any]]:
    return {thing["object_id"]: thing for thing in json.loads((TOUR / "objects.json").read_text())}


def test_the_tour_is_small_and_says_who_made_its_furniture() -> None:
    assert sum(path.stat().st_size for path in TOUR.rglob("*") if path.is_file()) <= MOST_BYTES
    assert "CC-BY" in (TOUR / "ATTRIBUTION.txt").read_text()


def test_inspect_finds_nothing_wrong_with_the_tour(cli: Cli) -> None:
    report = cli.json("inspect", TOUR)

    assert report["layout"] == "ovip"
    assert [finding for finding in report["findings"] if finding["level"] == "wrong"] == []


@pytest.mark.parametrize("number", [0, 40, 80, 120])
def test_every_seen_point_of_a_thing_lies_in_its_true_box(number: int) -> None:
    """Ids, depth and pose of a frame agree with the truth beside it."""
    recording = open_recording(TOUR, "ovip")
    frame = recording.load(number)
    depth = decode_depth(frame.depth_bytes, "png16", frame.depth_scale, recording.intrinsics)
    ids = cv2.imread(str(TOUR / "instance" / f"{number:06d}.png"), cv2.IMREAD_UNCHANGED)
    things = truth()
    checked = 0
    for object_id in np.unique(ids[ids > 0]).tolist():
        box = np.array([*things[object_id]["aabb_low"], *things[object_id]["aabb_high"]])
        points, _ = backproject(depth, recording.intrinsics, frame.world_from_camera, ids == object_id)
        assert (points >= box[:3] - 0.01).all()
        assert (points <= box[3:] + 0.01).all()
        checked += 1
    assert checked > 5


@pytest.mark.models
def test_the_small_models_find_a_screen_and_a_plant_of_the_tour_where_they_are(
    cli: Cli, embedded_models: Path, tmp_path: Path
) -> None:
    replay = (
        "replay",
        TOUR,
        "--scene",
        "tour",
        "--stride",
        str(STRIDE),
        "--standalone",
        "--data-dir",
        tmp_path,
    )
    result = cli.json(*replay, timeout=500)
    assert result["frames"] == len(range(0, 128, STRIDE))
    assert result["objects"] >= 3

    with Stack(cli, tmp_path):
        answers = {
            word: cli.json("find", word, "--scene", "tour", "--data-dir", tmp_path)
            for word in ("television", "plant")
        }

    assert {word: answer["outcome"] for word, answer in answers.items()} == dict.fromkeys(answers, "found")
    assert gap(answers["television"], "tv") < 0.3
    assert gap(answers["plant"], "plant") < 0.3


def gap(answer: Any, label: str) -> float:
    """Metres from the answer's place to the nearest true box of a label."""
    place = np.array(answer["object"]["position"])
    boxes = [(t["aabb_low"], t["aabb_high"]) for t in truth().values() if t["label"] == label]
    outside = [np.maximum(np.maximum(low - place, place - high), 0) for low, high in boxes]
    return min(float(np.linalg.norm(o)) for o in outside)
