"""A storey's surface as seen from above: in how many voxels of a height band each column of the grid was hit."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import I64
from services.regions.domain.bricks import Window, unblocked
from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.floors import Storey
from services.regions.domain.free_space import FreeSpace


def filled_voxels(evidence: FloorEvidence, space: FreeSpace, low: float, high: float) -> I64:
    """Voxels of 0.05 m with a hit whose middle lies in the world heights `low` to `high`, a column -> `(R, C)`.

    One voxel counts once however often it was hit, as a point of a downsampled cloud does.
    """
    layers = evidence.hits.used_layers()
    middle = (layers + 0.5) * CELL
    layers = layers[(middle >= low) & (middle < high)]
    if not len(layers) or not space.free.size:
        return np.zeros(space.free.shape, np.int64)
    x, y = (round(at / CELL) for at in space.origin)
    window = Window((x, y), (x + space.free.shape[1], y + space.free.shape[0]))
    whole = window.of_bricks()
    filled = evidence.hits.filled([(int(layers[0]), int(layers[-1]) + 1)], whole)[0]
    return unblocked(filled, whole)[window.inside(whole)].astype(np.int64)


def ceiling_of(evidence: FloorEvidence, storey: Storey) -> float:
    """The storey's ceiling in world metres; the height of its highest surface where no ceiling was seen."""
    if storey.ceiling_z is not None:
        return storey.ceiling_z
    z = (evidence.hits.used_layers() + 1) * CELL
    z = z[(z > storey.z) & (z <= storey.high)]
    return float(z.max()) if len(z) else storey.z
