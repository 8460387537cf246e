"""The frame history reads what lies in the store, and what was only just decoded not again."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.errors import NotFound
from ovip.scene.types import Frame
from ovip.store import Store
from services.perception.config import Settings
from services.perception.detecting import Detecting
from services.perception.domain.lifting import LiftParams
from services.perception.history import FRAMES, FrameHistory, Images, StoredFrame, Upload, stored_frame
from services.perception.service import Perception
from tests.unit.services.perception.painted import K, PaintedModels, painted

SCENE = "kitchen"


async def kept(store: Store, history: FrameHistory) -> StoredFrame:
    """A frame as the robot's stream leaves it in the log."""
    models = Detecting(PaintedModels().as_models(), LiftParams())
    perception = Perception(store, models, Settings(_env_file=None), history)
    session, _ = await perception.open_session(SCENE, "r1", "s1", K, np.eye(4))
    f = painted(1, "cup")
    upload = Upload(1, f.timestamp_ns, f.world_from_camera, f.rgb, f.depth, "png16", f.depth_scale)
    await perception.keep(session, await perception.check(session, upload, None))
    return stored_frame((await store.newest(SCENE, FRAMES))[0])


def same(a: Frame, b: Frame) -> bool:
    return np.array_equal(a.rgb, b.rgb) and np.array_equal(a.depth, b.depth)


async def test_a_frame_that_was_just_kept_is_as_it_is_read_from_the_store(store: Store) -> None:
    history = FrameHistory(store)
    stored = await kept(store, history)
    fresh, read = await history.load(stored), await FrameHistory(store).load(stored)
    assert same(fresh, read)
    assert fresh.rgb.dtype == read.rgb.dtype == np.uint8
    assert fresh.depth.dtype == read.depth.dtype == np.float32


async def test_what_is_expected_is_given_once_and_then_read_from_the_store(store: Store) -> None:
    history, images = FrameHistory(store), made(10)
    expect(history, 1, images)
    assert (await history.load(named(1))).rgb is images.rgb
    with pytest.raises(NotFound):
        await history.load(named(1))


async def test_the_same_bytes_in_another_scale_are_another_frame(store: Store) -> None:
    history = FrameHistory(store)
    expect(history, 1, made(10), scale=5000.0)
    with pytest.raises(NotFound):
        await history.load(named(1))


async def test_images_are_kept_in_the_order_they_came_while_there_is_room(store: Store) -> None:
    history, side = FrameHistory(store), 2048  # 28 MB each: two fit
    for number in range(5):
        expect(history, number, made(side))
    assert (await history.load(named(0))).rgb.shape == (side, side, 3)
    expect(history, 5, made(side))
    for number in (1, 5):
        await history.load(named(number))
    for number in (2, 3, 4):
        with pytest.raises(NotFound):
            await history.load(named(number))


async def test_images_that_nobody_took_make_room_after_many_others(store: Store) -> None:
    history = FrameHistory(store)
    expect(history, 0, made(2900))  # 56 of 64 MB
    for number in range(1, 514):
        expect(history, number, made(1600))  # 17 MB
    assert (await history.load(named(513))).rgb.shape == (1600, 1600, 3)
    with pytest.raises(NotFound):
        await history.load(named(0))


def expect(history: FrameHistory, number: int, images: Images, scale: float = 1000.0) -> None:
    history.expect(ref(number), ref(0), scale, images)


def made(side: int) -> Images:
    return Images(np.zeros((side, side, 3), np.uint8), np.zeros((side, side), np.float32))


def named(number: int) -> StoredFrame:
    """A frame whose images are not in the blob store."""
    return StoredFrame("1-0", "f", 0, np.eye(4), K, ref(number), ref(0), "png16", 1000.0, "")


def ref(number: int) -> str:
    return f"{number:064x}"
