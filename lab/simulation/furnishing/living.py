"""Living rooms and bedrooms."""

from __future__ import annotations

import numpy as np

from lab.simulation.furnishing.kitchen import corner_first
from lab.simulation.furnishing.placing import Carrier, Placed
from lab.simulation.furnishing.site import Site, Spot
from lab.simulation.furnishing.storing import fill_shelf
from lab.simulation.furnishing.wares import Ware
from lab.simulation.home import RelationKind

_SOFA_GAP = (1.7, 3.6)  # metres between a television and who watches it
_BESIDE_BED = 0.55  # of free floor that a bed needs along a side


def furnish_living_room(site: Site) -> None:
    """A sofa that looks at a television, a low table between them, shelves, plants, lamps, a rug."""
    stand = site.stand(site.pick("tv stand", most=(2.0, 0.6, 0.8), colored=0.4), 0.6, prefer=_off_middle)
    _television(site, stand)
    sofa = _facing(site, stand, site.pick("sofa", most=(2.5, 1.15, 1.1), colored=0.6))
    if sofa is None:
        sofa = site.stand(site.pick("sofa", most=(2.2, 1.1, 1.1), colored=0.6), 0.6)
    _coffee_table(site, sofa)
    _cushions(site, sofa, int(site.rng.integers(2, 5)))
    for _ in range(int(site.rng.integers(0, 3))):
        chair = site.stand(site.pick("armchair", most=(1.1, 1.05, 1.2), colored=0.6), 0.5)
        _cushions(site, chair, 1)
    case = site.stand(site.pick("bookshelf", most=(1.5, 0.5, 2.3), least=(0.4, 0.2, 1.2), colored=0.4), 0.6)
    fill_shelf(site, case, ("book",) * 12 + ("vase", "box", "camera", "globe", "candle", "picture frame"))
    for label, most, share in (
        ("floor lamp", (0.6, 0.6, 2.0), 0.8),
        ("plant", (0.9, 0.9, 2.0), 0.8),
        ("speaker", (0.35, 0.4, 1.2), 0.3),
        ("basket", (0.5, 0.5, 0.5), 0.4),
        ("plant", (0.7, 0.7, 1.5), 0.3),
        ("ottoman", (0.95, 0.9, 0.65), 0.3),
    ):
        if site.chance(share):
            fill_basket(site, site.stand(site.pick(label, most=most), 0.0, prefer=corner_first))
    if site.chance(0.35):
        board = site.stand(site.pick("sideboard", most=(2.0, 0.55, 1.1), colored=0.4), 0.5)
        for label in ("aquarium", "vase", "sculpture", "picture frame", "globe", "telephone"):
            if site.chance(0.4):
                site.put(site.pick(label, most=(0.75, 0.4, 0.6)), board)
    if site.chance(0.25):
        site.stand(site.pick("fireplace", most=(1.4, 0.5, 1.4)), 0.7)
    elif site.chance(0.3):
        site.stand(site.pick("piano", most=(1.6, 0.8, 1.5), colored=0.3), 0.7)
    if site.chance(0.25):
        site.stand(site.pick("guitar", most=(0.5, 0.4, 1.2)), 0.0, prefer=corner_first)


def furnish_bedroom(site: Site) -> None:
    """A bed with its head at the wall and nightstands beside it, a wardrobe, drawers, what lies about."""
    bed = _bed(site)
    stands = []
    for right in (-1, 1):
        stand = site.pick("nightstand", most=(0.6, 0.55, 0.75), colored=0.3)
        if bed and (placed := site.beside(bed, stand, right)):
            stands.append(placed)
    _bedding(site, bed)
    for placed in stands:
        _on_nightstand(site, placed)
    ward = site.stand(site.pick("wardrobe", most=(2.1, 0.75, 2.4), colored=0.3), 0.7, prefer=corner_first)
    if ward is None:
        site.stand(site.pick("wardrobe", most=(1.1, 0.7, 2.2), colored=0.3), 0.6)
    chest = site.stand(site.pick("chest of drawers", most=(1.5, 0.6, 1.2), colored=0.4), 0.6)
    for label in ("vase", "box", "clothes", "picture frame", "candle", "plant", "hat", "bag"):
        if site.chance(0.4):
            site.put(site.pick(label, most=(0.45, 0.4, 0.5)), chest)
    if site.chance(0.4):
        chair = site.stand(site.pick("armchair" if site.chance(0.4) else "chair", most=(1.0, 1.0, 1.2)), 0.4)
        site.put(site.pick("clothes", most=(0.4, 0.45, 0.3)), chair, near=(0, 0))
    for label, most, share in (
        ("laundry basket", (0.55, 0.55, 0.75), 0.4),
        ("plant", (0.6, 0.6, 1.4), 0.4),
        ("suitcase", (0.6, 0.4, 0.8), 0.25),
        ("backpack", (0.4, 0.4, 0.5), 0.3),
        ("fan", (0.4, 0.4, 1.3), 0.25),
        ("crib", (0.8, 1.3, 1.2), 0.15),
        ("bag", (0.45, 0.3, 0.45), 0.25),
    ):
        if site.chance(share):
            fill_basket(site, site.stand(site.pick(label, most=most), 0.0, prefer=corner_first))
    if bed:
        for _ in range(4):
            slipper = site.pick("slipper", most=(0.35, 0.35, 0.2))
            if slipper and site.before(bed, slipper, 0.15, shift=float(site.rng.uniform(-0.5, 0.5))):
                break


