"""Where frames with their truth come from."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from lab.simulation import SimulatedRoom
from lab.simulation.imperfect import (
    SeenFrame,
    coloured_frames,
    halved,
    rendered_frames,
    small_house_frames,
)
from ovip.errors import InvalidInput
from ovip.scene.camera import backproject
from ovip.scene.types import F32, F64, U16, Intrinsics

SMALL_HOUSE = Path(__file__).resolve().parents[6] / "shared" / "data" / "small_house"


@dataclass
class DepthOnly:
    """The simulated room, without colour."""

    room: SimulatedRoom

    @property
    def intrinsics(self) -> Intrinsics:
        return self.room.intrinsics

    def depth_and_ids(self, world_from_camera: F64) -> tuple[F32, U16]:
        return self.room.render(world_from_camera)[1:]


def test_a_renderer_gives_a_frame_for_each_pose() -> None:
    room = SimulatedRoom()
    poses = room.walk()[:2]
    for seen, plain, pose in zip(
        coloured_frames(room, poses), rendered_frames(DepthOnly(room), poses), poses, strict=True
    ):
        assert np.array_equal(seen.world_from_camera, pose) and plain.timestamp_ns == seen.timestamp_ns
        assert np.array_equal(seen.ids, plain.ids) and np.array_equal(seen.depth, plain.depth)
        assert seen.rgb is not None and np.array_equal(seen.frame.rgb, seen.rgb)
        assert plain.rgb is None and set(plain.frame.rgb.ravel()) == {128}
        assert seen.frame_id == f"{seen.index:06d}" == seen.frame.frame_id


def test_a_halved_frame_shows_the_same_world(tabletop: list[SeenFrame]) -> None:
    seen = tabletop[0]
    (half,) = halved([seen])
    assert half.depth.shape == half.ids.shape == (120, 160) == (half.intrinsics.height, half.intrinsics.width)
    points, _ = backproject(seen.depth, seen.intrinsics, seen.world_from_camera)
    fewer, _ = backproject(half.depth, half.intrinsics, half.world_from_camera)
    assert fewer == pytest.approx(points.reshape(240, 320, 3)[::2, ::2].reshape(-1, 3), abs=1e-5)


def test_the_small_house_s_walk_is_read_at_a_stride() -> None:
    if not SMALL_HOUSE.is_dir():
        pytest.skip("../shared/data/small_house is not here: the test on its walk was skipped")
    frames = list(small_house_frames(SMALL_HOUSE, stride=200))
    assert [seen.index for seen in frames] == [0, 200, 400]
    assert all(seen.depth.shape == seen.ids.shape == (480, 640) for seen in frames)
    assert 0.2 < float(np.median(frames[0].depth)) < 12  # metres


def test_a_folder_without_the_walk_is_told_what_was_expected(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="seq_a"):
        next(small_house_frames(tmp_path))
