"""The worker: the frame log becomes the detections log, each frame once, whatever stops it in between."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable, Sequence
from typing import Any

import numpy as np
import pytest

from ovip.client import OutgoingFrame
from ovip.codec import decode_detection_batch
from ovip.errors import Unavailable
from ovip.store import Append, Committed, Entry, Lease, Store
from services.perception.config import Settings
from services.perception.detecting import Detecting
from services.perception.domain.gate import GateParams, gate_offline
from services.perception.domain.lifting import LiftParams
from services.perception.history import STAGE, Upload
from services.perception.service import Perception
from services.perception.worker import PerceptionWorker
from tests.builders import kernel_settings
from tests.unit.services.perception.painted import K, PaintedModels, painted

SCENE = "kitchen"
SHOWN = [
    ("cup",),
    ("cup", "logo"),
    ("chair",),
    ("cup", "chair"),
    (),
    ("table", "chair"),
    ("cup", "table"),
    ("table",),
]
FRAMES = [painted(n, *words) for n, words in enumerate(SHOWN, 1)]
GATE = GateParams(3, frozenset({"logo"}))


def worker_on(store: Store, models: PaintedModels | None = None, gate: GateParams = GATE) -> PerceptionWorker:
    return PerceptionWorker(store, Detecting((models or PaintedModels()).as_models(), LiftParams()), gate)


async def keep(store: Store, frames: Sequence[OutgoingFrame]) -> None:
    """What the robot's stream does with frames that were found good."""
    settings = Settings(_env_file=None)
    perception = Perception(store, Detecting(PaintedModels().as_models(), LiftParams()), settings)
    session, _ = await perception.open_session(SCENE, "r1", "s1", K, np.eye(4))
    for f in frames:
        upload = Upload(
            f.sequence, f.timestamp_ns, f.world_from_camera, f.rgb, f.depth, "png16", f.depth_scale
        )
        await perception.keep(session, await perception.check(session, upload, None))


async def work(
    store: Store, worker: PerceptionWorker, until: Callable[[], Awaitable[bool]] | None = None
) -> None:
    """Lets the worker follow the scene until every frame is done; raises what stopped it before."""

    async def all_done() -> bool:
        newest = await store.newest(SCENE, "frames")
        return await store.cursor(SCENE, STAGE) == newest[0].id

    following = asyncio.create_task(worker.follow(SCENE))
    try:
        async with asyncio.timeout(20):
            while not await (until or all_done)():
                if following.done():
                    following.result()
                await asyncio.sleep(0.005)
    finally:
        following.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await following


async def log_of(store: Store) -> list[dict[str, bytes]]:
    return [e.fields for e in await store.read(SCENE, "detections", count=1000)]


async def pairs_in(store: Store) -> set[tuple[str, str]]:
    """(frame, word) pairs that were grounded, as the batches say."""
    pairs = set()
    for fields in await log_of(store):
        batch = decode_detection_batch(await store.blobs.get(fields["batch"].decode()))
        pairs |= {(batch.frame_id, word) for word in batch.words}
    return pairs


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, bytes]]:
    """The detections log of a worker that nothing stopped, on a store of its own."""

    async def never_stopped() -> list[dict[str, bytes]]:
        store = await Store.connect(kernel_settings(tmp_path_factory.mktemp("never_stopped")))
        try:
            await keep(store, FRAMES)
            await work(store, worker_on(store))
            return await log_of(store)
        finally:
            await store.close()

    return asyncio.run(never_stopped())


async def test_online_the_worker_grounds_the_pairs_that_offline_would(store: Store) -> None:
    await keep(store, FRAMES)

    await work(store, worker_on(store))

    tags = [(f"r1.s1.{n:08d}", words) for n, words in enumerate(SHOWN, 1)]
    assert await pairs_in(store) == gate_offline(tags, GATE)


async def test_tags_counts_and_vocabulary_are_written_with_the_step(store: Store) -> None:
    await keep(store, FRAMES)

    await work(store, worker_on(store))

    values = await store.values(SCENE, STAGE, ["processed", "skipped", "vocabulary", "tags:r1.s1.00000004"])
    assert values == {
        "processed": b"8",
        "skipped": b"0",
        "vocabulary": b'["chair", "cup", "table"]',
        "tags:r1.s1.00000004": b'["chair", "cup"]',
    }


