"""The store on a real server: exactly-once writes, leases, documents, budgets. Embedded or by URL, the same."""

from __future__ import annotations

import asyncio
import contextlib
import subprocess
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
import pytest_asyncio

from ovip.errors import Conflict, InvalidInput, LeaseLost, NotFound, Unavailable
from ovip.store import Append, Store
from ovip.store.embedded import server_binary
from tests.builders import kernel_settings

SCENE = "kitchen"


@contextlib.contextmanager
def server_at(socket: Path) -> Iterator[str]:
    """A server that is not ours, as one that OVIP_REDIS_URL names; yields its URL."""
    process = subprocess.Popen(
        [
            server_binary(),
            "--port",
            "0",
            "--unixsocket",
            str(socket),
            "--save",
            "",
            "--dir",
            str(socket.parent),
        ],
        stdout=subprocess.DEVNULL,
    )
    try:
        for _ in range(500):
            if socket.exists():
                break
            time.sleep(0.01)
        yield f"unix://{socket}"
    finally:
        process.terminate()
        process.wait(10)


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """One server for the module; every test starts with it empty."""
    with server_at(tmp_path_factory.mktemp("s") / "s") as address:
        yield address


@pytest_asyncio.fixture(params=["embedded", "url"])
async def store(request: pytest.FixtureRequest, tmp_path: Path) -> AsyncIterator[Store]:
    """The store in both of its forms: what holds for one holds for the other."""
    redis_url = request.getfixturevalue("url") if request.param == "url" else None
    opened = await Store.connect(kernel_settings(tmp_path / "data", redis_url=redis_url))
    await opened._client.flushall()
    yield opened
    if opened._server:
        opened._server._process.kill()  # its data goes with the directory: a gentle stop takes longer
    await opened.close()


# Scenes


async def test_scenes_are_listed_by_name_once_each(store: Store) -> None:
    for scene in ("kitchen", "attic", "kitchen"):
        await store.add_scene(scene)

    assert await store.scenes() == ["attic", "kitchen"]


async def test_a_scene_of_a_bad_name_is_refused(store: Store) -> None:
    with pytest.raises(InvalidInput, match="scene"):
        await store.add_scene("a/b")
    with pytest.raises(InvalidInput, match="scene"):
        await store.read("a b", "frames")


# Ingest


async def test_frames_lie_in_the_log_in_the_order_they_came(store: Store) -> None:
    taken = [await store.ingest(SCENE, "r.s", n, f"f{n}", {"n": n}) for n in (1, 2, 5)]

    assert [t.duplicate for t in taken] == [False, False, False]
    assert [t.length for t in taken] == [1, 2, 3]
    entries = await store.read(SCENE, "frames")
    assert [e.fields["n"] for e in entries] == [b"1", b"2", b"5"]
    assert [e.id for e in entries] == [t.log_id for t in taken]


async def test_a_frame_sent_again_changes_nothing_and_gets_the_same_id(store: Store) -> None:
    first = await store.ingest(SCENE, "r.s", 1, "f1", {"n": 1})
    await store.ingest(SCENE, "r.s", 2, "f2", {"n": 2})

    again = await store.ingest(SCENE, "r.s", 1, "f1", {"n": "other bytes"})

    assert again.duplicate
    assert again.log_id == first.log_id
    assert await store.length(SCENE, "frames") == 2
    assert await store.last_sequence(SCENE, "r.s") == 2


async def test_a_sequence_that_was_passed_over_is_not_taken_and_has_no_id(store: Store) -> None:
    await store.ingest(SCENE, "r.s", 5, "f5", {"n": 5})

    late = await store.ingest(SCENE, "r.s", 3, "f3", {"n": 3})

    assert (late.log_id, late.duplicate) == ("", True)
    assert await store.frame_log_id(SCENE, "f3") is None
    assert await store.length(SCENE, "frames") == 1


