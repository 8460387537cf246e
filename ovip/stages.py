"""How a service follows the scenes: one writer per stage of a scene, held by a lease, restarted where it fails."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import uuid
from collections.abc import AsyncIterator, Awaitable, Callable

from ovip.errors import OvipError
from ovip.store import Lease, Store
from ovip.telemetry import get_logger

LEASE_SECONDS = 10.0
_LOOK_FOR_SCENES_SECONDS = 0.5
log = get_logger("stages")


def new_owner() -> str:
    """A name for this process as a lease holder."""
    return f"{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex[:8]}"


@contextlib.asynccontextmanager
async def holding(store: Store, scene: str, stage: str, owner: str) -> AsyncIterator[Lease]:
    """The lease of a stage, waited for, kept while the block runs, given back after.

    Losing it does not interrupt the block: every commit carries the fence and is refused then.
    """
    lease = await store.acquire_lease(scene, stage, owner, LEASE_SECONDS)
    while lease is None:
        await asyncio.sleep(LEASE_SECONDS / 10)
        lease = await store.acquire_lease(scene, stage, owner, LEASE_SECONDS)
    keeper = asyncio.create_task(_keep(store, lease))
    try:
        yield lease
    finally:
        keeper.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await keeper
        with contextlib.suppress(OvipError):
            await store.release(lease)


async def follow_scenes(store: Store, stage: str, work: Callable[[str], Awaitable[None]]) -> None:
    """Runs `work(scene)` for every scene, new ones as they appear, again a second after it fails."""
    tasks: dict[str, asyncio.Task[None]] = {}
    try:
        while True:
            for scene in await store.scenes():
                if scene not in tasks:
                    tasks[scene] = asyncio.create_task(
                        _keep_working(stage, scene, work), name=f"{stage}:{scene}"
                    )
            await asyncio.sleep(_LOOK_FOR_SCENES_SECONDS)
    finally:
        for task in tasks.values():
            task.cancel()
        await asyncio.gather(*tasks.values(), return_exceptions=True)


async def _keep_working(stage: str, scene: str, work: Callable[[str], Awaitable[None]]) -> None:
    while True:
        try:
            await work(scene)
        except OvipError as error:
            log.warning("stage_interrupted", stage=stage, scene=scene, error=str(error))
        except Exception:  # the supervisor of a stage: logs whatever it was and starts it again
            log.exception("stage_crashed", stage=stage, scene=scene)
        await asyncio.sleep(1.0)


async def _keep(store: Store, lease: Lease) -> None:
    while True:
        await asyncio.sleep(lease.ttl_s / 4)
        try:
            await store.renew(lease)
        except OvipError as error:
            log.warning("lease_not_renewed", stage=lease.stage, scene=lease.scene, error=str(error))
