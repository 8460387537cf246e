"""Staleness: whether a floor has changed enough since it was last cut to be cut again."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.errors import Corrupt
from ovip.scene.types import F64, U8, Bools


@dataclass(frozen=True, slots=True)
class StalenessParams:
    """What is more than this makes a floor stale.

    area: free space come or gone, square metres; or, where that is more, share: of the free space that there
    was; but never more than most, a small room, square metres. moved: an object, metres in the plane. same_floor:
    floors this close in height are one, metres.
    """

    area: float = 0.5
    share: float = 0.01
    moved: float = 0.5
    most: float = 5.0
    same_floor: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Basis:
    """What a floor was cut from: F, and its objects in the order of their ids.

    packed: F `(R, C)` by `np.packbits`, `shape` its rows and columns, `origin` world x, y of its first corner,
    resolution in metres. centres: `(N, 2)` world metres. told: whether a VLM named each function, which weighs its
    vote; none where empty.
    """

    origin: tuple[float, float]
    resolution: float
    shape: tuple[int, int]
    packed: U8
    ids: tuple[str, ...]
    labels: tuple[str, ...]
    functions: tuple[str, ...]
    centres: F64
    told: tuple[bool, ...] = ()

    @property
    def free(self) -> Bools:
        """F `(R, C)`."""
        cells = self.shape[0] * self.shape[1]
        return np.unpackbits(self.packed, count=cells).astype(bool).reshape(self.shape)

    def to_bytes(self) -> bytes:
        """This basis exactly; equal ones give equal bytes."""
        head = {
            "origin": self.origin,
            "resolution": self.resolution,
            "shape": self.shape,
            "ids": self.ids,
            "labels": self.labels,
            "functions": self.functions,
            "centres": self.centres.tolist(),
            "told": self.told,
        }
        text = json.dumps(head).encode()
        return zlib.compress(struct.pack("<q", len(text)) + text + self.packed.tobytes(), 1)

    @classmethod
    def from_bytes(cls, data: bytes) -> Basis:
        """What `to_bytes` wrote. Raises Corrupt for anything else."""
        try:
            body = zlib.decompress(data)
            (length,) = struct.unpack_from("<q", body)
            head = json.loads(body[8 : 8 + length])
            x, y = head["origin"]
            rows, columns = head["shape"]
            packed = np.frombuffer(body, np.uint8, (rows * columns + 7) // 8, 8 + length)
            centres = np.array(head["centres"], np.float64).reshape(-1, 2)
            ids, labels, functions = (tuple(head[name]) for name in ("ids", "labels", "functions"))
            size = (rows, columns)
            told = tuple(bool(one) for one in head["told"])
            return cls((x, y), head["resolution"], size, packed, ids, labels, functions, centres, told)
        except (zlib.error, struct.error, ValueError, KeyError, TypeError) as error:
            raise Corrupt(f"basis of a floor: {error}") from error


def is_stale(before: Basis | None, now: Basis, params: StalenessParams | None = None) -> bool:
    """Whether a floor that was cut from `before` is to be cut again: an object appeared, went, moved or was given
    another name or function, or the same function by a VLM; or its free space changed. A floor that never was cut is
    stale."""
    params = params or StalenessParams()
    if before is None or (before.resolution, before.ids) != (now.resolution, now.ids):
        return True
    if (before.labels, before.functions, before.told) != (now.labels, now.functions, now.told):
        return True
    if (np.linalg.norm(now.centres - before.centres, axis=1) > params.moved).any():
        return True
    cells, changed = _cells_and_change(before, now)
    cell = now.resolution**2
    enough = min(max(params.area / cell, params.share * cells), params.most / cell)
    return changed > enough + 1e-6


def same_floors(
    before: Sequence[float], now: Sequence[float], params: StalenessParams | None = None
) -> tuple[int | None, ...]:
    """For each floor height now, in metres, the index of the one before that is the same floor; None: new."""
    params = params or StalenessParams()
    found: list[int | None] = []
    for z in now:
        nearest = min(range(len(before)), key=lambda i: abs(before[i] - z), default=None)
        is_same = nearest is not None and abs(before[nearest] - z) <= params.same_floor
        found.append(nearest if is_same else None)
    return tuple(found)


def _cells_and_change(before: Basis, now: Basis) -> tuple[int, int]:
    """Cells of F before, and cells that are free in one of the two only."""
    was, is_ = before.free, now.free
    offset = np.round((np.asarray(now.origin) - np.asarray(before.origin)) / now.resolution).astype(int)[::-1]
    low = np.maximum(0, -offset)
    high = np.maximum(low, np.minimum(is_.shape, np.asarray(was.shape) - offset))
    here = is_[low[0] : high[0], low[1] : high[1]]
    there = was[low[0] + offset[0] : high[0] + offset[0], low[1] + offset[1] : high[1] + offset[1]]
    return int(was.sum()), int(was.sum() + is_.sum() - 2 * (here & there).sum())
