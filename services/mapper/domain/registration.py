"""Where one surface may lie on another, by shape alone: every turn about the vertical, every shift."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft, ndimage

from ovip.scene.types import F32, F64, I64, Bools

_PEAKS = 4  # of a turn
_LEAST_SHARED = 12.0  # cells of floor plan that two surfaces must share to be compared


@dataclass(frozen=True, slots=True)
class SearchParams:
    """cell: metres of the coarse grid; most_cells: along its longer side, a larger place gets coarser cells.

    turn: radians between the turns tried. proposals: placements returned. apart, apart_turn: metres and radians by
    which at least one must differ for two placements to be two. fine: metres of the grid that judges a placement.
    """

    cell: float = 0.2
    most_cells: int = 150
    turn: float = np.pi / 60
    proposals: int = 12
    apart: float = 0.4
    apart_turn: float = np.pi / 12
    fine: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """world_from_other `(4, 4)`, upright. score: cells in common beyond what chance gives."""

    world_from_other: F64
    score: float


def propose(cloud: F32, other: F32, params: SearchParams) -> list[Proposal]:
    """The placements of `other` `(M, 3)` on `cloud` `(N, 3)` with most in common, best first, each a different one.

    Both are cut into layers of height; a layer's cells agree where both hold points. What counts is agreement beyond
    chance: a floor lies on any floor, and says nothing. Columns where either has no point at all do not count.
    """
    cell = _cell(cloud, other, params)
    base = np.floor(cloud.min(axis=0) / cell) * cell
    still = _layers(cloud, base, cell)
    centre = np.array([*other[:, :2].mean(axis=0), other[:, 2].min()], np.float64)
    found: list[tuple[float, F64]] = []
    for yaw in np.arange(0, 2 * np.pi, params.turn):
        turned = (other - centre) @ turn(yaw)[:3, :3].T
        low = np.floor(turned.min(axis=0) / cell) * cell
        for score, shift in _best_shifts(still, _layers(turned.astype(np.float32), low, cell)):
            moved = turn(yaw)
            moved[:3, 3] = base - low + shift * cell - moved[:3, :3] @ centre
            found.append((score, moved))
    found.sort(key=lambda one: -one[0])
    return _different([Proposal(pose, score) for score, pose in found], centre, params)


def agreement(cloud: F32, other: F32, cell: float) -> float:
    """How far two surfaces in one world agree where both saw something: 1 wholly, 0 as chance would have it.

    Cohen's kappa of cells of edge `cell`: the share of one's cells at or beside a cell of the other, corrected by what
    each layer's share of filled cells gives by chance; the mean of both directions, 0 where they share no floor plan.
    """
    base = np.floor(np.minimum(cloud.min(axis=0), other.min(axis=0)) / cell) * cell
    high = np.maximum(cloud.max(axis=0), other.max(axis=0))
    shape = tuple(int(n) for n in np.floor((high - base) / cell).astype(np.int64) + 1)
    a, b = _filled(cloud, base, cell, shape), _filled(other, base, cell, shape)
    both = a.any(axis=2) & b.any(axis=2)
    if both.sum() < _LEAST_SHARED:
        return 0.0
    return (_kappa(a[both], _grown(b)[both]) + _kappa(b[both], _grown(a)[both])) / 2


def turn(yaw: float) -> F64:
    """`(4, 4)` turn about the vertical, radians."""
    made = np.eye(4)
    made[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    return made


def differ(a: F64, b: F64, centre: F64, params: SearchParams) -> bool:
    """Whether two poses `(4, 4)` put the things around `centre` `(3,)` to clearly different places."""
    apart = np.linalg.norm((a - b)[:3, :3] @ centre + (a - b)[:3, 3])
    cosine = (np.trace(a[:3, :3].T @ b[:3, :3]) - 1) / 2
    return bool(apart > params.apart or np.arccos(np.clip(cosine, -1, 1)) > params.apart_turn)


def _cell(cloud: F32, other: F32, params: SearchParams) -> float:
    longest = max(float(np.ptp(points[:, :2], axis=0).max()) for points in (cloud, other))
    return max(params.cell, longest / params.most_cells)


def _layers(points: F32, base: F64, cell: float) -> F32:
    """Filled cells by layer `(L, X, Y)`, 1 where a point lies."""
    shape = tuple(int(n) for n in np.floor((points.max(axis=0) - base) / cell).astype(np.int64) + 1)
    return np.asarray(_filled(points, base, cell, shape).transpose(2, 0, 1), np.float32)


def _filled(points: F32, base: F64, cell: float, shape: tuple[int, ...]) -> Bools:
    """`(X, Y, L)`, true where a point lies."""
    made = np.zeros(shape, np.bool_)
    at = np.clip(np.floor((points - base) / cell).astype(np.int64), 0, np.array(shape) - 1)
    made[at[:, 0], at[:, 1], at[:, 2]] = True
    return made


def _best_shifts(still: F32, moving: F32) -> list[tuple[float, I64]]:
    """Scores and shifts `(3,)` in cells of the best placements of filled layers `(L, X, Y)` on others.

    By FFT, at every shift: C, the sum over layers of A * B, is in common, E, that of (A * M_B) (M_A * B) / (M_A * M_B),
    by chance, and T, that of A * M_B, is the most. M: columns where anything was seen; B is grown by a cell, as a
    turned grid never meets another. The score, what is beyond chance times how wholly: (C - E) (C - E) / (T - E).
    """
    columns = moving.max(axis=0)
    grown = ndimage.maximum_filter(moving, (1, 3, 3)) * columns
    shape = still.shape[1:]
    size = [fft.next_fast_len(n + m - 1, real=True) for n, m in zip(shape, columns.shape, strict=True)]
    a, b = fft.rfft2(still, size), np.conj(fft.rfft2(grown, size))
    mask_a, mask_b = fft.rfft2(still.max(axis=0), size), np.conj(fft.rfft2(columns, size))
    shared = fft.irfft2(mask_a * mask_b, size)
    seen_a, seen_b = fft.irfft2(a * mask_b, size), fft.irfft2(mask_a * b, size)
    best, best_up = np.zeros(size, np.float32), np.zeros(size, np.int64)
    for up in range(1 - len(moving), len(still)):
        i, j = slice(max(0, up), len(moving) + up), slice(max(0, -up), len(still) - up)
        if min(len(still), len(moving)) > 2 * len(a[i]):
            continue
        chance = (seen_a[i] * seen_b[j]).sum(axis=0) / np.maximum(shared, 1)
        beyond = np.maximum(fft.irfft2((a[i] * b[j]).sum(axis=0), size) - chance, 0)
        score = beyond * beyond / np.maximum(seen_a[i].sum(axis=0) - chance, 1)
        better = (score > best) & (shared > _LEAST_SHARED)
        best, best_up = np.where(better, score, best), np.where(better, up, best_up)
    return [
        (float(best[x, y]), np.array([*_unwrapped((x, y), size, shape), best_up[x, y]]))
        for x, y in _peaks(best)
    ]


def _peaks(score: F32) -> I64:
    """Where the highest local maxima lie `(P, 2)`."""
    tops = np.argwhere((score == ndimage.maximum_filter(score, 3, mode="wrap")) & (score > 0))
    return np.asarray(tops[np.argsort(-score[tops[:, 0], tops[:, 1]], kind="stable")[:_PEAKS]], np.int64)


def _unwrapped(at: tuple[int, int], size: list[int], shape: tuple[int, ...]) -> list[int]:
    """A cyclic shift as the one it means."""
    return [n - s if n >= most else n for n, s, most in zip(at, size, shape, strict=True)]


def _different(found: list[Proposal], centre: F64, params: SearchParams) -> list[Proposal]:
    kept: list[Proposal] = []
    for one in found:
        if all(differ(one.world_from_other, k.world_from_other, centre, params) for k in kept):
            kept.append(one)
        if len(kept) == params.proposals:
            break
    return kept


def _grown(filled: Bools) -> Bools:
    return np.asarray(ndimage.binary_dilation(filled, np.ones((3, 3, 3))), np.bool_)


def _kappa(cells: Bools, near: Bools) -> float:
    """Share of `cells` `(C, L)` that lie in `near` `(C, L)`, 0 at what each layer's share of `near` gives by chance."""
    total = float(cells.sum())
    chance = float((cells.sum(axis=0) * near.mean(axis=0)).sum())
    return (float((cells & near).sum()) - chance) / max(total - chance, 1e-9)
