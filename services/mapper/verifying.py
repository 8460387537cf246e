"""The proof that a map is what its log says: the log done again from its first entry, hash against hash."""

from __future__ import annotations

import asyncio

from ovip.errors import Corrupt, InvalidInput, NotFound
from ovip.scene.versions import Verification
from ovip.telemetry import get_logger
from services.mapper.history import History, MapAt
from services.mapper.snapshots import Snapshot

log = get_logger("mapper")


async def verified(history: History, scene: str, version: int, state_hash: str) -> Verification:
    """A map in use at `version`, whose hash is `state_hash`, against the one rebuilt from its whole log.

    Differing versions: steps whose outcome is not what the log says, snapshots whose hash is not the rebuilt map's,
    and the newest snapshot, which the next start reads, where it cannot be read back. Corrupt where the log cannot
    be done again.
    """
    rebuilt = MapAt()
    differing: set[int] = set()
    snapshots = await history.snapshots(scene, version)
    for snapshot in snapshots:
        differing.update(await history.advance(scene, rebuilt, snapshot.version))
        if await asyncio.to_thread(rebuilt.objects.state_hash) != snapshot.state_hash:
            differing.add(snapshot.version)
    differing.update(await history.advance(scene, rebuilt, version))
    if snapshots and not await _opens(history, snapshots[-1]):
        differing.add(snapshots[-1].version)
    return Verification(
        version=version,
        state_hash=state_hash,
        rebuilt_hash=await asyncio.to_thread(rebuilt.objects.state_hash),
        snapshots=len(snapshots),
        differing_versions=tuple(sorted(differing)),
        steps=version,
    )


async def _opens(history: History, snapshot: Snapshot) -> bool:
    try:
        opened = await history.opened(snapshot)
    except (Corrupt, InvalidInput, NotFound) as error:
        log.error("snapshot_unreadable", version=snapshot.version, reason=str(error))
        return False
    return await asyncio.to_thread(opened.objects.state_hash) == snapshot.state_hash
