"""The floor grid: which cells of a storey are free, occupied or unknown (SPEC 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64, U8, U16

UNKNOWN, FREE, OCCUPIED = 0, 1, 2


@dataclass(frozen=True, slots=True)
class FloorGrid:
    """One storey as cells.

    occupancy: `(R, C)` uint8 of UNKNOWN, FREE, OCCUPIED (walls and furniture, at any height a robot meets).
    regions: `(R, C)` uint16, 0 = none, else 1 + index into `region_ids`. origin: world x, y of the outer
    corner of cell (0, 0); rows grow with y, columns with x. resolution: metres.
    """

    floor: int
    origin: tuple[float, float]
    resolution: float
    occupancy: U8
    regions: U16
    region_ids: tuple[str, ...] = ()
    revision: int = 0

    def cell_of(self, xy: F64) -> tuple[int, int]:
        """Row and column that hold world point `xy` (may lie outside the grid)."""
        return (
            int(np.floor((xy[1] - self.origin[1]) / self.resolution)),
            int(np.floor((xy[0] - self.origin[0]) / self.resolution)),
        )

    def xy_of(self, row: float, column: float) -> F64:
        """World x, y of the centre of a cell."""
        return np.array(
            [
                self.origin[0] + (column + 0.5) * self.resolution,
                self.origin[1] + (row + 0.5) * self.resolution,
            ]
        )
