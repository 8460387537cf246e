"""What went wrong with each true area of a home: split, merged, too little seen, leaked, or named for another use.

An area is compared with the region that holds most of it. Where they differ, each square metre that is in one and not
in the other has one of four reasons, so the four add up to what is missing from a perfect overlap.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from lab.evaluation.experiment import Row
from lab.evaluation.regions.floors import rooms_of
from lab.evaluation.regions.methods import StoreyRegions
from lab.evaluation.regions.rows import Ground, named_rooms, seen_of
from lab.evaluation.scores.region_matching import NEAR, STRICT_IOU, shared_cells
from lab.simulation.home import Area
from ovip.scene.types import F64
from services.regions.domain.function_names import function_name

_CELL = NEAR**2  # square metres
_PIECE = 0.25
"""Square metres of an area that a region must hold to count as a piece of it."""


class Verdict(StrEnum):
    """What became of an area; of several reasons, the one that costs most square metres."""

    FOUND = "found"
    MISNAMED = "found, function wrong"
    SPLIT = "split"
    MERGED = "merged"
    UNSEEN = "too little seen"
    LEAKED = "leaked"


@dataclass(frozen=True, slots=True)
class Piece:
    """A share of an area that lies in one region, or of a region that lies in another area; square metres."""

    name: str
    m2: float


@dataclass(frozen=True, slots=True)
class AreaDiagnosis:
    """One true area. m2: its own; seen: share of it that is free space of the survey.

    function_found: of the region that holds most of it, None where none holds any. iou: of the two. pieces: the
    regions it is cut into, by their functions, the largest first. merged_with: the other areas in its region.
    split_m2: of it, in other regions; unseen_m2: in no region; merged_m2: of its region, in other areas; leaked_m2: in
    no area.
    """

    area_id: int
    name: str
    floor: int
    function: str
    m2: float
    seen: float
    function_found: str | None
    iou: float
    pieces: tuple[Piece, ...]
    merged_with: tuple[Piece, ...]
    split_m2: float
    unseen_m2: float
    merged_m2: float
    leaked_m2: float

    @property
    def verdict(self) -> Verdict:
        """Found where the overlap counts as a match; ties go to the reason listed first."""
        if self.iou > STRICT_IOU:
            named = self.function_found in ("", function_name(self.function))
            return Verdict.FOUND if named else Verdict.MISNAMED
        reasons = {
            Verdict.UNSEEN: self.unseen_m2,
            Verdict.MERGED: self.merged_m2,
            Verdict.SPLIT: self.split_m2,
            Verdict.LEAKED: self.leaked_m2,
        }
        return max(reasons, key=lambda reason: reasons[reason])

    @property
    def columns(self) -> Row:
        """As a result's JSON holds it, metres and shares rounded."""
        return {
            "area": self.name,
            "floor": self.floor,
            "function": self.function,
            "m2": round(self.m2, 2),
            "seen": round(self.seen, 3),
            "verdict": self.verdict.value,
            "function_found": self.function_found,
            "iou": round(self.iou, 3),
            "pieces": [{"function": piece.name, "m2": round(piece.m2, 2)} for piece in self.pieces],
            "merged_with": [{"area": piece.name, "m2": round(piece.m2, 2)} for piece in self.merged_with],
            "split_m2": round(self.split_m2, 2),
            "unseen_m2": round(self.unseen_m2, 2),
            "merged_m2": round(self.merged_m2, 2),
            "leaked_m2": round(self.leaked_m2, 2),
        }

    def __str__(self) -> str:
        return f"{self.name}: {self.verdict.value}{_why(self)}"


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Every true area, and the regions that hold most of none, by function."""

    areas: tuple[AreaDiagnosis, ...]
    extra: tuple[Piece, ...]

    @property
    def columns(self) -> Row:
        """As a result's JSON holds it."""
        return {
            "areas": [area.columns for area in self.areas],
            "extra_regions": [{"function": piece.name, "m2": round(piece.m2, 2)} for piece in self.extra],
            "why": [str(area) for area in self.areas if area.verdict is not Verdict.FOUND],
        }


