"""Damage to blobs in a directory: a file that changed, a file that is gone."""

from __future__ import annotations

from pathlib import Path

from ovip.store import Store
from ovip.store.blobs import DirectoryBlobs


async def corrupt(store: Store, ref: str) -> None:
    """Another byte in the middle."""
    path = _path(store, ref)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)


async def forget(store: Store, ref: str) -> None:
    """No file any more."""
    _path(store, ref).unlink()


def _path(store: Store, ref: str) -> Path:
    assert isinstance(store.blobs, DirectoryBlobs)
    return store.blobs._path(ref)
