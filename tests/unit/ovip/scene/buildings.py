"""Builders: storeys drawn in text, and partitions of buildings with doorways and stairs between their regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.types import EdgeKind, Floor, Frontier, Partition, Region, RegionEdge

NAMES = {"h": "hall", "k": "kitchen", "b": "bedroom", "s": "study"}


def storey(*rows: str, floor: int = 0, resolution: float = 0.5) -> FloorGrid:
    """A grid drawn in text, the first row the lowest y: `#` occupied, `?` unknown, `.` free floor of no region; a
    letter is free floor of the region `r` + letter, a capital one furniture in it.
    """
    letters = sorted({c.lower() for row in rows for c in row if c.isalpha()})
    kind = {"#": OCCUPIED, "?": UNKNOWN, ".": FREE}
    occupancy = np.array(
        [[kind.get(c, OCCUPIED if c.isupper() else FREE) for c in row] for row in rows], np.uint8
    )
    labels = np.array(
        [[1 + letters.index(c.lower()) if c.isalpha() else 0 for c in row] for row in rows], np.uint16
    )
    return FloorGrid(floor, (0.0, 0.0), resolution, occupancy, labels, tuple(f"r{c}" for c in letters), 1)


def door(a: str, b: str, x: float, y: float, width: float = 0.5, z: float = 0.0) -> RegionEdge:
    """A doorway between regions `ra` and `rb`."""
    return RegionEdge(f"r{a}", f"r{b}", width, np.array([x, y, z]), EdgeKind.DOORWAY)


def stairs(
    a: str,
    b: str,
    foot: tuple[float, float, float],
    head: tuple[float, float, float],
    width: float = 1.0,
) -> RegionEdge:
    """Stairs from region `ra` up to region `rb`."""
    return RegionEdge(f"r{a}", f"r{b}", width, np.array(foot), EdgeKind.STAIRS, np.array(head))


def building(
    grids: Sequence[FloorGrid],
    edges: Sequence[RegionEdge] = (),
    frontiers: Sequence[Frontier] = (),
    storey_height: float = 3.0,
) -> tuple[Partition, Mapping[int, FloorGrid]]:
    """The partition of these storeys, one above the other, and the grids by number."""
    regions = [
        Region(
            region_id=region_id,
            floor=grid.floor,
            function=NAMES.get(region_id[1:], "unknown"),
            display_name=NAMES.get(region_id[1:], region_id),
            area=float((grid.regions == number).sum()) * grid.resolution**2,
            centroid=np.append(_centre(grid, number), storey_height * grid.floor),
            outlines=(),
            holes=(),
            object_ids=(),
            frame_ids=(),
        )
        for grid in grids
        for number, region_id in enumerate(grid.region_ids, start=1)
    ]
    floors = tuple(Floor(g.floor, storey_height * g.floor, None, 1.0) for g in grids)
    partition = Partition(7, 3, floors, tuple(regions), tuple(edges), (), tuple(frontiers))
    return partition, {grid.floor: grid for grid in grids}


def _centre(grid: FloorGrid, number: int) -> np.ndarray:
    row, column = np.argwhere(grid.regions == number).mean(axis=0)
    return grid.xy_of(row, column)