def diagnose(ground: Ground, cut: tuple[StoreyRegions, ...]) -> Diagnosis:
    """What became of each true area of a home that was cut like this; an area without a cell is left out."""
    areas = [area for area in ground.place.truth.areas if rooms_of([area])]
    rooms, named = rooms_of(areas), named_rooms(ground, cut)
    functions, regions = [function for function, _ in named], [region for _, region in named]
    shared: F64 = shared_cells(regions, rooms).astype(np.float64) * _CELL
    sizes: F64 = _CELL * np.array([len(region.points) for region in regions], np.float64)
    seen = seen_of(ground, rooms)
    main = shared.argmax(axis=0) if len(regions) else np.zeros(len(areas), np.int64)
    held = shared.sum(axis=0) > 0
    found = tuple(
        _area(k, areas, len(rooms[k].points) * _CELL, seen[k], int(main[k]), shared, sizes, functions)
        if held[k]
        else _lost(areas[k], len(rooms[k].points) * _CELL, seen[k])
        for k in range(len(areas))
    )
    spare = sorted(set(range(len(regions))) - set(main[held].tolist()))
    return Diagnosis(found, tuple(Piece(functions[r], float(sizes[r])) for r in spare))


def _area(
    k: int,
    areas: list[Area],
    m2: float,
    seen: float,
    main: int,
    shared: F64,
    sizes: F64,
    functions: list[str],
) -> AreaDiagnosis:
    """Area `k` beside region `main`; shared: `(P, G)` square metres of each region in each area."""
    both, size = float(shared[main, k]), float(sizes[main])
    others = {g: float(shared[main, g]) for g in range(len(areas)) if g != k}
    merged = sum(others.values())
    return AreaDiagnosis(
        area_id=areas[k].area_id,
        name=areas[k].name,
        floor=areas[k].floor,
        function=areas[k].function,
        m2=m2,
        seen=seen,
        function_found=functions[main],
        iou=both / (m2 + size - both),
        pieces=_largest((functions[r], float(m2_in)) for r, m2_in in enumerate(shared[:, k])),
        merged_with=_largest((areas[g].name, m2_in) for g, m2_in in others.items()),
        split_m2=float(shared[:, k].sum()) - both,
        unseen_m2=max(m2 - float(shared[:, k].sum()), 0.0),
        merged_m2=merged,
        leaked_m2=max(size - both - merged, 0.0),
    )


def _lost(area: Area, m2: float, seen: float) -> AreaDiagnosis:
    """An area that no region has anything of."""
    return AreaDiagnosis(
        area_id=area.area_id,
        name=area.name,
        floor=area.floor,
        function=area.function,
        m2=m2,
        seen=seen,
        function_found=None,
        iou=0.0,
        pieces=(),
        merged_with=(),
        split_m2=0.0,
        unseen_m2=m2,
        merged_m2=0.0,
        leaked_m2=0.0,
    )


def _largest(parts: Iterable[tuple[str, float]]) -> tuple[Piece, ...]:
    """Those that count, the largest first."""
    kept = [Piece(name, m2) for name, m2 in parts if m2 >= _PIECE]
    return tuple(sorted(kept, key=lambda piece: -piece.m2))


def _why(area: AreaDiagnosis) -> str:
    if area.verdict is Verdict.MISNAMED:
        return f" ({area.function_found})"
    if area.verdict is Verdict.SPLIT:
        return f" into {len(area.pieces)} ({_listed(area.pieces)})"
    if area.verdict is Verdict.MERGED:
        return f" with {_listed(area.merged_with)}"
    if area.verdict is Verdict.UNSEEN:
        return f" ({area.seen:.0%} of {area.m2:.1f} m2, {area.unseen_m2:.1f} m2 in no region)"
    return f" ({area.leaked_m2:.1f} m2 in no area)" if area.verdict is Verdict.LEAKED else ""


def _listed(pieces: tuple[Piece, ...]) -> str:
    return ", ".join(f"{piece.name or 'a region'} {piece.m2:.1f} m2" for piece in pieces)
