"""What touches what in a picture: neighbouring pixels of two things whose surfaces do not jump apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, F64, I64, U16

JUMP = 0.03  # relative depth step between neighbours that parts surfaces
_FEWEST = 3  # pairs of neighbouring pixels that make a contact
_BELOW = 3  # a contact from above counts this often: things mostly stand


@dataclass(frozen=True, slots=True)
class Contacts:
    """carrier: of each thing the larger one that it most touches, standing on it before leaning on it."""

    carrier: dict[int, int]

    def carried_by(self, object_id: int) -> list[int]:
        """The things on this one, by id."""
        return sorted(thing for thing, carrier in self.carrier.items() if carrier == object_id)


def contacts(ids: U16, depth: F32, pixels: I64) -> Contacts:
    """Contacts in a picture of ids `(H, W)` and depth `(H, W)` metres; pixels: how many of each id.

    Ties go to the smaller id.
    """
    across = _pairs(ids[:, :-1], ids[:, 1:], depth[:, :-1], depth[:, 1:])
    down = _pairs(ids[:-1], ids[1:], depth[:-1], depth[1:])
    touching = np.concatenate([across, across[:, ::-1], down, down[:, ::-1]])
    weight = np.concatenate([np.ones(2 * len(across)), np.full(len(down), _BELOW), np.ones(len(down))])
    return Contacts(_carriers(touching, weight, pixels))


def _pairs(a: U16, b: U16, depth_a: F32, depth_b: F32) -> I64:
    """Ids `(N, 2)` of neighbours that touch."""
    differ = (a != b) & (a > 0) & (b > 0) & (depth_a > 0) & (depth_b > 0)
    rows, columns = np.nonzero(differ)
    za, zb = depth_a[rows, columns], depth_b[rows, columns]
    near = np.abs(za - zb) < JUMP * np.minimum(za, zb)
    return np.stack([a[rows, columns][near], b[rows, columns][near]], axis=1).astype(np.int64)


def _carriers(touching: I64, weight: F64, pixels: I64) -> dict[int, int]:
    kept = pixels[touching[:, 1]] > pixels[touching[:, 0]]
    pairs, inverse, counts = np.unique(touching[kept], axis=0, return_inverse=True, return_counts=True)
    strength = np.bincount(inverse, weights=weight[kept], minlength=len(pairs))
    carrier: dict[int, int] = {}
    best: dict[int, float] = {}
    for (thing, other), count, strong in zip(pairs.tolist(), counts.tolist(), strength.tolist(), strict=True):
        if count >= _FEWEST and strong > best.get(thing, 0.0):
            carrier[thing], best[thing] = other, strong
    return carrier