async def test_sessions_and_scenes_count_for_themselves(store: Store) -> None:
    await store.ingest(SCENE, "r.s1", 7, "a", {"n": 1})
    await store.ingest(SCENE, "r.s2", 1, "b", {"n": 2})
    await store.ingest("attic", "r.s1", 2, "a", {"n": 3})

    assert await store.last_sequence(SCENE, "r.s1") == 7
    assert await store.last_sequence(SCENE, "r.s2") == 1
    assert await store.last_sequence("attic", "r.s1") == 2
    assert await store.last_sequence(SCENE, "nobody") == 0
    assert await store.length("attic", "frames") == 1


async def test_many_robots_sending_the_same_frames_at_once_lose_and_double_nothing(store: Store) -> None:
    async def robot() -> None:
        for n in range(1, 21):
            await store.ingest(SCENE, "r.s", n, f"f{n:02d}", {"n": n})

    await asyncio.gather(*(robot() for _ in range(4)))

    ids = [e.fields["n"] for e in await store.read(SCENE, "frames")]
    assert ids == [str(n).encode() for n in range(1, 21)]


# Reading


async def test_reading_starts_after_an_id_and_stops_at_a_count(store: Store) -> None:
    taken = [await store.ingest(SCENE, "r.s", n, f"f{n}", {"n": n}) for n in range(1, 6)]

    entries = await store.read(SCENE, "frames", after=taken[1].log_id, count=2)

    assert [e.fields["n"] for e in entries] == [b"3", b"4"]


async def test_an_empty_log_reads_as_nothing(store: Store) -> None:
    assert await store.read(SCENE, "frames") == []
    assert await store.length(SCENE, "frames") == 0
    assert await store.newest(SCENE, "frames") == []
    assert await store.read_entry(SCENE, "frames", "1-1") is None


async def test_a_reader_that_waits_gets_the_entry_when_it_comes(store: Store) -> None:
    waiting = asyncio.create_task(store.read(SCENE, "frames", block_ms=5000))
    await asyncio.sleep(0.05)
    assert not waiting.done()

    await store.ingest(SCENE, "r.s", 1, "f1", {"n": 1})

    assert [e.fields["n"] for e in await asyncio.wait_for(waiting, 2)] == [b"1"]


async def test_a_reader_waits_no_longer_than_it_said(store: Store) -> None:
    started = time.monotonic()

    assert await store.read(SCENE, "frames", block_ms=50) == []
    assert 0.04 < time.monotonic() - started < 2


async def test_the_newest_entries_come_newest_first(store: Store) -> None:
    for n in range(1, 4):
        await store.ingest(SCENE, "r.s", n, f"f{n}", {"n": n})

    assert [e.fields["n"] for e in await store.newest(SCENE, "frames", 2)] == [b"3", b"2"]


# Leases


async def test_a_second_owner_gets_no_lease_until_the_first_gives_it_back(store: Store) -> None:
    mine = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert mine is not None

    assert await store.acquire_lease(SCENE, "mapper", "you", 10) is None
    await store.release(mine)
    yours = await store.acquire_lease(SCENE, "mapper", "you", 10)

    assert yours is not None
    assert yours.fence > mine.fence


async def test_its_owner_gets_the_same_lease_again(store: Store) -> None:
    first = await store.acquire_lease(SCENE, "mapper", "me", 10)

    assert await store.acquire_lease(SCENE, "mapper", "me", 10) == first


async def test_leases_of_other_stages_and_scenes_are_free(store: Store) -> None:
    await store.acquire_lease(SCENE, "mapper", "me", 10)

    assert await store.acquire_lease(SCENE, "perception", "you", 10)
    assert await store.acquire_lease("attic", "mapper", "you", 10)


async def test_an_expired_lease_is_taken_over_and_its_old_owner_is_told(store: Store) -> None:
    mine = await store.acquire_lease(SCENE, "mapper", "me", 0.05)
    assert mine is not None
    await asyncio.sleep(0.1)

    yours = await store.acquire_lease(SCENE, "mapper", "you", 10)

    assert yours is not None
    assert yours.fence > mine.fence
    with pytest.raises(LeaseLost, match="mapper of scene kitchen"):
        await store.renew(mine)


