"""Chairs around tables and at desks."""

from __future__ import annotations

import numpy as np

from lab.simulation.furnishing.placing import Placed
from lab.simulation.furnishing.site import Site

_ELBOW = 0.58  # metres of table edge that a sitter needs
_GAPS = (0.06, 0.12, 0.2)  # between a chair and the table, tried in turn, metres


def chairs_around(site: Site, table: Placed | None, label: str, most: int) -> list[Placed]:
    """Up to `most` chairs of one kind along the edges of a table, all looking at it."""
    if table is None:
        return []
    chair = site.pick(label, most=(0.62, 0.68, 1.25), least=(0.25, 0.25, 0.4), colored=0.5)
    if chair is None:
        return []
    half = np.array([table.ware.width, table.ware.depth]) / 2
    seats: list[tuple[float, float, float]] = []  # way to look out, along the edge, off the middle
    for way, edge, off in ((0.0, 0, 1), (np.pi, 0, 1), (np.pi / 2, 1, 0), (-np.pi / 2, 1, 0)):
        count = int(2 * half[edge] / _ELBOW)
        places = (np.arange(count) + 0.5) / count * 2 * half[edge] - half[edge] if count else np.zeros(0)
        seats += [(way, float(place), float(half[off])) for place in places]
    found: list[Placed] = []
    for turn, place, reach in seats:
        if len(found) >= most:
            break
        for gap in _GAPS:
            # at turn 0 it stands before the table's front and looks back at it
            own = np.array([place, -(reach + gap + chair.depth / 2)])
            c, s = np.cos(turn), np.sin(turn)
            x, y = table.world(own @ np.array([[c, s], [-s, c]]))
            wobble = float(site.rng.uniform(-0.1, 0.1))
            thing = Placed(
                chair, float(x), float(y), 0.0, table.yaw + turn + np.pi + wobble, table.kind, table.by
            )
            if placed := site.settle(thing, within=site.room.polygon):
                found.append(placed)
                break
    return found
