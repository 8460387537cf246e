"""Hallways, entryways and balconies."""

from __future__ import annotations

from lab.simulation.furnishing.kitchen import corner_first
from lab.simulation.furnishing.placing import Carrier, Placed
from lab.simulation.furnishing.sides import doorways
from lab.simulation.furnishing.site import Site
from lab.simulation.furnishing.wares import Ware
from lab.simulation.home import RelationKind
from lab.simulation.plans.walls import OpeningKind

_NARROW = 0.4  # how far into a hall its furniture reaches, metres


def furnish_hall(site: Site) -> None:
    """Shallow things only: a shoe rack, coats above it, a sideboard, a mirror; a mat before the entrance."""
    _doormat(site)
    rack = site.stand(site.pick("shoe rack", most=(1.1, _NARROW, 1.2), colored=0.4), 0.4, prefer=corner_first)
    for _ in range(3):
        site.put(site.pick("shoe", most=(0.35, 0.36, 0.25)), rack)
    if site.chance(0.7):
        site.hang(site.pick("coat rack", most=(0.9, 0.3, 0.5), colored=0.5), 1.65)
    board = site.stand(site.pick("sideboard", most=(1.4, _NARROW, 1.0), colored=0.4), 0.4)
    if site.chance(0.3):
        site.hang(site.pick("security camera", most=(0.25, 0.4, 0.25)), site.ceiling - 0.3)
    for label in ("vase", "sculpture", "bowl", "box", "picture frame", "hat", "candle", "telephone", "bag"):
        if site.chance(0.5):
            site.put(site.pick(label, most=(0.38, 0.35, 0.45)), board)
    if site.chance(0.7):
        site.hang(site.pick("mirror", most=(0.8, 0.12, 1.4)), 1.0, clear=0.3)
    if site.chance(0.4):
        site.hang(site.pick("radiator", most=(1.1, 0.2, 0.8)), 0.1)
    for label, most, share in (
        ("umbrella", (0.3, 0.3, 1.0), 0.5),
        ("plant", (0.45, 0.45, 1.3), 0.5),
        ("shoe", (0.35, 0.36, 0.25), 0.6),
        ("slipper", (0.35, 0.36, 0.25), 0.5),
        ("backpack", (0.4, 0.4, 0.55), 0.4),
        ("bench", (1.2, _NARROW, 0.6), 0.3),
        ("suitcase", (0.5, _NARROW, 0.8), 0.15),
    ):
        if site.chance(share):
            site.stand(site.pick(label, most=most), 0.0, prefer=corner_first)


def furnish_balcony(site: Site) -> None:
    """A small table with chairs, plants along the parapet, a bicycle."""
    table = site.stand(site.pick("table", most=(0.75, 0.75, 0.8)) or site.pick("stool"), 0.0)
    site.put(site.pick("plant", most=(0.3, 0.3, 0.4)), table, near=(0, 0))
    site.put(site.pick("mug"), table)
    for _ in range(2):
        site.stand(site.pick("chair", most=(0.62, 0.65, 1.1)), 0.0)
    for _ in range(3):
        site.stand(site.pick("plant", most=(0.6, 0.6, 1.4)), 0.0, prefer=corner_first)
    if site.chance(0.4):
        site.stand(site.pick("bench", most=(1.5, 0.5, 0.9)), 0.3)
    if site.chance(0.3):
        site.stand(site.pick("bicycle", most=(0.7, 1.9, 1.2)), 0.0)


def _doormat(site: Site) -> None:
    ware: Ware | None = site.pick("doormat", most=(0.85, 0.6, 0.3), exact=(None, None, 0.008))
    for side in site.sides:
        for opening in doorways(side):
            if ware and opening.kind is OpeningKind.ENTRANCE:
                x, y = side.point((opening.low + opening.high) / 2, 0.1 + ware.depth / 2)
                mat = Placed(ware, x, y, 0.0, side.yaw, RelationKind.ON, Carrier.FLOOR)
                if site.stead.fits(mat.footprint, Carrier.FLOOR):
                    site.stead.add(mat)
