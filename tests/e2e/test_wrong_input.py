"""What a person does wrong on the command line is answered in one line that says what was expected."""

from __future__ import annotations

import socket
import subprocess
import sys
from pathlib import Path

import pytest

from tests.e2e.conftest import Cli

pytestmark = pytest.mark.models


def refused(done: subprocess.CompletedProcess[str]) -> str:
    """The one line of a refusal: status 1, no traceback, nothing on standard output."""
    assert done.returncode == 1, done.stderr[-2000:]
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    return done.stderr.strip().splitlines()[-1]


def test_a_path_that_is_not_there(cli: Cli, tmp_path: Path) -> None:
    line = refused(cli.run("replay", tmp_path / "nowhere", "--layout", "tum", "--scene", "s"))
    assert "expected a recording laid out as tum" in line and "got nothing there" in line


def test_the_wrong_layout_is_told_the_right_one(cli: Cli, room_recording: Path) -> None:
    line = refused(cli.run("replay", room_recording, "--layout", "7scenes", "--scene", "s"))
    assert "expected layout 7scenes" in line
    assert "looks like layout ovip" in line


def test_an_unknown_layout_is_told_the_known_ones(cli: Cli, room_recording: Path) -> None:
    assert "7scenes" in refused(cli.run("replay", room_recording, "--layout", "kitti", "--scene", "s"))


def test_up_must_be_three_numbers(cli: Cli, room_recording: Path) -> None:
    assert "up" in refused(cli.run("replay", room_recording, "--up", "north", "--scene", "s"))


def test_no_stack_says_so(cli: Cli, tmp_path: Path) -> None:
    alone = Cli({**cli.environment, "OVIP_DATA_DIR": str(tmp_path), "OVIP_RETRIEVAL_ADDRESS": "127.0.0.1:1"})
    line = refused(alone.run("find", "mug", "--scene", "s"))
    assert "127.0.0.1:1" in line


def test_an_unknown_scene_is_named(cli: Cli, tmp_path: Path) -> None:
    line = refused(cli.run("find", "mug", "--scene", "attic", "--standalone", "--data-dir", tmp_path))
    assert "'attic'" in line


def test_an_empty_question(cli: Cli, tmp_path: Path) -> None:
    line = refused(cli.run("find", "  ", "--scene", "s", "--standalone", "--data-dir", tmp_path))
    assert "expected" in line


def test_a_scene_name_that_cannot_be(cli: Cli, room_recording: Path, tmp_path: Path) -> None:
    words = ("replay", room_recording, "--scene", "a/../b", "--standalone", "--data-dir", tmp_path)
    assert "expected 1 to 64 letters" in refused(cli.run(*words))


def test_a_port_in_use_is_named_with_its_setting(cli: Cli, tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        environment = {**cli.environment, "OVIP_FREE_PORTS": "false", "OVIP_VLM_GATEWAY_PORT": str(port)}
        line = refused(Cli(environment).run("up", "--data-dir", tmp_path))
    assert str(port) in line
    assert "OVIP_VLM_GATEWAY_PORT" in line


def test_a_data_directory_that_cannot_be_written(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    done = cli.run("scenes", "--standalone", "--data-dir", tmp_path / "file" / "data")
    assert done.returncode == 1
    assert "writable directory" in done.stderr


def test_a_wrong_setting_is_named(cli: Cli, tmp_path: Path) -> None:
    environment = {**cli.environment, "OVIP_LOG_LEVEL": "loud"}
    assert "OVIP_LOG_LEVEL" in refused(Cli(environment).run("up", "--data-dir", tmp_path))


def test_one_service_alone_without_models_says_how_to_get_them(cli: Cli, tmp_path: Path) -> None:
    environment = {**cli.environment, "OVIP_MODELS_DIR": str(tmp_path), "OVIP_DATA_DIR": str(tmp_path / "d")}
    done = subprocess.run(
        [sys.executable, "-m", "services.perception"],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert "ovip models pull embedded" in refused(done)


def test_an_export_of_an_unknown_scene_writes_nothing(cli: Cli, tmp_path: Path) -> None:
    target = tmp_path / "scene.ply"
    words = ("export", "--scene", "attic", "--format", "ply", "-o", target)
    line = refused(cli.run(*words, "--standalone", "--data-dir", tmp_path / "data"))
    assert line.startswith("ovip: scene 'attic'")
    assert not target.exists()
