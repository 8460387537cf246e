"""How hits of perception are counted, by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lab.simulation.hits import HitParams, Hits, count_frame, perception_hits, summary
from ovip.errors import InvalidInput
from ovip.scene.types import Box2
from services.perception.domain.boxes2d import ScoredBox

LABELS = {5: "mug", 6: "chair", 7: "lamp"}


def picture() -> np.ndarray:
    """A 20x20 mug at rows and columns 10..29, a 40x10 chair at columns 60..69, a lamp of 4 pixels."""
    ids = np.zeros((100, 100), dtype=np.uint16)
    ids[10:30, 10:30] = 5
    ids[40:80, 60:70] = 6
    ids[0:2, 0:2] = 7
    return ids


def box(label: str, *corners: float) -> ScoredBox:
    return ScoredBox(label, 0.9, Box2(*corners))


def test_a_thing_is_hit_by_a_box_of_its_class_that_overlaps_enough() -> None:
    half = box("mug", 10, 10, 30, 20)  # IoU 0.5
    far = box("chair", 70, 40, 80, 80)  # beside the chair
    hits = Hits()
    count_frame(
        hits, picture(), LABELS, {"mug": [half], "chair": [far]}, [half, far], HitParams(min_pixels=100)
    )
    assert (hits.seen, hits.hit) == ({"mug": 1, "chair": 1}, {"mug": 1, "chair": 0})
    assert (hits.objects_seen, hits.objects_hit) == ({5, 6}, {5})
    assert (hits.boxes, hits.right) == (2, 1)


def test_a_box_of_another_class_on_a_thing_is_no_hit() -> None:
    wrong = box("chair", 10, 10, 30, 30)
    hits = Hits()
    count_frame(hits, picture(), LABELS, {"chair": [wrong]}, [wrong], HitParams(min_pixels=100))
    assert hits.hit == {"mug": 0, "chair": 0}
    assert hits.right == 0


def test_shares_by_hand() -> None:
    hits = Hits(frames=4, seen={"mug": 4, "lamp": 6}, hit={"mug": 3, "lamp": 0}, boxes=8, right=2)
    report = summary(hits, frozenset({"mug"}))
    assert (report["hit_rate"], report["hit_rate_all"], report["precision"]) == (0.75, 0.3, 0.25)
    assert [row["label"] for row in report["rows"]] == ["lamp", "mug"]
    assert [row["groundable"] for row in report["rows"]] == [False, True]


async def test_a_recording_without_truth_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"objects\.json"):
        await perception_hits(tmp_path)
