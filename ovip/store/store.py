"""The store as the services see it: logs of a scene, leases, exactly-once steps, documents, budgets, blobs."""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import redis.asyncio as redis
from redis.asyncio.retry import Retry
from redis.backoff import ExponentialBackoff
from redis.exceptions import ConnectionError as RedisConnectionError
from redis.exceptions import RedisError
from redis.exceptions import TimeoutError as RedisTimeoutError

from ovip import keys
from ovip.config import KernelSettings
from ovip.errors import Conflict, InvalidInput, LeaseLost, Unavailable
from ovip.store import scripts
from ovip.store.blobs import BlobStore, open_blobs
from ovip.store.embedded import EmbeddedServer

START = "0-0"
_LOG_ID = re.compile(r"[0-9]{1,15}-[0-9]{1,15}")  # numbers that Lua's doubles hold exactly


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a log."""

    id: str
    fields: dict[str, bytes]


@dataclass(frozen=True, slots=True)
class Append:
    """What a step adds to a log."""

    stream: str
    fields: Mapping[str, bytes | str | int]


@dataclass(frozen=True, slots=True)
class Ingested:
    """Where a frame is in the log; `log_id` is empty for a sequence that was passed over."""

    log_id: str
    duplicate: bool
    length: int


@dataclass(frozen=True, slots=True)
class Lease:
    """The right to write one stage of one scene, until it expires or another takes it."""

    scene: str
    stage: str
    owner: str
    fence: int
    ttl_s: float


@dataclass(frozen=True, slots=True)
class Committed:
    """Whether this call applied the step (else an earlier one did), and the ids of what it appended."""

    applied: bool
    ids: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Document:
    """A compare-and-set value."""

    data: bytes
    revision: int


class Store:
    """Speaks to one Redis-dialect server; every multi-step write is one idempotent script."""

    def __init__(self, client: Any, blobs: BlobStore, server: EmbeddedServer | None) -> None:
        self._client = client
        self._server = server
        self.blobs = blobs
        self._ingest = client.register_script(scripts.INGEST)
        self._acquire = client.register_script(scripts.ACQUIRE)
        self._renew = client.register_script(scripts.RENEW)
        self._release = client.register_script(scripts.RELEASE)
        self._commit = client.register_script(scripts.COMMIT)
        self._save = client.register_script(scripts.SAVE)
        self._take = client.register_script(scripts.TAKE)

    @classmethod
    async def connect(cls, settings: KernelSettings) -> Store:
        """The store at `OVIP_REDIS_URL`, else one supervised here over `OVIP_DATA_DIR`."""
        blobs = open_blobs(settings.blob_url, settings.data_dir)
        server = None
        retry = Retry(ExponentialBackoff(cap=1.0, base=0.05), 6)
        errors: list[type[Exception]] = [RedisConnectionError, RedisTimeoutError]
        if settings.redis_url:
            try:
                client = redis.Redis.from_url(
                    settings.redis_url,
                    retry=retry,
                    retry_on_error=errors,
                    socket_timeout=30,
                    socket_connect_timeout=5,
                )
            except ValueError:
                # neither the value nor what is wrong with it: it may hold a password
                raise InvalidInput(
                    "OVIP_REDIS_URL: expected redis://host:port/db, rediss://host:port/db or unix:///path"
                ) from None
        else:
            # started from this thread: the server dies with the thread that started it
            server = EmbeddedServer(settings.data_dir, settings.store_fsync)
            client = redis.Redis(
                unix_socket_path=str(server.socket), retry=retry, retry_on_error=errors, socket_timeout=30
            )
        store = cls(client, blobs, server)
        try:
            await store._wait_until_loaded()
        except Unavailable as error:
            await store.close()
            where = f"the embedded store says: {server.last_words()}" if server else "see OVIP_REDIS_URL"
            raise Unavailable(f"{error}; {where}") from error
        return store

    async def close(self) -> None:
        """Closes connections and, where it is ours, the server."""
        await self._client.aclose()
        if self._server:
            await asyncio.to_thread(self._server.close)

    async def scenes(self) -> list[str]:
        """All scenes, by name."""
        async with _spoken():
            return sorted(name.decode() for name in await self._client.smembers(keys.SCENES))

    async def add_scene(self, scene: str) -> None:
        """Makes a scene known; again changes nothing."""
        keys.check_name(scene, "scene")
        async with _spoken():
            await self._client.sadd(keys.SCENES, scene)

    async def ingest(
        self, scene: str, session: str, sequence: int, frame_id: str, fields: Mapping[str, bytes | str | int]
    ) -> Ingested:
        """Appends a frame to the scene's `frames` log unless its session and sequence are already there."""
        words = [word for pair in fields.items() for word in pair]
        async with _spoken():
            entry, duplicate, length = await self._ingest(
                keys=[keys.stream(scene, "frames"), keys.sequences(scene), keys.frame_ids(scene)],
                args=[session, sequence, frame_id, scene, *words],
            )
        return Ingested(entry.decode(), bool(duplicate), int(length))

    async def last_sequence(self, scene: str, session: str) -> int:
        """The last sequence of a session that is in the log; 0 for none."""
        async with _spoken():
            return int(await self._client.hget(keys.sequences(scene), session) or 0)

    async def frame_log_id(self, scene: str, frame_id: str) -> str | None:
        """The id of a frame's entry in the `frames` log."""
        async with _spoken():
            found = await self._client.hget(keys.frame_ids(scene), frame_id)
        return found.decode() if found else None

    async def read(
        self, scene: str, stream: str, after: str = START, count: int = 100, block_ms: int | None = None
    ) -> list[Entry]:
        """Up to `count` entries of a log after id `after`; waits up to `block_ms` for the first, if given."""
        async with _spoken():
            reply = await self._client.xread({keys.stream(scene, stream): after}, count=count, block=block_ms)
        return _entries(_rows(reply))

    async def read_entry(self, scene: str, stream: str, entry_id: str) -> Entry | None:
        """One entry by its id."""
        async with _spoken():
            found = _entries(await self._client.xrange(keys.stream(scene, stream), entry_id, entry_id))
        return found[0] if found else None

    async def newest(self, scene: str, stream: str, count: int = 1) -> list[Entry]:
        """The newest entries of a log, newest first."""
        async with _spoken():
            return _entries(await self._client.xrevrange(keys.stream(scene, stream), count=count))

    async def length(self, scene: str, stream: str) -> int:
        """Number of entries of a log."""
        async with _spoken():
            return int(await self._client.xlen(keys.stream(scene, stream)))

    async def acquire_lease(self, scene: str, stage: str, owner: str, ttl_s: float) -> Lease | None:
        """The lease where it is free or already this owner's; else None."""
        async with _spoken():
            fence = await self._acquire(
                keys=[keys.lease(scene, stage), keys.fence(scene, stage)], args=[owner, int(ttl_s * 1000)]
            )
        return Lease(scene, stage, owner, int(fence), ttl_s) if fence else None

    async def renew(self, lease: Lease) -> None:
        """Keeps the lease for another `ttl_s`; LeaseLost where another took it."""
        async with _spoken():
            kept = await self._renew(
                keys=[keys.lease(lease.scene, lease.stage)],
                args=[lease.owner, lease.fence, int(lease.ttl_s * 1000)],
            )
        if not kept:
            raise LeaseLost(f"{lease.stage} of scene {lease.scene} is now written by another process")

    async def release(self, lease: Lease) -> None:
        """Gives the lease back, so that another need not wait for it to expire."""
        async with _spoken():
            await self._release(keys=[keys.lease(lease.scene, lease.stage)], args=[lease.owner, lease.fence])

    async def cursor(self, scene: str, stage: str) -> str:
        """Id of the last input that a stage has committed."""
        async with _spoken():
            found = await self._client.hget(keys.state(scene, stage), "cursor")
        return found.decode() if found else START

    async def commit(
        self,
        lease: Lease,
        input_id: str,
        appends: Sequence[Append] = (),
        puts: Mapping[str, bytes | str | int] | None = None,
    ) -> Committed:
        """One step of a stage, atomically and once: appends, small values and the cursor move together.

        Raises LeaseLost where another writer holds the stage. Idempotent: an input at or before the cursor
        changes nothing.
        """
        if not _LOG_ID.fullmatch(input_id):
            raise InvalidInput(f"input_id: expected a log id like 1700000000000-0, got {input_id[:80]!r}")
        puts = puts or {}
        args: list[bytes | str | int] = [lease.owner, lease.fence, input_id, len(puts)]
        for pair in puts.items():
            args.extend(pair)
        for append in appends:
            args.append(2 * len(append.fields))
            for field_pair in append.fields.items():
                args.extend(field_pair)
        async with _spoken():
            reply = await self._commit(
                keys=[
                    keys.lease(lease.scene, lease.stage),
                    keys.state(lease.scene, lease.stage),
                    *(keys.stream(lease.scene, append.stream) for append in appends),
                ],
                args=args,
            )
        if reply[0] == -1:
            raise LeaseLost(f"{lease.stage} of scene {lease.scene} is now written by another process")
        return Committed(bool(reply[0]), tuple(item.decode() for item in reply[1:]))

    async def values(self, scene: str, stage: str, names: Sequence[str]) -> dict[str, bytes]:
        """What a stage's steps put under `names`; absent names are left out."""
        if not names:
            return {}
        async with _spoken():
            found = await self._client.hmget(keys.state(scene, stage), [f"v:{name}" for name in names])
        return {name: value for name, value in zip(names, found, strict=True) if value is not None}

    async def load_document(self, scene: str, kind: str, name: str) -> Document | None:
        """A document with its revision, or None."""
        async with _spoken():
            revision, data = await self._client.hmget(keys.documents(scene, kind), [f"r:{name}", f"b:{name}"])
        return Document(data, int(revision)) if data is not None else None

    async def save_document(
        self, scene: str, kind: str, name: str, data: bytes, expected_revision: int
    ) -> int:
        """Writes a document made on `expected_revision` (0: new); Conflict where it has moved on since."""
        async with _spoken():
            revision = await self._save(
                keys=[keys.documents(scene, kind)], args=[name, expected_revision, data]
            )
        if revision < 0:
            raise Conflict(
                f"{kind} {name} is at revision {-1 - revision}, the change was made on {expected_revision}"
            )
        return int(revision)

    async def list_documents(self, scene: str, kind: str) -> list[str]:
        """Names of a scene's documents of one kind, sorted."""
        async with _spoken():
            found = await self._client.hkeys(keys.documents(scene, kind))
        return sorted(name.decode()[2:] for name in found if name.startswith(b"r:"))

    async def take_tokens(self, bucket: str, capacity: float, refill_per_s: float, amount: float) -> float:
        """Takes `amount` from a shared token bucket: 0.0 where taken, else the seconds until there is enough."""
        if amount > capacity:
            raise InvalidInput(
                f"bucket {bucket}: {amount:g} can never be taken from a capacity of {capacity:g}"
            )
        async with _spoken():
            return float(await self._take(keys=[keys.bucket(bucket)], args=[capacity, refill_per_s, amount]))

    async def counter_add(self, name: str, amount: float) -> None:
        """Adds to a statistic (not exactly-once)."""
        async with _spoken():
            await self._client.incrbyfloat(keys.counter(name), amount)

    async def counters(self, names: Sequence[str]) -> dict[str, float]:
        """Statistics by name; 0 where never counted."""
        async with _spoken():
            found = [await self._client.get(keys.counter(name)) for name in names]
        return {name: float(value or 0) for name, value in zip(names, found, strict=True)}

    async def cache_get(self, key: str) -> bytes | None:
        """A cached reply, or None."""
        async with _spoken():
            found: bytes | None = await self._client.get(keys.cache(key))
        return found

    async def cache_put(self, key: str, data: bytes, ttl_s: float) -> None:
        """Caches a reply for a while."""
        async with _spoken():
            await self._client.set(keys.cache(key), data, px=int(ttl_s * 1000))

    async def _wait_until_loaded(self) -> None:
        for _ in range(600):
            try:
                await self._client.ping()
                return
            except redis.BusyLoadingError:
                await asyncio.sleep(0.1)
            except RedisError as error:
                raise Unavailable(f"the store cannot be reached: {error}") from error
        raise Unavailable("the store is still loading its log after a minute")


