"""Checks of frames, times and poses, on numbers."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.recordings import open_recording
from ovip.recordings.inspection.path import check_frames, check_path, check_times
from ovip.scene.types import F64, I64

NAMES = tuple(f"f{index}" for index in range(20))


def way(steps: list[float]) -> F64:
    poses = np.tile(np.eye(4), (len(steps) + 1, 1, 1))
    poses[1:, 0, 3] = np.cumsum(steps)
    return poses


def times(count: int, step_s: float = 0.1) -> I64:
    return (np.arange(count) * step_s * 1e9).astype(np.int64)


def test_a_steady_way_is_measured() -> None:
    found = check_path(way([0.1] * 9 + [0.2]), times(11), NAMES)
    assert found.level == "ok"
    assert found.figures["length_m"] == pytest.approx(1.1)
    assert found.figures["largest_step_m"] == pytest.approx(0.2)
    assert found.figures["largest_step_at"] == "f10"
    assert found.says.startswith("1.1 m long within 1.1 x 0.0 x 0.0 m; largest step 0.20 m (at f10)")


def test_a_jump_is_named_with_its_frame() -> None:
    found = check_path(way([0.1] * 5 + [2.0] + [0.1] * 5), times(12), NAMES)
    assert found.level == "warning"
    assert found.says.startswith("1 jumps, at f6:")


def test_a_sudden_turn_is_a_jump() -> None:
    poses = way([0.1] * 10)
    poses[5:, :2, :2] = [[0, -1], [1, 0]]
    found = check_path(poses, times(11), NAMES)
    assert found.figures["largest_turn_deg"] == pytest.approx(90)
    assert found.says.startswith("1 jumps, at f5:")


def test_a_camera_that_stands_still_is_told() -> None:
    assert check_path(way([0.0] * 5), times(6), NAMES).says.startswith("the camera hardly moves")
    assert check_path(way([]), times(1), NAMES).level == "warning"


def test_times_in_another_unit_show_as_speed() -> None:
    found = check_path(way([0.1] * 10), times(11) // 1000, NAMES)
    assert found.says.startswith("1000 m/s by its times, are they seconds?")


def test_rising_times_are_ok_and_counted() -> None:
    found = check_times(times(11), NAMES)
    assert (found.level, found.says) == ("ok", "rising, 1.0 s, 10.0 frames a second")


@pytest.mark.parametrize(
    ("at", "value_s", "level", "says"),
    [
        (4, 0.05, "wrong", "time falls 1 times, first at f4"),
        (4, 0.3, "warning", "1 frames have the time of the frame before"),
        (10, 9.0, "warning", "a hole of 8.1 s before f10"),
    ],
)
def test_times_that_do_not_rise_evenly_are_told(at: int, value_s: float, level: str, says: str) -> None:
    given = times(11)
    given[at] = round(value_s * 1e9)
    found = check_times(given, NAMES)
    assert (found.level, found.says) == (level, says)


def test_one_frame_has_no_times_to_speak_of() -> None:
    assert check_times(times(1), NAMES).says == "one frame only"


def test_skipped_frames_are_counted_by_reason(ovip_folder) -> None:
    folder = ovip_folder(4)
    (folder / "depth" / "000001.png").unlink()
    found = check_frames(open_recording(folder, "ovip"))
    assert found.level == "warning"
    assert found.says == "3 frames of 64x48, 1 skipped (1 because of: no depth image)"
