"""Plans of a home's partitions beside the truth, as the regions experiment draws them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from lab.evaluation.experiment import Row
from lab.evaluation.regions.diagnosis import Diagnosis
from lab.evaluation.regions.floors import RegionTruth
from lab.evaluation.regions.methods import StoreyRegions, cells_of
from lab.evaluation.regions.rows import Ground
from lab.figures.plans import Backdrop, Plan, draw_partition
from lab.simulation.home import Area, inside_polygon
from ovip.scene.types import F64, I32, Bools
from services.regions.domain.survey import SurveyedStorey, storeys_of_objects

DRAWN = ("KGSW", "KGSW to the letter", "HOV-SG", "SysNav", "auto-K")
_DOOR_STEP = 0.5  # metres that a door's foot may be from the floor it stands on
Grid = TypeVar("Grid", I32, Bools)


@dataclass(frozen=True, slots=True, eq=False)
class StoreyPlans:
    """One storey's pictures, ready to draw."""

    title: str
    backdrop: Backdrop
    plans: tuple[Plan, ...]

    def draw(self, path: Path) -> Path:
        """Writes the PNG, and returns its path."""
        return draw_partition(path, self.title, self.backdrop, self.plans)


def storey_plans(
    ground: Ground,
    cuts: Mapping[str, tuple[StoreyRegions, ...]],
    rows: Mapping[str, Row],
    diagnosis: Diagnosis | None = None,
) -> tuple[StoreyPlans, ...]:
    """Truth and methods of each storey; rows: each method's figures for the home, printed below.

    diagnosis: what became of the true areas, written into them.
    """
    verdicts = {area.area_id: area.verdict.value for area in diagnosis.areas} if diagnosis else {}
    truth = ground.place.truth
    storeys = storeys_of_objects(ground.surveyed, ground.place.objects.centres)
    pages = []
    for number, (here, floor) in enumerate(zip(ground.surveyed, ground.floors, strict=True)):
        areas = tuple(area for area in truth.areas if area.floor == floor)
        canvas = _Canvas.of(here, areas)
        dots = ground.place.objects.centres[storeys == number][:, :2]
        methods = tuple(
            _method_plan(name, canvas, cuts[name][number], rows[name]) for name in DRAWN if name in cuts
        )
        storey = f", storey {floor}" if len(truth.storeys) > 1 else ""
        pages.append(
            StoreyPlans(
                f"{truth.name} ({truth.style}){storey}",
                Backdrop(
                    canvas.origin,
                    here.space.resolution,
                    canvas.put(here.space.wall),
                    dots,
                    _doors(truth, here),
                ),
                (_true_plan(canvas, areas, verdicts), *methods),
            )
        )
    return tuple(pages)


@dataclass(frozen=True, slots=True)
class _Canvas:
    """A survey's grid with as many cells around it, (before, after) for rows and columns, as the truth needs."""

    origin: tuple[float, float]
    resolution: float
    shape: tuple[int, int]
    around: tuple[tuple[int, int], tuple[int, int]]

    @classmethod
    def of(cls, here: SurveyedStorey, areas: Sequence[Area]) -> _Canvas:
        corners = cells_of(here, np.concatenate([np.zeros((0, 2)), *(area.polygon for area in areas)]))
        size = np.array(here.space.free.shape)
        low = np.maximum(-np.floor(corners.min(axis=0, initial=0)), 0).astype(int)
        high = np.maximum(np.ceil(corners.max(axis=0, initial=0)) - size + 1, 0).astype(int)
        x, y = here.space.origin
        step = here.space.resolution
        rows, columns = (size + low + high).tolist()
        return cls(
            (x - low[1] * step, y - low[0] * step),
            step,
            (rows, columns),
            ((int(low[0]), int(high[0])), (int(low[1]), int(high[1]))),
        )

    def put(self, grid: Grid) -> Grid:
        """A grid of the survey's cells on the canvas."""
        return np.pad(grid, self.around)


def _method_plan(name: str, canvas: _Canvas, regions: StoreyRegions, row: Row) -> Plan:
    note = (
        f"{row['regions']} regions, HydP {row['HydP']:.2f}, acc {row['acc']:.2f} "
        f"(strict {row['strict']['acc']:.2f}), AP {row['AP']:.2f}"
    )
    return Plan(name, canvas.put(regions.labels), regions.functions, note)


def _true_plan(canvas: _Canvas, areas: Sequence[Area], verdicts: Mapping[int, str]) -> Plan:
    labels: I32 = np.zeros(canvas.shape, np.int32)
    rows, columns = np.indices(canvas.shape)
    centres = (np.stack([columns, rows], axis=-1).reshape(-1, 2) + 0.5) * canvas.resolution
    for number, area in enumerate(areas, start=1):
        labels.ravel()[inside_polygon(area.polygon, centres + np.asarray(canvas.origin))] = number
    names = tuple(area.function for area in areas)
    under = tuple(verdicts.get(area.area_id, "") for area in areas)
    return Plan("truth", labels, names, f"{len(areas)} areas", under)


def _doors(truth: RegionTruth, here: SurveyedStorey) -> F64:
    """The boxes of the doors that stand on the storey."""
    above = truth.doors[:, 2] - here.storey.z
    return truth.doors[(above > -_DOOR_STEP) & (above < _DOOR_STEP)]
