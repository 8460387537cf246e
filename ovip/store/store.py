"""The store as the services see it: logs of a scene, leases, exactly-once steps, documents, budgets, blobs."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Mapping, Sequence
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
from ovip.store.dialect import CURSOR, cursor_field, entries_of, logs_of, spoken, words_of_step
from ovip.store.embedded import EmbeddedServer
from ovip.store.values import Append, Appended, Committed, Document, Entry, Ingested, Lease

START = "0-0"
_LOG_ID = re.compile(r"[0-9]{1,15}-[0-9]{1,15}")  # numbers that Lua's doubles hold exactly


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
        self._append_once = client.register_script(scripts.APPEND_ONCE)
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
        async with spoken():
            return sorted(name.decode() for name in await self._client.smembers(keys.SCENES))

    async def add_scene(self, scene: str) -> None:
        """Makes a scene known; again changes nothing."""
        keys.check_name(scene, "scene")
        async with spoken():
            await self._client.sadd(keys.SCENES, scene)

    async def ingest(
        self, scene: str, session: str, sequence: int, frame_id: str, fields: Mapping[str, bytes | str | int]
    ) -> Ingested:
        """Appends a frame to the scene's `frames` log unless its session and sequence are already there."""
        words = [word for pair in fields.items() for word in pair]
        async with spoken():
            entry, duplicate, length = await self._ingest(
                keys=[keys.stream(scene, "frames"), keys.sequences(scene), keys.frame_ids(scene)],
                args=[session, sequence, frame_id, scene, *words],
            )
        return Ingested(entry.decode(), bool(duplicate), int(length))

    async def last_sequence(self, scene: str, session: str) -> int:
        """The last sequence of a session that is in the log; 0 for none."""
        async with spoken():
            return int(await self._client.hget(keys.sequences(scene), session) or 0)

    async def frame_log_id(self, scene: str, frame_id: str) -> str | None:
        """The id of a frame's entry in the `frames` log."""
        async with spoken():
            found = await self._client.hget(keys.frame_ids(scene), frame_id)
        return found.decode() if found else None

    async def read(
        self, scene: str, stream: str, after: str = START, count: int = 100, block_ms: int | None = None
    ) -> list[Entry]:
        """Up to `count` entries of a log after id `after`; waits up to `block_ms` for the first, if given."""
        return (await self.read_any(scene, {stream: after}, count, block_ms))[stream]

    async def read_any(
        self, scene: str, after: Mapping[str, str], count: int = 100, block_ms: int | None = None
    ) -> dict[str, list[Entry]]:
        """Up to `count` entries of each log after its id; waits up to `block_ms` for the first of any, if given."""
        logs = {keys.stream(scene, stream): stream for stream in after}
        wanted = {log: after[stream] for log, stream in logs.items()}
        async with spoken():
            reply = await self._client.xread(wanted, count=count, block=block_ms)
        found: dict[str, list[Entry]] = {stream: [] for stream in after}
        for log, rows in logs_of(reply):
            found[logs[log]] = entries_of(rows)
        return found

    async def between(self, scene: str, stream: str, after: str, last: str, count: int = 100) -> list[Entry]:
        """Up to `count` entries of a log above id `after`, none above `last`."""
        async with spoken():
            found = await self._client.xrange(keys.stream(scene, stream), f"({after}", last, count)
        return entries_of(found)

    async def at_or_before(self, scene: str, stream: str, entry_id: str) -> Entry | None:
        """The newest entry of a log that is not above an id."""
        async with spoken():
            found = await self._client.xrevrange(keys.stream(scene, stream), entry_id, "-", 1)
        return entries_of(found)[0] if found else None

    async def append_once(
        self, scene: str, stream: str, key: str, fields: Mapping[str, bytes | str | int]
    ) -> Appended:
        """Appends an entry to a log, once a key: again, whatever the fields, changes nothing."""
        words = [word for pair in fields.items() for word in pair]
        async with spoken():
            entry, duplicate = await self._append_once(
                keys=[keys.stream(scene, stream), keys.once(scene, stream)], args=[key, *words]
            )
        return Appended(entry.decode(), bool(duplicate))

    async def entry_of(self, scene: str, stream: str, key: str) -> Entry | None:
        """The entry that `append_once` made for a key, or None."""
        async with spoken():
            found = await self._client.hget(keys.once(scene, stream), key)
        return await self.read_entry(scene, stream, found.decode()) if found else None

    async def read_entry(self, scene: str, stream: str, entry_id: str) -> Entry | None:
        """One entry by its id."""
        async with spoken():
            found = entries_of(await self._client.xrange(keys.stream(scene, stream), entry_id, entry_id))
        return found[0] if found else None

    async def newest(self, scene: str, stream: str, count: int = 1) -> list[Entry]:
        """The newest entries of a log, newest first."""
        async with spoken():
            return entries_of(await self._client.xrevrange(keys.stream(scene, stream), count=count))

    async def length(self, scene: str, stream: str) -> int:
        """Number of entries of a log."""
        async with spoken():
            return int(await self._client.xlen(keys.stream(scene, stream)))

    async def acquire_lease(self, scene: str, stage: str, owner: str, ttl_s: float) -> Lease | None:
        """The lease where it is free or already this owner's; else None."""
        async with spoken():
            fence = await self._acquire(
                keys=[keys.lease(scene, stage), keys.fence(scene, stage)], args=[owner, int(ttl_s * 1000)]
            )
        return Lease(scene, stage, owner, int(fence), ttl_s) if fence else None

    async def renew(self, lease: Lease) -> None:
        """Keeps the lease for another `ttl_s`; LeaseLost where another took it."""
        async with spoken():
            kept = await self._renew(
                keys=[keys.lease(lease.scene, lease.stage)],
                args=[lease.owner, lease.fence, int(lease.ttl_s * 1000)],
            )
        if not kept:
            raise LeaseLost(f"{lease.stage} of scene {lease.scene} is now written by another process")

    async def release(self, lease: Lease) -> None:
        """Gives the lease back, so that another need not wait for it to expire."""
        async with spoken():
            await self._release(keys=[keys.lease(lease.scene, lease.stage)], args=[lease.owner, lease.fence])

    async def cursor(self, scene: str, stage: str, name: str = CURSOR) -> str:
        """Id of the last input that a stage has committed; of one of its inputs, where it has several."""
        return (await self.cursors(scene, stage, [name]))[name]

    async def cursors(self, scene: str, stage: str, names: Sequence[str]) -> dict[str, str]:
        """Several cursors of a stage as of one moment."""
        async with spoken():
            found = await self._client.hmget(keys.state(scene, stage), [cursor_field(name) for name in names])
        return {name: at.decode() if at is not None else START for name, at in zip(names, found, strict=True)}

    async def commit(
        self,
        lease: Lease,
        inputs: str | Mapping[str, str],
        appends: Sequence[Append] = (),
        puts: Mapping[str, bytes | str | int] | None = None,
    ) -> Committed:
        """One step of a stage, atomically and once: appends, small values and cursors move together.

        inputs: the log id of the step's input, or one for each cursor, by its name. Raises LeaseLost where another
        writer holds the stage, Conflict where some of the inputs are done and some are not. Idempotent: inputs at
        or before their cursors change nothing.
        """
        inputs = {CURSOR: inputs} if isinstance(inputs, str) else inputs
        for what, given in [*inputs.items(), *(("entry", a.entry_id) for a in appends if a.entry_id)]:
            if not _LOG_ID.fullmatch(given):
                raise InvalidInput(f"{what}: expected a log id like 1700000000000-0, got {given[:80]!r}")
        async with spoken():
            reply = await self._commit(
                keys=[
                    keys.lease(lease.scene, lease.stage),
                    keys.state(lease.scene, lease.stage),
                    *(keys.stream(lease.scene, append.stream) for append in appends),
                ],
                args=[lease.owner, lease.fence, *words_of_step(inputs, puts or {}, appends)],
            )
        if reply[0] == -1:
            raise LeaseLost(f"{lease.stage} of scene {lease.scene} is now written by another process")
        if reply[0] == -2:
            raise Conflict(f"{lease.stage} of scene {lease.scene}: the step was made on an older state")
        return Committed(bool(reply[0]), tuple(item.decode() for item in reply[1:]))

    async def values(self, scene: str, stage: str, names: Sequence[str]) -> dict[str, bytes]:
        """What a stage's steps put under `names`; absent names are left out."""
        if not names:
            return {}
        async with spoken():
            found = await self._client.hmget(keys.state(scene, stage), [f"v:{name}" for name in names])
        return {name: value for name, value in zip(names, found, strict=True) if value is not None}

    async def load_document(self, scene: str, kind: str, name: str) -> Document | None:
        """A document with its revision, or None."""
        async with spoken():
            revision, data = await self._client.hmget(keys.documents(scene, kind), [f"r:{name}", f"b:{name}"])
        return Document(data, int(revision)) if data is not None else None

    async def save_document(
        self, scene: str, kind: str, name: str, data: bytes, expected_revision: int
    ) -> int:
        """Writes a document made on `expected_revision` (0: new); Conflict where it has moved on since."""
        async with spoken():
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
        async with spoken():
            found = await self._client.hkeys(keys.documents(scene, kind))
        return sorted(name.decode()[2:] for name in found if name.startswith(b"r:"))

    async def take_tokens(self, bucket: str, capacity: float, refill_per_s: float, amount: float) -> float:
        """Takes `amount` from a shared token bucket: 0.0 where taken, else the seconds until there is enough."""
        if amount > capacity:
            raise InvalidInput(
                f"bucket {bucket}: {amount:g} can never be taken from a capacity of {capacity:g}"
            )
        async with spoken():
            return float(await self._take(keys=[keys.bucket(bucket)], args=[capacity, refill_per_s, amount]))

    async def counter_add(self, name: str, amount: float) -> None:
        """Adds to a statistic (not exactly-once)."""
        async with spoken():
            await self._client.incrbyfloat(keys.counter(name), amount)

    async def counters(self, names: Sequence[str]) -> dict[str, float]:
        """Statistics by name; 0 where never counted."""
        async with spoken():
            found = [await self._client.get(keys.counter(name)) for name in names]
        return {name: float(value or 0) for name, value in zip(names, found, strict=True)}

    async def cache_get(self, key: str) -> bytes | None:
        """A cached reply, or None."""
        async with spoken():
            found: bytes | None = await self._client.get(keys.cache(key))
        return found

    async def cache_put(self, key: str, data: bytes, ttl_s: float) -> None:
        """Caches a reply for a while."""
        async with spoken():
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
