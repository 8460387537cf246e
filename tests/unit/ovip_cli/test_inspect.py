"""What `ovip inspect` prints, draws and exits with."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from lab.simulation.room import SimulatedRoom
from lab.simulation.writing import write_recording
from ovip.errors import InvalidInput
from ovip_cli.app import app

FRAMES = 16


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("simulated") / "walk"
    room = SimulatedRoom(1)
    write_recording(folder, room, room.walk()[:FRAMES])
    return folder


@pytest.fixture
def mirrored(walk: Path) -> Path:
    """The same walk with an OpenGL camera's poses."""
    folder = walk.with_name("mirrored")
    if not folder.exists():
        folder.mkdir()
        for path in walk.iterdir():
            (folder / path.name).symlink_to(path)
        (folder / "poses.txt").unlink()
        poses = np.loadtxt(walk / "poses.txt").reshape(-1, 4, 4) @ np.diag([1.0, -1, -1, 1])
        np.savetxt(folder / "poses.txt", poses.reshape(-1, 16), fmt="%.9g")
    return folder


def inspect(*words: str) -> Result:
    return CliRunner().invoke(app, ["inspect", *words])


def test_a_right_recording_is_told_line_by_line_and_exits_0(walk: Path) -> None:
    result = inspect(str(walk))
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0] == "walk (ovip)"
    assert lines[1] == "ok       frames        16 frames of 320x240"
    assert {line.split()[0] for line in lines[1:]} == {"ok"}


def test_a_wrong_one_says_what_is_wrong_and_exits_1(mirrored: Path) -> None:
    result = inspect(str(mirrored), "--up", "0,0,1")
    assert result.exit_code == 1
    wrong = [line for line in result.stdout.splitlines() if line.startswith("wrong    agreement")]
    assert "would if the camera's axes were OpenGL's" in wrong[0]


def test_an_option_sets_right_what_was_wrong(walk: Path) -> None:
    assert inspect(str(walk), "--option", "depth_scale=5000").exit_code == 1
    assert inspect(str(walk), "--option", "depth_scale=1000").exit_code == 0


def test_json_holds_the_findings_and_nothing_else(walk: Path) -> None:
    printed = json.loads(inspect(str(walk), "--json").stdout)
    assert (printed["name"], printed["layout"], printed["level"]) == ("walk", "ovip", "ok")
    frames = printed["findings"][0]
    assert frames == {
        "check": "frames",
        "level": "ok",
        "says": "16 frames of 320x240",
        "figures": {"frames": 16, "skipped": 0},
    }


def test_a_sheet_is_drawn_where_asked(walk: Path, tmp_path: Path) -> None:
    assert inspect(str(walk), "--sheet", str(tmp_path / "sheet.png")).exit_code == 0
    assert cv2.imread(str(tmp_path / "sheet.png")).shape == (1164, 984, 3)


@pytest.mark.parametrize("name", ["nowhere/sheet.png", "sheet.txt"])
def test_a_sheet_that_cannot_be_written_is_an_error(walk: Path, tmp_path: Path, name: str) -> None:
    error = inspect(str(walk), "--sheet", str(tmp_path / name)).exception
    assert isinstance(error, InvalidInput)
    assert "cannot be written: expected a .png or .jpg in a folder that is there" in str(error)


def test_up_that_cannot_be_found_is_a_finding_beside_the_others(walk: Path) -> None:
    result = inspect(str(walk), "--up", "auto", "--option", "depth_scale=65535000")
    assert result.exit_code == 1
    assert "wrong    up            expected a floor or a table below the cameras" in result.stdout
    assert "wrong    depth         not the size of rooms" in result.stdout


def test_a_place_without_a_recording_is_told_what_is_there_and_what_is_known(walk: Path) -> None:
    error = str(inspect(str(walk.parent)).exception)
    assert "expected a recording, found" in error
    assert "The folder walk inside looks like layout ovip." in error or "mirrored inside" in error
    assert "\n  ros1: a .bag file" in error


def test_nothing_there_and_a_wrong_option_are_told(tmp_path: Path, walk: Path) -> None:
    assert "found nothing there" in str(inspect(str(tmp_path / "none")).exception)
    assert "expected key=value, got 'fast'" in str(inspect(str(walk), "--option", "fast").exception)
