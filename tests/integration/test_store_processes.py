"""The embedded server and the processes around it: killed, started twice, left behind."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from ovip.errors import Conflict, InvalidInput, Unavailable
from ovip.store import Append, Store, embedded
from tests.builders import kernel_settings

ROOT = Path(__file__).resolve().parents[2]

WRITER = """
import asyncio, sys
from pathlib import Path
from ovip.config import KernelSettings
from ovip.store import Append, Store

async def write() -> None:
    settings = KernelSettings(_env_file=None, redis_url=None, blob_url=None, data_dir=Path(sys.argv[1]))
    store = await Store.connect(settings)
    print("server", store._server._process.pid, flush=True)
    await store.add_scene("kitchen")
    lease = await store.acquire_lease("kitchen", "mapper", "the writer", 10)
    n = 0
    while True:
        n += 1
        ref = await store.blobs.put(b"frame %d" % n)
        taken = await store.ingest("kitchen", "r.s", n, f"f{n}", {"n": n, "blob": ref})
        await store.commit(lease, taken.log_id, [Append("map", {"version": n})], {"version": n})
        print("durable", n, flush=True)

asyncio.run(write())
"""


@contextlib.contextmanager
def writer(data_dir: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that owns an embedded store and writes frames until it is killed."""
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(data_dir)], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait(10)
        assert process.stdout
        process.stdout.close()


def _line(process: subprocess.Popen[str]) -> tuple[str, int]:
    assert process.stdout
    word, number = process.stdout.readline().split()
    return word, int(number)


def _gone(pid: int, within_s: float = 5.0) -> bool:
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        stat = Path(f"/proc/{pid}/stat")
        if not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z":
            return True
        time.sleep(0.02)
    return False


async def test_what_was_acknowledged_is_there_after_kill_9_of_the_whole_stack(tmp_path: Path) -> None:
    with writer(tmp_path) as process:
        _, server = _line(process)
        acknowledged = 0
        while acknowledged < 60:
            _, acknowledged = _line(process)
        os.kill(process.pid, signal.SIGKILL)
        assert process.stdout
        for line in process.stdout:
            acknowledged = int(line.split()[1])
    assert _gone(server)

    store = await Store.connect(kernel_settings(tmp_path))
    try:
        frames = await store.read("kitchen", "frames", count=10_000)
        versions = await store.read("kitchen", "map", count=10_000)
        assert [int(e.fields["n"]) for e in frames] == list(range(1, len(frames) + 1))
        assert [int(e.fields["version"]) for e in versions] == list(range(1, len(versions) + 1))
        assert len(frames) >= acknowledged
        assert len(versions) >= acknowledged
        for entry in frames:
            assert await store.blobs.get(entry.fields["blob"].decode()) == b"frame %d" % int(
                entry.fields["n"]
            )
        assert await store.cursor("kitchen", "mapper") == frames[len(versions) - 1].id
        assert int((await store.values("kitchen", "mapper", ["version"]))["version"]) == len(versions)
    finally:
        await store.close()


async def test_the_state_goes_on_where_it_was_after_a_gentle_stop(tmp_path: Path) -> None:
    store = await Store.connect(kernel_settings(tmp_path))
    lease = await store.acquire_lease("kitchen", "mapper", "me", 10)
    assert lease is not None
    await store.commit(lease, "5-0", [Append("map", {"v": 1})])
    await store.release(lease)
    await store.close()

    again = await Store.connect(kernel_settings(tmp_path))
    try:
        newer = await again.acquire_lease("kitchen", "mapper", "another", 10)
        assert newer is not None
        assert newer.fence > lease.fence
        assert not (await again.commit(newer, "5-0", [Append("map", {"v": 1})])).applied
        assert await again.length("kitchen", "map") == 1
    finally:
        await again.close()


async def test_closing_ends_the_server(tmp_path: Path) -> None:
    store = await Store.connect(kernel_settings(tmp_path))
    assert store._server
    pid = store._server._process.pid

    await store.close()

    assert _gone(pid)
    assert not store._server.socket.exists()


async def test_a_second_stack_over_the_same_directory_is_refused_in_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(embedded, "_LOCK_SECONDS", 0.3)
    with writer(tmp_path) as process:
        _line(process)

        with pytest.raises(
            Conflict, match="in use by another stack: stop it, or choose another OVIP_DATA_DIR"
        ):
            await Store.connect(kernel_settings(tmp_path))

        assert _line(process) == ("durable", 1)  # the first is not disturbed
        assert process.poll() is None


async def test_two_stacks_over_two_directories_do_not_meet(tmp_path: Path) -> None:
    one = await Store.connect(kernel_settings(tmp_path / "one"))
    other = await Store.connect(kernel_settings(tmp_path / "other"))
    try:
        await one.add_scene("kitchen")
        assert await other.scenes() == []
    finally:
        await one.close()
        await other.close()


async def test_a_directory_of_a_very_long_path_works(tmp_path: Path) -> None:
    """A unix socket's path ends at 107 bytes."""
    long = tmp_path / ("deep" * 20) / ("deeper" * 20)
    store = await Store.connect(kernel_settings(long))
    try:
        await store.add_scene("kitchen")
        assert await store.scenes() == ["kitchen"]
    finally:
        await store.close()


async def test_a_log_cut_off_in_its_last_write_is_read_up_to_there(tmp_path: Path) -> None:
    store = await Store.connect(kernel_settings(tmp_path))
    for n in range(1, 4):
        await store.ingest("kitchen", "r.s", n, f"f{n}", {"n": n})
    await store.close()
    log = max((tmp_path / "store").rglob("*.incr.aof"), key=lambda path: path.stat().st_size)
    log.write_bytes(log.read_bytes()[:-7])

    again = await Store.connect(kernel_settings(tmp_path))
    try:
        numbers = [e.fields["n"] for e in await again.read("kitchen", "frames")]
        assert numbers == [b"1", b"2", b"3"][: len(numbers)]
        assert len(numbers) >= 2
    finally:
        await again.close()


async def test_a_data_directory_that_cannot_be_written_is_refused_in_words(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")

    with pytest.raises(InvalidInput, match="OVIP_DATA_DIR: expected a writable directory"):
        await Store.connect(kernel_settings(tmp_path / "file"))


@pytest.mark.usefixtures("no_patience")
async def test_a_server_that_does_not_start_says_why(tmp_path: Path) -> None:
    (tmp_path / "store" / "appendonlydir").mkdir(parents=True)
    (tmp_path / "store" / "appendonlydir" / "appendonly.aof.manifest").write_text("nonsense")

    with pytest.raises(Unavailable, match=r"the embedded store (.|\n)*says: (.|\n)*manifest"):
        await Store.connect(kernel_settings(tmp_path))


@pytest.mark.usefixtures("no_patience")
async def test_a_server_killed_under_us_is_unavailable_and_close_still_works(tmp_path: Path) -> None:
    store = await Store.connect(kernel_settings(tmp_path))
    assert store._server
    store._server._process.kill()
    store._server._process.wait()
    try:
        with pytest.raises(Unavailable, match="the store cannot be reached"):
            await store.scenes()
    finally:
        await store.close()
