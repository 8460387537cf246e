"""A storey's surface as seen from above: in how many voxels of a height band each column of the grid was hit."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import I64
from services.regions.domain.evidence import CELL, FloorEvidence, unpack_voxel
from services.regions.domain.floors import Storey
from services.regions.domain.free_space import FreeSpace


def filled_voxels(evidence: FloorEvidence, space: FreeSpace, low: float, high: float) -> I64:
    """Voxels of 0.05 m with a hit whose middle lies in the world heights `low` to `high`, a column -> `(R, C)`.

    One voxel counts once however often it was hit, as a point of a downsampled cloud does.
    """
    rows, columns = space.free.shape
    index = unpack_voxel(evidence.hits.items()[0])
    z = (index[:, 2] + 0.5) * CELL
    row = index[:, 1] - round(space.origin[1] / CELL)
    column = index[:, 0] - round(space.origin[0] / CELL)
    inside = (z >= low) & (z < high) & (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    counts = np.zeros((rows, columns), np.int64)
    np.add.at(counts, (row[inside], column[inside]), 1)
    return counts


def ceiling_of(evidence: FloorEvidence, storey: Storey) -> float:
    """The storey's ceiling in world metres; the height of its highest surface where no ceiling was seen."""
    if storey.ceiling_z is not None:
        return storey.ceiling_z
    z = (unpack_voxel(evidence.hits.items()[0])[:, 2] + 1) * CELL
    z = z[(z > storey.z) & (z <= storey.high)]
    return float(z.max()) if len(z) else storey.z