async def test_a_worker_killed_anywhere_and_begun_again_writes_the_same_log(
    store: Store, expected: list[dict[str, bytes]]
) -> None:
    await keep(store, FRAMES)
    for cut in (1, 2, 3, 5, 6):

        async def so_far(cut: int = cut) -> bool:
            return int((await store.values(SCENE, STAGE, ["processed"])).get("processed", 0)) >= cut

        await work(store, worker_on(store), until=so_far)
    await work(store, worker_on(store))

    assert await log_of(store) == expected


@pytest.mark.parametrize("at", [1, 3, 6, 8])
async def test_a_model_that_crashes_delays_its_frame_and_loses_nothing(
    at: int, store: Store, expected: list[dict[str, bytes]]
) -> None:
    await keep(store, FRAMES)
    crashing = worker_on(store, PaintedModels({at: RuntimeError("out of memory")}))

    with pytest.raises(RuntimeError, match="out of memory"):
        await work(store, crashing)
    assert int((await store.values(SCENE, STAGE, ["processed"])).get("processed", 0)) == at - 1
    await work(store, crashing)

    assert await log_of(store) == expected


class _Failing:
    """The store, whose commits fail where they are told to: before they happen or after, their answer lost."""

    def __init__(self, store: Store, at: int, after: bool) -> None:
        self._store, self._at, self._after = store, at, after
        self._commits = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._store, name)

    async def commit(
        self, lease: Lease, input_id: str, appends: Sequence[Append] = (), puts: Any = None
    ) -> Committed:
        self._commits += 1
        if self._commits == self._at and not self._after:
            raise Unavailable("the store went away")
        done = await self._store.commit(lease, input_id, appends, puts)
        if self._commits == self._at:
            raise Unavailable("the answer was lost")
        return done


@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("at", [1, 4, 8])
async def test_a_commit_that_fails_or_whose_answer_is_lost_is_done_once(
    at: int, after: bool, store: Store, expected: list[dict[str, bytes]]
) -> None:
    await keep(store, FRAMES)

    with contextlib.suppress(Unavailable):
        await work(store, worker_on(_Failing(store, at, after)))  # type: ignore[arg-type]
    await work(store, worker_on(store))

    assert await log_of(store) == expected


async def test_a_second_worker_waits_and_takes_over(
    store: Store, expected: list[dict[str, bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ovip.stages.LEASE_SECONDS", 0.5)
    await keep(store, FRAMES[:4])
    waiting = asyncio.create_task(worker_on(store).follow(SCENE))
    await work(store, worker_on(store))
    await keep(store, FRAMES[4:])

    async def all_done() -> bool:
        return await store.cursor(SCENE, STAGE) == (await store.newest(SCENE, "frames"))[0].id

    async with asyncio.timeout(10):
        while not await all_done():
            await asyncio.sleep(0.02)
    waiting.cancel()
    await asyncio.wait({waiting})

    assert await log_of(store) == expected


async def test_a_frame_whose_image_is_gone_is_skipped_and_counted_and_the_rest_goes_on(store: Store) -> None:
    await keep(store, FRAMES)
    entry: Entry = (await store.read(SCENE, "frames"))[2]
    ref = entry.fields["rgb"].decode()
    (store.blobs._root / ref[:2] / ref).unlink()  # type: ignore[attr-defined]

    await work(store, worker_on(store))

    values = await store.values(SCENE, STAGE, ["processed", "skipped", "tags:r1.s1.00000003"])
    assert values == {"processed": b"7", "skipped": b"1"}
    assert b"r1.s1.00000003" not in {fields["frame_id"] for fields in await log_of(store)}


async def test_the_gate_s_own_settings_hold(store: Store) -> None:
    await keep(store, FRAMES)

    await work(store, worker_on(store, gate=GateParams(1, frozenset({"cup"}))))

    assert {word for _, word in await pairs_in(store)} == {"chair", "table", "logo"}
    assert not any(fields["kind"] == b"late" for fields in await log_of(store))
