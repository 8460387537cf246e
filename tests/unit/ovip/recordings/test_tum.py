"""Layout tum: association by time, quaternions, published intrinsics."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from ovip.recordings import open_recording
from ovip.recordings.tum import associate, nearest, pose_of_quaternion
from ovip.scene.types import Intrinsics


def test_images_and_poses_are_matched_by_nearest_time(tum) -> None:
    folder = tum()
    recording = open_recording(folder, "tum")
    frames = list(recording)
    assert recording.depth_scale == 5000
    np.testing.assert_array_equal(recording.world_from_source, np.eye(4))
    assert [frame.timestamp_ns for frame in frames] == [10_000_000_000, 10_100_000_000, 10_200_000_000]
    np.testing.assert_allclose([frame.world_from_camera[0, 3] for frame in frames], [0, 1, 2], atol=1e-9)
    assert frames[1].depth_bytes == (folder / "depth" / "10.105000.png").read_bytes()
    assert frames[1].rgb_encoding == "png"


def test_the_camera_looks_level_where_the_quaternion_says_so(tum, pose_at) -> None:
    frame = next(iter(open_recording(tum(), "tum")))
    np.testing.assert_allclose(frame.world_from_camera, pose_at(0), atol=1e-6)


def test_a_frame_without_depth_or_pose_near_in_time_is_skipped(tum) -> None:
    folder = tum()
    lines = (folder / "depth.txt").read_text().splitlines()
    (folder / "depth.txt").write_text("\n".join([lines[0], lines[1], "10.121 depth/10.105000.png", lines[3]]))
    truth = (folder / "groundtruth.txt").read_text().splitlines()
    (folder / "groundtruth.txt").write_text("\n".join(line for line in truth if line < "10.15"))
    recording = open_recording(folder, "tum")
    assert [frame.index for frame in recording] == [0]
    assert [(frame.index, frame.reason) for frame in recording.skipped] == [
        (1, "no depth image"),
        (2, "no pose"),
    ]


@pytest.mark.parametrize(
    ("name", "fx"),
    [
        ("rgbd_dataset_freiburg1_desk", 517.3),
        ("rgbd_dataset_freiburg2_xyz", 520.9),
        ("rgbd_dataset_freiburg3_long_office", 535.4),
        ("my_office", 525.0),
    ],
)
def test_intrinsics_are_the_published_ones_of_the_camera_and_it_says_so(tum, name: str, fx: float) -> None:
    recording = open_recording(tum(name), "tum")
    assert recording.intrinsics.fx == fx
    assert "no intrinsics.json" in recording.notes[0]


def test_an_intrinsics_file_wins_over_the_published_ones(tum) -> None:
    folder = tum()
    values = {"fx": 500.0, "fy": 501.0, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480}
    (folder / "intrinsics.json").write_text(json.dumps(values))
    recording = open_recording(folder, "tum")
    assert recording.intrinsics == Intrinsics(500, 501, 320, 240, 640, 480)
    assert recording.notes == ()


def test_images_of_another_size_need_an_intrinsics_file(tum, write_rgb) -> None:
    folder = tum()
    write_rgb(folder / "rgb" / "10.000000.png", (320, 240))
    with pytest.raises(
        InvalidInput, match=r"expected 640x480 images .* got 320x240; put an intrinsics\.json"
    ):
        open_recording(folder, "tum")


@pytest.mark.parametrize("name", ["groundtruth.txt", "depth.txt", "rgb.txt"])
def test_a_missing_list_is_named(tum, name: str) -> None:
    folder = tum()
    (folder / name).unlink()
    with pytest.raises(InvalidInput, match=rf"{name}: expected a readable text file, got: No such file"):
        open_recording(folder, "tum")


def test_lists_of_different_sequences_are_an_error(tum) -> None:
    folder = tum()
    (folder / "groundtruth.txt").write_text("500.0 0 0 0 0 0 0 1\n")
    with pytest.raises(InvalidInput, match=r"within 0\.02 s of the colour images, got none"):
        open_recording(folder, "tum")


@pytest.mark.parametrize("line", ["10.0 0 0 0 0 0 1", "ten 0 0 0 0 0 0 1", "10.0 0 0 x 0 0 0 1"])
def test_a_broken_pose_line_is_named(tum, line: str) -> None:
    folder = tum()
    (folder / "groundtruth.txt").write_text(f"# a comment\n{line}\n")
    with pytest.raises(InvalidInput, match=r"groundtruth\.txt line 2: expected"):
        open_recording(folder, "tum")


def test_closest_pairs_are_taken_first_and_each_partner_once() -> None:
    times, others = np.array([100, 110, 300]), np.array([108, 131, 500])
    # 110-108 (2) comes before 100-108 (8); 110-131 (21) is too far for anyone else
    np.testing.assert_array_equal(associate(times, others, 20), [-1, 0, -1])
    np.testing.assert_array_equal(associate(times, others, 31), [1, 0, -1])


def test_nothing_is_associated_with_nothing() -> None:
    none = np.array([], dtype=np.int64)
    assert associate(none, np.array([1]), 5).size == 0
    np.testing.assert_array_equal(associate(np.array([1]), none, 5), [-1])
    np.testing.assert_array_equal(nearest(np.array([1]), none, 5), [-1])


@given(
    st.lists(st.integers(0, 200), max_size=20), st.lists(st.integers(0, 200), max_size=20), st.integers(0, 30)
)
def test_association_is_one_to_one_and_near(times: list[int], others: list[int], max_dt: int) -> None:
    a, b = np.array(sorted(times), dtype=np.int64), np.array(sorted(others), dtype=np.int64)
    partner = associate(a, b, max_dt)
    used = partner[partner >= 0]
    assert len(set(used.tolist())) == len(used)
    assert (np.abs(a[partner >= 0] - b[used]) <= max_dt).all()
    close = nearest(a, b, max_dt)
    for i, time in enumerate(a):
        gaps = np.abs(b - time)
        assert (close[i] < 0) == (gaps.size == 0 or gaps.min() > max_dt)
        assert close[i] < 0 or gaps[close[i]] == gaps.min()


def test_a_quarter_turn_about_z_by_hand() -> None:
    half = np.sqrt(0.5)
    pose = pose_of_quaternion(np.array([1.0, 2.0, 3.0, 0.0, 0.0, half, half]))
    np.testing.assert_allclose(pose, [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]], atol=1e-12)


def test_a_quaternion_without_length_is_a_lost_pose() -> None:
    assert np.isnan(pose_of_quaternion(np.zeros(7))).all()
