"""What hangs in every area: switches beside doors, plugs, pictures, clocks, lamps, detectors, curtains."""

from __future__ import annotations

from collections.abc import Mapping

from lab.simulation.furnishing.sides import doorways
from lab.simulation.furnishing.site import Site, Spot
from lab.simulation.furnishing.wares import Posture
from lab.simulation.plans.walls import OpeningKind

SWITCH_HEIGHT, PLUG_HEIGHT, PICTURE_MIDDLE = 1.1, 0.3, 1.5  # metres
_LOW_CEILING_LAMP = 0.62  # how far down a lamp may reach, metres

_PICTURES: Mapping[str, int] = {
    "living room": 3, "bedroom": 2, "dining area": 2, "hallway": 3, "office": 1, "entryway": 2, "playroom": 2,
}  # fmt: skip
_CURTAINED = ("living room", "bedroom", "dining area", "office")


def hang_fittings(site: Site) -> None:
    """All of them; a balcony has none."""
    function = site.area.function
    if function == "balcony":
        return
    _curtains(site)
    _switches(site)
    for _ in range(_PICTURES.get(function, 0)):
        frame = site.pick("picture frame", most=(1.0, 0.1, 0.9), least=(0.15, 0, 0.15), colored=0.6)
        if frame:
            site.hang(frame, PICTURE_MIDDLE - frame.height / 2, clear=0.3)
    if function in ("kitchen", "living room", "office", "dining area") and site.chance(0.6):
        site.hang(site.pick("clock", most=(0.45, 0.12, 0.45), least=(0.15, 0, 0.15)), 1.8)
    if function in ("bedroom", "office", "living room", "bathroom") and site.chance(0.5):
        site.hang(site.pick("radiator", most=(1.2, 0.25, 0.8)), 0.1)
    if function in ("bedroom", "living room") and site.chance(0.3):
        site.hang(site.pick("air conditioner"), site.ceiling - 0.45)
    if function in ("living room", "hallway", "bathroom") and site.chance(0.3):
        site.hang(site.pick("wall lamp", most=(0.4, 0.4, 0.6)), 1.6)
    for _ in range(1 if function in ("hallway", "bathroom", "storage") else 2):
        site.hang(site.pick("wall plug", most=(0.2, 0.03, 0.2)), PLUG_HEIGHT, clear=0.08)
    if function in ("hallway", "entryway", "bedroom", "kitchen", "living room") and site.chance(0.7):
        site.overhead(site.pick("smoke detector", posture=Posture.FACING_DOWN, most=(0.2, 0.2, 0.1)))
    if site.chance(0.8):
        site.overhead(site.pick("ceiling lamp", most=(0.6, 0.6, _LOW_CEILING_LAMP), colored=0.5))
    if function in ("hallway", "entryway") and site.chance(0.5):
        site.hang(site.pick("intercom", most=(0.25, 0.15, 0.4)), 1.35, clear=0.2)
    if function == "kitchen" and site.chance(0.3):
        site.hang(site.pick("fire extinguisher", most=(0.4, 0.35, 0.7)), 0.9, clear=0.2)


def _switches(site: Site) -> None:
    """Beside each way into the area, at its handle's side first."""
    for side in site.sides:
        for opening in doorways(side):
            if opening.kind is OpeningKind.ENTRANCE and site.chance(0.3):
                continue
            off = (0.12, 0.2, 0.3)
            after, before = [opening.high + d for d in off], [opening.low - d for d in off]
            places = after + before if opening.hinge_low else before + after
            spots = [Spot(side, at) for at in places]
            site.hang(site.pick("switch", most=(0.2, 0.04, 0.2)), SWITCH_HEIGHT, spots, clear=0.1)


def _curtains(site: Site) -> None:
    if site.area.function not in _CURTAINED or not site.chance(0.6):
        return
    curtain = site.pick("curtain", exact=(0.3, 0.09, 2.15), colored=0.9)
    for side in site.sides:
        for window in side.openings:
            if curtain and window.kind is OpeningKind.WINDOW:
                for at in (window.low - 0.16, window.high + 0.16):
                    site.hang(curtain, 0.03, [Spot(side, at)])
