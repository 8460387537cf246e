"""What stands in shelves and on boards."""

from __future__ import annotations

from collections.abc import Sequence

from lab.simulation.furnishing.placing import Placed
from lab.simulation.furnishing.site import Site
from lab.simulation.furnishing.wares import Posture

_BOOK = (0.08, 0.3, 0.32)  # the largest book, standing


def fill_shelf(site: Site, shelf: Placed | None, labels: Sequence[str]) -> None:
    """Puts some of these things on the boards of a shelf, books on their edges, and on its top where they fit."""
    if shelf is None:
        return
    for label in labels:
        if not site.chance(0.75):
            continue
        if label == "book":
            book = site.pick("book", most=_BOOK, posture=Posture.UPRIGHT)
            site.put(book, shelf, yaw=0.0, where="boards")
            continue
        ware = site.pick(label, most=(0.45, shelf.ware.depth + 0.05, 0.45))
        site.put(ware, shelf, where="boards") or site.put(ware, shelf)
