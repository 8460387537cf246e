"""The surface of a whole scene: what all its frames saw, thinned."""

from __future__ import annotations

import asyncio

import numpy as np

from ovip.codec import decode_detection_batch
from ovip.scene.types import F32
from ovip.scene.voxels import downsample
from ovip.store import Store
from ovip.store.blobs import BlobStore

DETECTIONS = "detections"
VOXEL = 0.05
_MOST_FRAMES = 600
_MOST_POINTS = 400_000
_FRAMES_AT_ONCE = 50


async def surface_of(store: Store, scene: str) -> F32:
    """Points `(N, 3)` of a scene's surface, one in 5 cm, world metres: of all frames, or of many over the whole log."""
    stride = -(-await store.length(scene, DETECTIONS) // _MOST_FRAMES)
    cloud, after, seen = np.zeros((0, 3), np.float32), "0-0", 0
    while entries := await store.read(scene, DETECTIONS, after, _FRAMES_AT_ONCE):
        after = entries[-1].id
        refs = [e.fields["batch"].decode() for n, e in enumerate(entries, seen) if n % stride == 0]
        seen += len(entries)
        parts = await asyncio.gather(*(_surface(store.blobs, ref) for ref in refs))
        cloud = await asyncio.to_thread(_thinned, [cloud, *parts])
    return _capped(cloud)


async def _surface(blobs: BlobStore, ref: str) -> F32:
    return decode_detection_batch(await blobs.get(ref)).surface


def _thinned(parts: list[F32]) -> F32:
    return downsample(np.concatenate(parts), VOXEL)[0]


def _capped(cloud: F32) -> F32:
    if len(cloud) <= _MOST_POINTS:
        return cloud
    return cloud[np.linspace(0, len(cloud) - 1, _MOST_POINTS).astype(np.int64)]