def fill_basket(site: Site, basket: Placed | None) -> None:
    """Something lies in a basket, a crate or a box."""
    insides = {"basket": "blanket", "laundry basket": "clothes", "crate": "ball", "bucket": "sponge"}
    if basket is None or basket.ware.label not in insides:
        return
    side = min(basket.ware.width, basket.ware.depth) * 0.75
    ware = site.pick(insides[basket.ware.label], most=(side, side, 0.35))
    site.put(ware, basket, near=(0, 0), yaw=0.0, where="hollow", within=0.05)


def _television(site: Site, stand: Placed | None) -> None:
    if stand is None:
        return
    tv = site.put(
        site.pick("tv", most=(stand.ware.width + 0.05, 0.4, 0.9), least=(0.4, 0, 0.3)), stand, (0, 0.3), 0.0
    )
    if tv is None:
        site.above(
            stand, site.pick("tv", most=(1.3, 0.2, 0.9), least=(0.4, 0, 0.3)), stand.ware.height + 0.25
        )
    for label, share in (
        ("remote control", 0.7), ("game console", 0.6), ("game controller", 0.5), ("game controller", 0.3),
        ("speaker", 0.3), ("vase", 0.3), ("picture frame", 0.2),
    ):  # fmt: skip
        if site.chance(share):
            site.put(site.pick(label, most=(0.4, 0.35, 0.4)), stand)


def _off_middle(spot: Spot) -> float:
    """Far from the middle of its wall, short walls last."""
    return abs(spot.along - (spot.side.low + spot.side.high) / 2) - 0.2 * spot.side.length


def _facing(site: Site, stand: Placed | None, ware: Ware | None) -> Placed | None:
    """Opposite the stand, as far off as one still watches from."""
    if stand is None or ware is None:
        return None
    for gap in np.arange(_SOFA_GAP[1], _SOFA_GAP[0], -0.1):
        for shift in (0.0, -0.3, 0.3, -0.6, 0.6):
            x, y = stand.world(np.array([shift, -(stand.ware.depth + ware.depth) / 2 - gap]))
            thing = Placed(ware, float(x), float(y), 0.0, stand.yaw + np.pi, RelationKind.ON, Carrier.FLOOR)
            if placed := site.settle(thing, 0.45):
                return placed
    return None


def _coffee_table(site: Site, sofa: Placed | None) -> None:
    if sofa is None:
        return
    site.stand_in_access(sofa)
    table = None
    for gap in (0.4, 0.35, 0.5, 0.3):
        ware = site.pick("coffee table", most=(1.3, 0.8, 0.55), colored=0.4)
        table = table or site.before(sofa, ware, gap)
    rug = site.pick("rug", most=(2.6, 1.8, 9.0), least=(0.8, 0.6, 0.0), exact=(None, None, 0.008))
    site.lay_rug(rug, sofa, 0.1)
    for label in (
        "remote control", "remote control", "book", "mug", "mug", "newspaper", "vase", "candle", "glass",
        "game controller", "bowl", "cell phone", "tablet", "tray", "tissue box", "laptop",
    ):  # fmt: skip
        if site.chance(0.5):
            site.put(site.pick(label, most=(0.4, 0.35, 0.4)), table)


def _cushions(site: Site, seat: Placed | None, count: int) -> None:
    for index in range(count):
        along = 0.0 if count == 1 else -0.75 + 1.5 * index / (count - 1)
        site.put(site.pick("cushion", most=(0.5, 0.5, 0.5)), seat, near=(along, 0.0), yaw=0.0, within=0.45)


def _bed(site: Site) -> Placed | None:
    """The largest bed that leaves a way along a side: a double one in the middle of a wall, else one beside it."""
    for most in ((2.1, 2.35, 1.4), (1.7, 2.25, 1.4), (1.3, 2.2, 1.4)):
        ware = site.pick("bed", most=most, least=(0.8, 1.6, 0.3))
        prefer = _off_middle if ware and ware.width > 1.3 else corner_first
        if placed := site.stand(ware, _BESIDE_BED, prefer=prefer):
            return placed
    return None


def _bedding(site: Site, bed: Placed | None) -> None:
    if bed is None:
        return
    for along in (-0.45, 0.45) if bed.ware.width > 1.3 else (0.0,):
        pillow = site.pick("pillow", most=(0.75, 0.5, 0.3), least=(0.3, 0.2, 0.0))
        site.put(pillow, bed, near=(along, 0.68), yaw=0.0, within=0.5)
    if site.chance(0.6):
        site.put(site.pick("blanket", most=(0.9, 0.8, 0.35)), bed, near=(0.3, -0.6), within=0.7)
    for label, share in (
        ("teddy bear", 0.35),
        ("book", 0.4),
        ("clothes", 0.3),
        ("cushion", 0.4),
        ("tablet", 0.2),
    ):
        if site.chance(share):
            site.put(
                site.pick(label, most=(0.5, 0.5, 0.45)), bed, near=(float(site.rng.uniform(-0.6, 0.6)), 0.1)
            )


def _on_nightstand(site: Site, stand: Placed) -> None:
    site.put(site.pick("lamp", most=(0.35, 0.35, 0.6)), stand, near=(0, 0.4))
    for label in ("clock", "book", "glass", "cell phone", "mug", "tissue box"):
        if site.chance(0.5):
            site.put(site.pick(label, most=(0.26, 0.26, 0.3)), stand)
