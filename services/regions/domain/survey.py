"""Survey: the storeys that the evidence shows, each with its free space (SPEC 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64, I64
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.floors import FloorParams, Storey, find_storeys, storey_of
from services.regions.domain.free_space import FreeSpace, FreeSpaceParams, find_free_space


@dataclass(frozen=True, slots=True)
class SurveyedStorey:
    """A storey and its free space."""

    storey: Storey
    space: FreeSpace


def survey(
    evidence: FloorEvidence, floors: FloorParams | None = None, space: FreeSpaceParams | None = None
) -> tuple[SurveyedStorey, ...]:
    """The storeys that the evidence shows, from the lowest up, each with its free space."""
    storeys = find_storeys(evidence, floors)
    return tuple(SurveyedStorey(storey, find_free_space(evidence, storey, space)) for storey in storeys)


def storeys_of_objects(surveyed: tuple[SurveyedStorey, ...], centres: F64) -> I64:
    """Index of the storey of each of `(N, 3)` points -> `(N,)`; zeros where nothing was surveyed."""
    if not surveyed:
        return np.zeros(len(centres), np.int64)
    return storey_of(tuple(s.storey for s in surveyed), centres[:, 2])