@contextlib.asynccontextmanager
async def _spoken() -> AsyncIterator[None]:
    """Turns the client library's errors into ours, and never lets it swallow a cancellation (its wait_for can).

    Only one that came meanwhile: what a cancelled task says on its way out still goes through.
    """
    task = asyncio.current_task()
    cancelled_before = task.cancelling() if task else 0
    try:
        yield
        if task and task.cancelling() > cancelled_before:
            raise asyncio.CancelledError
    except (RedisConnectionError, RedisTimeoutError) as error:
        raise Unavailable(f"the store cannot be reached: {error}") from error
    except RedisError as error:
        raise Unavailable(f"the store refused: {error}") from error


def _rows(reply: Any) -> list[Any]:
    """Rows of a one-stream XREAD reply, in the RESP2 (list) or RESP3 (dict) form."""
    if not reply:
        return []
    if isinstance(reply, dict):
        (chunks,) = reply.values()
        return (
            [row for chunk in chunks for row in chunk]
            if chunks and isinstance(chunks[0], list)
            else list(chunks)
        )
    return list(reply[0][1])


def _entries(rows: list[Any]) -> list[Entry]:
    return [
        Entry(entry.decode(), {name.decode(): value for name, value in fields.items()})
        for entry, fields in rows
        if fields is not None
    ]