async def test_a_renewed_lease_does_not_expire(store: Store) -> None:
    mine = await store.acquire_lease(SCENE, "mapper", "me", 0.4)
    assert mine is not None
    for _ in range(4):
        await asyncio.sleep(0.15)
        await store.renew(mine)

    assert await store.acquire_lease(SCENE, "mapper", "you", 10) is None


async def test_the_old_owner_cannot_give_back_the_new_owners_lease(store: Store) -> None:
    mine = await store.acquire_lease(SCENE, "mapper", "me", 0.05)
    assert mine is not None
    await asyncio.sleep(0.1)
    yours = await store.acquire_lease(SCENE, "mapper", "you", 10)
    assert yours is not None

    await store.release(mine)

    await store.renew(yours)


async def test_a_lease_that_ran_out_with_nobody_after_it_must_be_taken_anew(store: Store) -> None:
    mine = await store.acquire_lease(SCENE, "mapper", "me", 0.05)
    assert mine is not None
    await asyncio.sleep(0.1)

    with pytest.raises(LeaseLost):
        await store.renew(mine)
    again = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert again is not None
    assert again.fence > mine.fence


# Commit


async def test_a_step_appends_puts_and_moves_the_cursor_together(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None

    done = await store.commit(
        lease,
        "5-0",
        [Append("map", {"v": 1}), Append("map", {"v": b"\x00\xff"}), Append("log", {"x": "y"})],
        {"version": 7},
    )

    assert done.applied
    assert [e.id for e in await store.read(SCENE, "map")] == list(done.ids[:2])
    assert [e.fields for e in await store.read(SCENE, "map")] == [{"v": b"1"}, {"v": b"\x00\xff"}]
    assert [e.fields for e in await store.read(SCENE, "log")] == [{"x": b"y"}]
    assert await store.values(SCENE, "mapper", ["version", "absent"]) == {"version": b"7"}
    assert await store.cursor(SCENE, "mapper") == "5-0"


async def test_a_step_done_again_changes_nothing(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None
    await store.commit(lease, "5-3", [Append("map", {"v": 1})], {"version": 1})

    for input_id in ("5-3", "5-2", "4-9"):
        again = await store.commit(lease, input_id, [Append("map", {"v": 2})], {"version": 2})
        assert not again.applied

    assert await store.length(SCENE, "map") == 1
    assert await store.values(SCENE, "mapper", ["version"]) == {"version": b"1"}
    assert await store.cursor(SCENE, "mapper") == "5-3"


async def test_ids_are_compared_as_numbers(store: Store) -> None:
    """As text, 10-0 lies before 9-0, and 9-10 before 9-9."""
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None

    for input_id in ("9-0", "9-9", "9-10", "10-0"):
        assert (await store.commit(lease, input_id, [Append("map", {"at": input_id})])).applied

    assert await store.length(SCENE, "map") == 4


async def test_a_commit_after_a_takeover_is_refused_and_changes_nothing(store: Store) -> None:
    mine = await store.acquire_lease(SCENE, "mapper", "me", 0.05)
    assert mine is not None
    await asyncio.sleep(0.1)
    yours = await store.acquire_lease(SCENE, "mapper", "you", 10)
    assert yours is not None

    with pytest.raises(LeaseLost, match="now written by another process"):
        await store.commit(mine, "5-0", [Append("map", {"v": 1})], {"version": 1})

    assert await store.length(SCENE, "map") == 0
    assert await store.cursor(SCENE, "mapper") == "0-0"
    assert (await store.commit(yours, "5-0", [Append("map", {"v": 1})])).applied


async def test_a_commit_without_a_living_lease_is_refused(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 0.05)
    assert lease is not None
    await asyncio.sleep(0.1)

    with pytest.raises(LeaseLost):
        await store.commit(lease, "1-0")


async def test_a_commit_that_the_server_cannot_carry_out_leaves_nothing_behind(store: Store) -> None:
    """The second append goes to a key that is no log."""
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None
    await store._client.set("{default/kitchen}:stream:broken", "not a stream")

    with pytest.raises(Unavailable, match="the store refused"):
        await store.commit(
            lease, "5-0", [Append("map", {"v": 1}), Append("broken", {"v": 1})], {"version": 1}
        )

    assert await store.length(SCENE, "map") == 0
    assert await store.values(SCENE, "mapper", ["version"]) == {}
    assert await store.cursor(SCENE, "mapper") == "0-0"


async def test_an_input_id_that_is_none_is_refused_in_words(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None

    with pytest.raises(InvalidInput, match="log id"):
        await store.commit(lease, "yesterday")


async def test_a_step_of_two_inputs_moves_both_cursors_or_none(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None

    assert (await store.commit(lease, {"cursor": "7-0", "version": "1-0"}, [Append("map", {"v": 1})])).applied
    assert (await store.commit(lease, {"edits": "3-0", "version": "2-0"}, [Append("map", {"v": 2})])).applied
    again = await store.commit(lease, {"edits": "3-0", "version": "2-0"}, [Append("map", {"v": 2})])
    with pytest.raises(Conflict, match="the step was made on an older state"):
        await store.commit(
            lease, {"cursor": "8-0", "version": "2-0"}, [Append("map", {"v": 9})], {"version": 9}
        )

    assert not again.applied
    assert [e.fields["v"] for e in await store.read(SCENE, "map")] == [b"1", b"2"]
    assert await store.cursors(SCENE, "mapper", ["cursor", "edits", "version", "never"]) == {
        "cursor": "7-0",
        "edits": "3-0",
        "version": "2-0",
        "never": "0-0",
    }
    assert await store.cursor(SCENE, "mapper", "edits") == "3-0"
    assert await store.values(SCENE, "mapper", ["version"]) == {}


async def test_an_entry_may_have_an_id_of_its_own_above_those_that_are_there(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None

    done = await store.commit(lease, "1-0", [Append("map", {"v": 1}, "1-0"), Append("map", {"v": 2}, "2-0")])
    for wrong in ("2-0", "1-5"):
        with pytest.raises(Unavailable, match="the store refused: .*is already at 2-0"):
            await store.commit(
                lease, "2-0", [Append("log", {"x": 1}), Append("map", {"v": 3}, wrong)], {"version": 3}
            )
    with pytest.raises(Unavailable, match="is already at 4-0"):
        await store.commit(lease, "2-0", [Append("map", {"v": 4}, "4-0"), Append("map", {"v": 3}, "3-0")])

    assert done.ids == ("1-0", "2-0")
    assert [e.id for e in await store.read(SCENE, "map")] == ["1-0", "2-0"]
    assert await store.length(SCENE, "log") == 0
    assert await store.values(SCENE, "mapper", ["version"]) == {}
    assert await store.cursor(SCENE, "mapper") == "1-0"


# Reading parts of a log


async def test_a_log_is_read_between_two_ids_and_from_an_id_backwards(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None
    ids = [f"{n}-0" for n in (1, 4, 5, 9, 10)]
    await store.commit(lease, "1-0", [Append("map", {"v": 1}, at) for at in ids])

    assert [e.id for e in await store.between(SCENE, "map", "1-0", "9-0")] == ["4-0", "5-0", "9-0"]
    assert [e.id for e in await store.between(SCENE, "map", "0-0", "9-0", 2)] == ["1-0", "4-0"]
    assert await store.between(SCENE, "map", "10-0", "10-0") == []
    for at, expected in (("9-0", "9-0"), ("8-0", "5-0"), ("1000-0", "10-0")):
        found = await store.at_or_before(SCENE, "map", at)
        assert found is not None
        assert found.id == expected
    assert await store.at_or_before(SCENE, "map", "0-5") is None


async def test_several_logs_are_waited_for_at_once(store: Store) -> None:
    lease = await store.acquire_lease(SCENE, "mapper", "me", 10)
    assert lease is not None
    after = {"detections": "0-0", "edits": "0-0"}
    assert await store.read_any(SCENE, after) == {"detections": [], "edits": []}

    waiting = asyncio.create_task(store.read_any(SCENE, after, block_ms=10_000))
    await asyncio.sleep(0.05)
    await store.commit(lease, "1-0", [Append("edits", {"e": 1})])
    async with asyncio.timeout(5):
        found = await waiting

    assert [e.fields for e in found["edits"]] == [{"e": b"1"}]
    assert found["detections"] == []


# Once a key


async def test_an_entry_is_appended_once_a_key(store: Store) -> None:
    first = await store.append_once(SCENE, "edits", "e1", {"label": "cup"})
    again = await asyncio.gather(
        *(store.append_once(SCENE, "edits", "e1", {"label": f"mug {n}"}) for n in range(8))
    )
    other = await store.append_once(SCENE, "edits", "e2", {"label": "cup"})

    assert not first.duplicate
    assert all(one.duplicate and one.id == first.id for one in again)
    assert [e.id for e in await store.read(SCENE, "edits")] == [first.id, other.id]
    found = await store.entry_of(SCENE, "edits", "e1")
    assert found is not None
    assert found.fields == {"label": b"cup"}
    assert await store.entry_of(SCENE, "edits", "never") is None


# Documents


async def test_a_document_is_written_on_the_revision_it_was_made_on(store: Store) -> None:
    assert await store.load_document(SCENE, "search", "s1") is None

    assert await store.save_document(SCENE, "search", "s1", b"one", 0) == 1
    assert await store.save_document(SCENE, "search", "s1", b"two", 1) == 2

    found = await store.load_document(SCENE, "search", "s1")
    assert found is not None
    assert (found.data, found.revision) == (b"two", 2)


async def test_a_change_made_on_an_older_revision_conflicts_and_changes_nothing(store: Store) -> None:
    await store.save_document(SCENE, "search", "s1", b"one", 0)
    await store.save_document(SCENE, "search", "s1", b"two", 1)

    with pytest.raises(Conflict, match="search s1 is at revision 2, the change was made on 1"):
        await store.save_document(SCENE, "search", "s1", b"three", 1)
    with pytest.raises(Conflict, match="is at revision 2, the change was made on 0"):
        await store.save_document(SCENE, "search", "s1", b"three", 0)
    with pytest.raises(Conflict, match="is at revision 0, the change was made on 4"):
        await store.save_document(SCENE, "search", "s2", b"three", 4)

    found = await store.load_document(SCENE, "search", "s1")
    assert found is not None
    assert (found.data, found.revision) == (b"two", 2)


async def test_saving_the_same_bytes_again_after_a_lost_reply_succeeds_once(store: Store) -> None:
    assert await store.save_document(SCENE, "search", "s1", b"one", 0) == 1
    assert await store.save_document(SCENE, "search", "s1", b"one", 0) == 1

    found = await store.load_document(SCENE, "search", "s1")
    assert found is not None
    assert found.revision == 1


async def test_of_many_writers_on_one_revision_one_wins(store: Store) -> None:
    async def write(n: int) -> int | None:
        try:
            return await store.save_document(SCENE, "search", "s1", f"by {n}".encode(), 0)
        except Conflict:
            return None

    results = await asyncio.gather(*(write(n) for n in range(8)))

    assert sorted(r for r in results if r) == [1]


async def test_documents_are_listed_by_kind(store: Store) -> None:
    for name in ("b", "a", "r:odd"):
        await store.save_document(SCENE, "search", name, b"x", 0)
    await store.save_document(SCENE, "other", "c", b"x", 0)

    assert await store.list_documents(SCENE, "search") == ["a", "b", "r:odd"]
    assert await store.list_documents("attic", "search") == []


# Budgets, statistics, replies


async def test_a_bucket_gives_what_it_holds_and_then_says_how_long_to_wait(store: Store) -> None:
    assert [await store.take_tokens("b", 3, 2.0, 1) for _ in range(3)] == [0.0, 0.0, 0.0]

    wait = await store.take_tokens("b", 3, 2.0, 1)

    assert 0.3 < wait <= 0.5  # one token at two a second, less the time since


async def test_a_bucket_fills_again_but_not_beyond_its_capacity(store: Store) -> None:
    assert await store.take_tokens("b", 2, 100.0, 2) == 0.0
    await asyncio.sleep(0.1)

    assert await store.take_tokens("b", 2, 100.0, 2) == 0.0
    assert await store.take_tokens("b", 2, 100.0, 2) > 0.0


async def test_a_take_that_has_to_wait_takes_nothing(store: Store) -> None:
    await store.take_tokens("b", 10, 0.01, 8)

    assert await store.take_tokens("b", 10, 0.01, 5) > 0
    assert await store.take_tokens("b", 10, 0.01, 2) == 0.0


async def test_more_than_a_bucket_can_ever_hold_is_refused(store: Store) -> None:
    with pytest.raises(InvalidInput, match="11 can never be taken from a capacity of 10"):
        await store.take_tokens("b", 10, 1.0, 11)


async def test_all_takers_together_get_no_more_than_the_bucket_holds(store: Store) -> None:
    waits = await asyncio.gather(*(store.take_tokens("b", 5, 0.001, 1) for _ in range(20)))

    assert sum(wait == 0.0 for wait in waits) == 5


async def test_counters_add_up_and_start_at_zero(store: Store) -> None:
    await store.counter_add("calls", 1)
    await store.counter_add("calls", 2.5)

    assert await store.counters(["calls", "never"]) == {"calls": 3.5, "never": 0.0}


async def test_a_cached_reply_goes_after_its_time(store: Store) -> None:
    await store.cache_put("k", b"reply", 0.05)
    assert await store.cache_get("k") == b"reply"
    await asyncio.sleep(0.1)

    assert await store.cache_get("k") is None
    assert await store.cache_get("never") is None


# Blobs


async def test_blobs_lie_beside_the_store(store: Store) -> None:
    ref = await store.blobs.put(b"bytes")

    assert await store.blobs.get(ref) == b"bytes"
    with pytest.raises(NotFound, match=f"blob {'0' * 64}"):
        await store.blobs.get("0" * 64)


# Cancellation


async def test_a_cancelled_task_ends_whatever_it_was_asking_the_store(store: Store) -> None:
    """On Python 3.11 the client's wait_for loses a cancellation that comes as a write ends."""

    async def ask_for_ever() -> None:
        while True:
            await store.scenes()

    for steps in range(40):
        task = asyncio.create_task(ask_for_ever())
        for _ in range(steps):
            await asyncio.sleep(0)
        task.cancel()
        done, _ = await asyncio.wait({task}, timeout=2)
        assert done, f"cancelled after {steps} steps, still running"
        assert task.cancelled()


async def test_a_cancelled_task_may_still_speak_to_the_store_on_its_way_out(store: Store) -> None:
    begun = asyncio.Event()

    async def tidy_up() -> None:
        try:
            begun.set()
            await asyncio.Event().wait()
        finally:
            await store.add_scene("first")
            await store.add_scene("second")

    task = asyncio.create_task(tidy_up())
    await begun.wait()
    task.cancel()
    await asyncio.wait({task}, timeout=2)

    assert task.cancelled()
    assert await store.scenes() == ["first", "second"]


# A server that cannot be reached


@pytest.mark.usefixtures("no_patience")
async def test_a_url_that_nothing_answers_is_named_in_the_error(tmp_path: Path) -> None:
    with pytest.raises(Unavailable, match="OVIP_REDIS_URL"):
        await Store.connect(kernel_settings(tmp_path, redis_url=f"unix://{tmp_path}/nothing"))


@pytest.mark.parametrize("bad", ["localhost:6379", "http://h", "redis://h:port/0", "redis://:secret@h:port"])
async def test_a_url_that_is_none_is_refused_without_repeating_it(bad: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="OVIP_REDIS_URL: expected redis://host:port/db") as refused:
        await Store.connect(kernel_settings(tmp_path, redis_url=bad))

    assert "secret" not in str(refused.value)


@pytest.mark.usefixtures("no_patience")
async def test_a_server_that_goes_away_is_unavailable_in_words(tmp_path: Path) -> None:
    with server_at(tmp_path / "s") as address:
        store = await Store.connect(kernel_settings(tmp_path, redis_url=address))
        await store.add_scene(SCENE)
    try:
        with pytest.raises(Unavailable, match="the store cannot be reached"):
            await store.scenes()
    finally:
        await store.close()
