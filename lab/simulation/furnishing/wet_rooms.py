"""Bathrooms and laundries."""

from __future__ import annotations

from lab.simulation.furnishing.kitchen import corner_first
from lab.simulation.furnishing.living import fill_basket
from lab.simulation.furnishing.placing import Placed
from lab.simulation.furnishing.site import Site, Spot
from lab.simulation.furnishing.storing import fill_shelf


def furnish_bathroom(site: Site, washes_here: bool) -> None:
    """Toilet, washbasin under a mirror, bathtub or shower; towels on a rack; washes_here: the washing machine."""
    tub = None
    if site.chance(0.6):
        tub = site.stand(site.pick("bathtub", most=(1.9, 0.95, 0.8)), 0.5, prefer=corner_first)
    if tub is None:
        site.stand(site.pick("shower", most=(1.1, 1.2, 2.3)), 0.5, prefer=corner_first)
    toilet = site.stand(site.pick("toilet", most=(0.5, 0.8, 1.0)), 0.5)
    basin = site.stand(
        site.pick("washbasin", most=(1.0, 0.75, 1.1), least=(0.3, 0.25, 0.5)), 0.55, prefer=_wall_for_mirror
    )
    _washing_place(site, basin)
    if toilet:
        site.beside(toilet, site.pick("toilet brush", most=(0.2, 0.2, 0.6)), 1, 0.06)
        paper = site.pick("toilet paper", most=(0.25, 0.2, 0.25))
        reach = toilet.ware.width / 2 + 0.15
        if not site.above(toilet, paper, 0.65, reach):
            site.above(toilet, paper, 0.65, -reach)
    if tub:
        site.stand_in_access(tub)
        mat = site.pick("bath mat", most=(0.9, 0.6, 0.2), exact=(None, None, 0.008))
        site.lay_rug(mat, tub, 0.05)
    for _ in range(2):
        _towels(site)
    shelf = site.stand(site.pick("shelf", most=(0.7, 0.42, 1.9), least=(0.3, 0.2, 0.5), colored=0.4), 0.45)
    fill_shelf(
        site,
        shelf,
        (
            "towel",
            "bottle",
            "soap",
            "toilet paper",
            "bottle",
            "toothbrush",
            "jar",
            "towel",
            "soap dispenser",
            "sponge",
        ),
    )
    if washes_here:
        site.stand(site.pick("washing machine", most=(0.75, 0.75, 1.0)), 0.6)
    for label, most, share in (
        ("bin", (0.35, 0.35, 0.5), 0.7),
        ("laundry basket", (0.5, 0.5, 0.75), 0.5),
        ("scale", (0.4, 0.4, 0.3), 0.5),
    ):
        if site.chance(share):
            fill_basket(site, site.stand(site.pick(label, most=most), 0.0, prefer=corner_first))


def furnish_laundry(site: Site) -> None:
    """Washing machine and dryer side by side, ironing board, baskets, a shelf with bottles, cleaning things."""
    washer = site.stand(site.pick("washing machine", most=(0.75, 0.75, 1.0)), 0.6, prefer=corner_first)
    dryer = site.pick("dryer", most=(0.75, 0.75, 1.0))
    machines = [washer]
    if washer:
        machines.append(
            site.beside(washer, dryer, 1, access=0.6) or site.beside(washer, dryer, -1, access=0.6)
        )
    board = site.stand(site.pick("ironing board", most=(1.5, 0.6, 1.1)), 0.4)
    site.put(site.pick("iron", most=(0.4, 0.4, 0.3)), board, near=(0.2, 0))
    shelf = site.stand(site.pick("shelf", most=(1.1, 0.5, 2.0), least=(0.4, 0.2, 0.5)), 0.5)
    fill_shelf(site, shelf, ("bottle", "bottle", "box", "towel", "sponge", "jar", "box", "basket"))
    if site.chance(0.5):
        site.hang(site.pick("water heater", most=(0.5, 0.5, 0.9)), 1.5)
    for machine in machines:
        for label in ("bottle", "box", "clothes", "basket", "bottle", "soap dispenser"):
            if machine and site.chance(0.45):
                site.put(site.pick(label, most=(0.45, 0.45, 0.4)), machine)
    for label, most, share in (
        ("laundry basket", (0.6, 0.6, 0.75), 0.9),
        ("bucket", (0.4, 0.4, 0.45), 0.6),
        ("broom", (0.45, 0.3, 1.7), 0.5),
        ("vacuum cleaner", (0.5, 0.9, 1.2), 0.4),
        ("drying rack", (1.2, 1.0, 1.2), 0.4),
    ):
        if site.chance(share):
            fill_basket(site, site.stand(site.pick(label, most=most), 0.0))


def _wall_for_mirror(spot: Spot) -> bool:
    """Places with a window behind come last."""
    return spot.side.meets_opening(spot.along - 0.35, spot.along + 0.35, 1.0, 2.0)


def _washing_place(site: Site, basin: Placed | None) -> None:
    if basin is None:
        return
    mirror = site.pick("mirror", most=(basin.ware.width, 0.12, 0.9), least=(0.25, 0, 0.3))
    for bottom in (1.2, 1.3, 1.05):
        if site.above(basin, mirror, bottom):
            break
    for label in ("soap dispenser", "toothbrush", "soap", "glass", "bottle"):
        if site.chance(0.7):
            site.put(
                site.pick(label, most=(0.2, 0.2, 0.3)),
                basin,
                near=(0.7, 0.7) if site.chance(0.5) else (-0.7, 0.7),
            )


def _towels(site: Site) -> None:
    """A rack with one or two towels that differ."""
    rack = site.hang(site.pick("towel rack", most=(0.75, 0.2, 0.6)), 1.15, clear=0.3)
    if rack is None:
        return
    width = min(0.4, rack.ware.width / 2 - 0.01)
    for shift in (-rack.ware.width / 4, rack.ware.width / 4):
        towel = site.pick("towel", most=(0.5, 0.25, 0.75), exact=(width, 0.04, None), colored=1.0)
        site.hang_on(towel, rack, shift)
