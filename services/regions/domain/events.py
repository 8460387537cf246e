"""Region events: what became of each region from one partition to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ovip.scene.grid import FloorGrid
from ovip.scene.types import I64, Partition, Region, RegionEvent, RegionEventKind
from services.regions.domain.identity import shared_cells
from services.regions.domain.staleness import same_floors


@dataclass(frozen=True, slots=True)
class EventParams:
    """reshaped: a region is reshaped where the cells that came and went are more than this share of its old
    ones."""

    reshaped: float = 0.1


def events_between(
    before: Partition,
    before_grids: Sequence[FloorGrid],
    after: Partition,
    after_grids: Sequence[FloorGrid],
    params: EventParams | None = None,
) -> tuple[RegionEvent, ...]:
    """All that appeared, then was retyped, was reshaped, vanished; each kind in the order of its partition.

    Grids: one a floor, in the floors' order. `other` is the region that holds most of the floor in question; ""
    where more of it was, or is, in no region. The floor of a vanished region is the one it was on.
    """
    params = params or EventParams()
    was = {region.region_id: region for region in before.regions}
    now = {region.region_id: region for region in after.regions}
    fate = _fates(before, before_grids, after, after_grids)
    kept = [region for name, region in now.items() if name in was]
    return (
        *(_event(RegionEventKind.APPEARED, r, fate.source) for name, r in now.items() if name not in was),
        *(_event(RegionEventKind.RETYPED, r) for r in kept if r.function != was[r.region_id].function),
        *(
            _event(RegionEventKind.RESHAPED, r)
            for r in kept
            if fate.change.get(r.region_id, np.inf) > params.reshaped
        ),
        *(_event(RegionEventKind.VANISHED, r, fate.target) for name, r in was.items() if name not in now),
    )


@dataclass(slots=True)
class _Fates:
    """source: a region now -> where most of its floor was. target: a region before -> where most of it is.
    change: a region of both -> cells that came and went by cells before."""

    source: dict[str, str] = field(default_factory=dict)
    target: dict[str, str] = field(default_factory=dict)
    change: dict[str, float] = field(default_factory=dict)


def _fates(
    before: Partition, before_grids: Sequence[FloorGrid], after: Partition, after_grids: Sequence[FloorGrid]
) -> _Fates:
    fates = _Fates()
    same = same_floors([floor.z for floor in before.floors], [floor.z for floor in after.floors])
    for grid, number in zip(after_grids, same, strict=True):
        _add_floor(fates, grid, None if number is None else before_grids[number])
    return fates


def _add_floor(fates: _Fates, grid: FloorGrid, old: FloorGrid | None) -> None:
    ids, old_ids = grid.region_ids, old.region_ids if old is not None else ()
    table = shared_cells(grid.regions, len(ids), grid.origin, old)
    for row, name in zip(table[1:], ids, strict=True):
        fates.source[name] = _holder(row[1:], int(row[0]), old_ids)
    if old is None:
        return
    sizes = np.bincount(old.regions.ravel(), minlength=len(old_ids) + 1)
    for column, size, name in zip(table[1:, 1:].T, sizes[1:].tolist(), old_ids, strict=True):
        fates.target[name] = _holder(column, size - int(column.sum()), ids)
        if name in ids:
            shared, size_now = int(column[ids.index(name)]), int(table[1 + ids.index(name)].sum())
            fates.change[name] = (size + size_now - 2 * shared) / max(size, 1)


def _holder(cells: I64, cells_of_none: int, ids: Sequence[str]) -> str:
    """The region with most of `cells` `(K,)`, the first of equals; "" where none has as many."""
    if not len(cells) or not cells.any():
        return ""
    first = int(np.argmax(cells))
    return ids[first] if cells[first] >= cells_of_none else ""


def _event(kind: RegionEventKind, region: Region, others: dict[str, str] | None = None) -> RegionEvent:
    other = (others or {}).get(region.region_id, "")
    return RegionEvent(kind, region.region_id, region.floor, region.display_name, other)
