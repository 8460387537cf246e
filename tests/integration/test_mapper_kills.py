"""A mapper's process killed -9 again and again in mid-run: every step is there once, and the map is the same."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from ovip.scene.types import StepKind
from ovip.store import Store
from services.mapper.journal import EditInput, step_of
from tests.builders import kernel_settings, random_run
from tests.integration.mappers import SCENE, a_mapper, expected

ROOT = Path(__file__).resolve().parents[2]
LONG_RUN = random_run(5, 40)

# perception's and an operator's part too: batches come one by one, and an edit after every fourth
PROCESS = """
import asyncio, contextlib, sys
from pathlib import Path
from ovip import stages
from ovip.errors import OvipError
from ovip.scene.edits import EditRequest, Rename
from ovip.store import Store
from tests.builders import kernel_settings, random_run
from tests.integration.mappers import SCENE, following, write

stages.LEASE_SECONDS = 0.4
RUN, EDITS = random_run(5, 40), sys.argv[2] == "edits"

async def edit(mapper, n):
    made_on = (await mapper.get_map(SCENE)).version
    await mapper.edit(SCENE, EditRequest(f"e{n}", made_on, "test", Rename("o000001", f"name {n}")))

async def live() -> None:
    store = await Store.connect(kernel_settings(Path(sys.argv[1])))
    written = int((await store.cursor(SCENE, "perception")).partition("-")[0])
    await store.add_scene(SCENE)
    async with following(store) as mapper:
        print("up", 0, flush=True)
        for n in range(written, len(RUN)):
            lease = await store.acquire_lease(SCENE, "perception", "test", 0.1)
            while lease is None:
                await asyncio.sleep(0.02)
                lease = await store.acquire_lease(SCENE, "perception", "test", 0.1)
            newest = await write(store, RUN[n : n + 1])
            if EDITS and n % 4 == 3:
                with contextlib.suppress(OvipError):  # frames may change it meanwhile
                    await edit(mapper, n)
            print("frame", n + 1, flush=True)
        while await store.cursor(SCENE, "mapper") != (await store.newest(SCENE, "detections"))[0].id:
            await asyncio.sleep(0.01)
        await asyncio.sleep(0.2)
        print("done", 0, flush=True)
        await asyncio.sleep(60)

asyncio.run(live())
"""


@contextlib.contextmanager
def process(data_dir: Path, what: str) -> Iterator[subprocess.Popen[str]]:
    started = subprocess.Popen(
        [sys.executable, "-c", PROCESS, str(data_dir), what], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    try:
        yield started
    finally:
        started.kill()
        started.wait(10)
        assert started.stdout
        started.stdout.close()


def killed_after(data_dir: Path, what: str, frames: int) -> None:
    """Runs the process until it has written so many frames more, then kills it whatever it does."""
    with process(data_dir, what) as running:
        assert running.stdout
        seen = 0
        for line in running.stdout:
            word, _ = line.split()
            seen += word == "frame"
            if seen >= frames:
                break
        os.kill(running.pid, signal.SIGKILL)


def run_to_its_end(data_dir: Path, what: str) -> None:
    with process(data_dir, what) as running:
        assert running.stdout
        assert any(line.startswith("done") for line in running.stdout)


@pytest.mark.parametrize("what", ["frames", "edits"])
async def test_a_mapper_killed_again_and_again_makes_each_step_once(tmp_path: Path, what: str) -> None:
    for frames in (5, 16):
        killed_after(tmp_path, what, frames)
    run_to_its_end(tmp_path, what)

    store = await Store.connect(kernel_settings(tmp_path))
    try:
        steps = [step_of(entry) for entry in await store.read(SCENE, "map", count=1000)]
        reader = a_mapper(store)
        live = await reader.get_map(SCENE)
        proof = await reader.verify(SCENE)
        taken_in = [s.input.log_id for s in steps if s.delta.kind is StepKind.FRAME]  # type: ignore[union-attr]
        edited = [s.input.log_id for s in steps if isinstance(s.input, EditInput)]

        assert [s.delta.version for s in steps] == list(range(1, len(steps) + 1))
        assert taken_in == [e.id for e in await store.read(SCENE, "detections", count=1000)]
        assert len(taken_in) == len(LONG_RUN)
        assert proof.holds
        assert proof.snapshots > 3
        if what == "frames":
            assert live.state_hash == expected(LONG_RUN).state_hash()
        else:
            asked = await store.read(SCENE, "edits", count=1000)
            verdicts = await store.values(
                SCENE, "mapper", [f"verdict:{e.fields['edit_id'].decode()}" for e in asked]
            )
            assert len(verdicts) == len(asked) >= 8
            assert len(set(edited)) == len(edited)
            done = [name for name, verdict in verdicts.items() if b"version" in verdict[:10]]
            assert len(done) == len(edited) > 3
    finally:
        await store.close()
