"""What `ovip record` writes, and what it leaves alone."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from ovip.client import OutgoingFrame
from ovip.client.streaming import FrameStream
from ovip.clients import connect
from ovip.errors import InvalidInput, NotFound
from ovip.recordings import open_recording
from ovip.recordings.images import decode_raw_depth
from ovip.scene.types import F64
from ovip.store import Store
from ovip_cli.app import app
from services.perception import __main__ as perception
from services.perception.config import Settings
from tests.builders import SECOND, colour_noise, hello, jpeg, png, pose
from tests.unit.services.perception.painted import K, PaintedModels

SETTINGS = Settings(_env_file=None, perception_port=0, api_key=None, enumerator="detector")


def record(*words: str) -> Result:
    return CliRunner().invoke(app, ["record", *words])


# From a recording


def opengl_pose(index: int) -> F64:
    made = np.eye(4)
    made[:3, 3] = [index, 1.5, 4.0]
    return made


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    """Layout hm3d: y up, an OpenGL camera."""
    folder = tmp_path / "scene"
    for name in ("rgb", "depth", "pose"):
        (folder / name).mkdir(parents=True)
    for index in range(4):
        image = np.full((48, 64, 3), 40 * index, np.uint8)
        cv2.imwrite(str(folder / "rgb" / f"s_{index:06d}.png"), image)
        cv2.imwrite(str(folder / "depth" / f"s_{index:06d}.png"), np.full((48, 64), 1500, np.uint16))
        np.savetxt(folder / "pose" / f"s_{index:06d}.txt", opengl_pose(index).reshape(1, 16))
    return folder


def test_a_recording_of_any_layout_becomes_our_own_form_z_up(walk: Path, tmp_path: Path) -> None:
    result = record("-o", str(tmp_path / "kept"), "--from", str(walk), "--stride", "2")
    assert (result.exit_code, result.stdout) == (0, f"{tmp_path / 'kept'}: 2 frames\n")
    before, after = open_recording(walk, "hm3d", stride=2), open_recording(tmp_path / "kept", "ovip")
    assert after.intrinsics == before.intrinsics
    np.testing.assert_allclose(after.poses(), before.poses(), atol=1e-12)
    np.testing.assert_allclose(after.poses()[1, :3, 3], [2, -4, 1.5], atol=1e-9)
    for old, new in zip(before, after, strict=True):
        assert (new.rgb_bytes, new.depth_bytes) == (old.rgb_bytes, old.depth_bytes)
        assert new.timestamp_ns == old.timestamp_ns


def test_a_folder_in_use_is_left_alone(walk: Path, tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "mine.txt").write_text("mine")
    error = record("-o", str(tmp_path / "kept"), "--from", str(walk)).exception
    assert isinstance(error, InvalidInput)
    assert "expected a folder that does not exist yet or is empty, got one in use" in str(error)
    assert [path.name for path in (tmp_path / "kept").iterdir()] == ["mine.txt"]


def test_an_empty_folder_is_filled(walk: Path, tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    assert record("-o", str(tmp_path / "kept"), "--from", str(walk), "--json").exit_code == 0
    assert len(open_recording(tmp_path / "kept", "ovip")) == 4


def test_what_a_killed_run_left_is_written_anew(walk: Path, tmp_path: Path) -> None:
    left = tmp_path / ".kept.partial" / "rgb"
    left.mkdir(parents=True)
    (left / "000099.jpg").write_bytes(b"half")
    assert record("-o", str(tmp_path / "kept"), "--from", str(walk)).exit_code == 0
    assert len(list((tmp_path / "kept" / "rgb").iterdir())) == 4
    assert not (tmp_path / ".kept.partial").exists()


@pytest.mark.parametrize("words", [(), ("--scene", "home", "--from", "x")])
def test_either_a_scene_or_a_recording_is_named(tmp_path: Path, words: tuple[str, ...]) -> None:
    error = record("-o", str(tmp_path / "kept"), *words).exception
    assert isinstance(error, InvalidInput)
    assert str(error).startswith("expected either --scene NAME")


# From a stack


@pytest.fixture
def models(monkeypatch: pytest.MonkeyPatch) -> None:
    """The painted world's models behind the seams; the service and its history are as they run."""
    made = PaintedModels()
    monkeypatch.setattr(perception, "open_models", lambda settings, vlm: made.as_models())


def sent(sequence: int, scale: float = 5000.0) -> OutgoingFrame:
    raw = np.random.default_rng(sequence).integers(1, 40000, (K.height, K.width)).astype(np.uint16)
    return OutgoingFrame(
        sequence=sequence,
        timestamp_ns=sequence * SECOND,
        world_from_camera=pose(x=sequence / 10, z=1.2, yaw=0.1),
        rgb=jpeg(colour_noise(K, sequence)),
        depth=png(raw),
        depth_scale=scale,
    )


async def streamed_and_recorded(
    store: Store, monkeypatch: pytest.MonkeyPatch, output: Path, sessions: dict[str, list[OutgoingFrame]]
) -> Result:
    """Streams sessions into scene "home" as robots do, and records it from another thread, as a command does."""
    async with perception.serve(SETTINGS, store) as port:
        monkeypatch.setenv("OVIP_PERCEPTION_ADDRESS", f"127.0.0.1:{port}")
        monkeypatch.setenv("OVIP_DATA_DIR", str(output.parent / "no stack here"))
        channel = connect(f"127.0.0.1:{port}")
        for session, frames in sessions.items():
            report = await FrameStream(channel, hello("home", session, K)).send(frames)
            assert report.durable == len(frames)
        await channel.close()
        return await asyncio.to_thread(record, "-o", str(output), "--scene", "home", "--json")


async def test_what_a_robot_streamed_is_kept_as_it_was_sent(
    store: Store, models: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    frames = [sent(sequence) for sequence in (1, 2, 5)]
    result = await streamed_and_recorded(store, monkeypatch, tmp_path / "kept", {"s1": frames})
    assert json.loads(result.stdout) == {"recordings": [{"folder": str(tmp_path / "kept"), "frames": 3}]}
    kept = open_recording(tmp_path / "kept", "ovip")
    assert kept.intrinsics == K
    assert kept.depth_scale == 5000
    for before, after in zip(frames, kept, strict=True):
        assert after.rgb_bytes == before.rgb
        assert after.timestamp_ns == before.timestamp_ns
        np.testing.assert_array_equal(decode_raw_depth(after.depth_bytes), decode_raw_depth(before.depth))
        np.testing.assert_allclose(after.world_from_camera, before.world_from_camera, atol=1e-9)


async def test_each_of_several_sessions_gets_a_folder_of_its_own(
    store: Store, models: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    sessions = {"s1": [sent(1), sent(2)], "s2": [sent(1, scale=1000.0)]}
    result = await streamed_and_recorded(store, monkeypatch, tmp_path / "kept", sessions)
    assert result.exit_code == 0
    assert sorted(path.name for path in (tmp_path / "kept").iterdir()) == ["r1.s1", "r1.s2"]
    assert len(open_recording(tmp_path / "kept" / "r1.s1", "ovip")) == 2
    assert open_recording(tmp_path / "kept" / "r1.s2", "ovip").depth_scale == 1000


async def test_a_scene_that_is_not_there_writes_nothing(
    store: Store, models: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    result = await streamed_and_recorded(store, monkeypatch, tmp_path / "kept", {})
    assert isinstance(result.exception, NotFound)
    assert not (tmp_path / "kept").exists()
