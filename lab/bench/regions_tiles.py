"""Floor evidence laid down again at other places, as if the same walk had been made there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import I64
from services.regions.domain.evidence import CELL, VIEW, FloorEvidence

_VOXELS = ("hits", "passes", "stood")
_HEIGHTS = ("heights_below", "heights_above")


@dataclass(frozen=True, slots=True, eq=False)
class Tile:
    """One place's evidence: its frames, and the keys and counts `(K,)` of each of its streams."""

    cameras: dict[str, tuple[float, float, float]]
    views: dict[str, I64]
    streams: dict[str, tuple[I64, I64]]

    @classmethod
    def of(cls, evidence: FloorEvidence) -> Tile:
        streams = {name: getattr(evidence, name).items() for name in (*_VOXELS, *_HEIGHTS)}
        return cls(evidence.cameras, evidence.views, streams)

    def lay(self, whole: FloorEvidence, by: tuple[float, float], prefix: str) -> None:
        """Adds this to `whole`, moved `by` x, y metres (whole cubes of VIEW), its frames' ids with a prefix."""
        for frame_id, (x, y, z) in self.cameras.items():
            whole.cameras[f"{prefix}{frame_id}"] = (x + by[0], y + by[1], z)
            whole.views[f"{prefix}{frame_id}"] = self.views[frame_id] + _step(by, VIEW)
        for name, (keys, counts) in self.streams.items():
            getattr(whole, name).add(keys + _step(by, CELL) if name in _VOXELS else keys, counts)


def _step(by: tuple[float, float], size: float) -> np.int64:
    """What the key of a cube grows by when it is moved."""
    return np.int64((round(by[0] / size) << 42) + (round(by[1] / size) << 21))
