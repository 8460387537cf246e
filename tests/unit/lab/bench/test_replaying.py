"""A robot's replay through a whole stack, with detections made from the recording's own depth."""

from __future__ import annotations

from itertools import islice, pairwise
from pathlib import Path

import numpy as np
import pytest

from lab.bench.replaying import TOUR, measure_replay, robot_of
from lab.bench.replaying_masks import PieceParams, with_pieces
from ovip.recordings import open_recording


def test_pieces_are_the_largest_first_apart_and_never_more_than_asked_for() -> None:
    recording = open_recording(TOUR, "ovip")
    frame = next(with_pieces(recording, recording.intrinsics, 12, PieceParams()))
    assert frame.onboard is not None
    masks = np.array([d.mask for d in frame.onboard])
    sizes = masks.sum(axis=(1, 2))
    assert len(masks) == 12
    assert masks.sum(axis=0).max() == 1
    assert (np.diff(sizes) <= 0).all()
    assert sizes.min() >= 400
    for d in frame.onboard:
        assert d.feature is not None
        assert np.linalg.norm(d.feature) == pytest.approx(1.0, abs=1e-5)
        assert d.mask is not None
        rows, columns = np.nonzero(d.mask)
        assert (d.box2.x0, d.box2.y0) == (columns.min(), rows.min())
        assert (d.box2.x1, d.box2.y1) == (columns.max() + 1, rows.max() + 1)


def test_a_piece_keeps_its_label_and_looks_alike_from_one_frame_to_the_next() -> None:
    recording = open_recording(TOUR, "ovip")
    frames = list(islice(with_pieces(recording, recording.intrinsics, 12, PieceParams()), 6))
    again = 0
    for first, second in pairwise(frame.onboard for frame in frames):
        assert first
        assert second
        cosines = np.array([[a.feature @ b.feature for b in second] for a in first])  # type: ignore[operator]
        for piece, other in zip(*np.nonzero(cosines > 0.85), strict=True):
            assert first[piece].label == second[other].label
            again += 1
        assert (cosines[cosines <= 0.85] < 0.3).all()
    assert again > 15  # the robot moves on: of 60


def test_a_robot_sends_what_it_was_asked_to_with_detections_in_every_frame() -> None:
    robot = robot_of(open_recording(TOUR, "ovip"), 3, frames=4)
    assert [frame.sequence for frame in robot.frames] == [1, 2, 3, 4]
    assert robot.detections_a_frame == 3
    elsewhere = robot.into("other", 2)
    assert (elsewhere.hello.scene, len(elsewhere.frames)) == ("other", 2)


@pytest.mark.models
async def test_every_frame_of_a_replay_is_in_the_map_when_the_clock_stops(models_dir: Path) -> None:
    rows = await measure_replay(frames=6, detections=(3,))
    assert [(row["frames"], row["detections"], row["mapped"]) for row in rows] == [(6, 3.0, 18)]
    assert 0 < float(rows[0]["frames_per_second"]) <= float(rows[0]["durable_per_second"])
