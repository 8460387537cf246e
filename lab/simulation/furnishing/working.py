"""Offices, playrooms, gyms and storage."""

from __future__ import annotations

import numpy as np

from lab.simulation.furnishing.kitchen import corner_first
from lab.simulation.furnishing.living import fill_basket
from lab.simulation.furnishing.placing import Placed
from lab.simulation.furnishing.seating import chairs_around
from lab.simulation.furnishing.site import Site
from lab.simulation.furnishing.storing import fill_shelf

_ON_DESK = (
    ("desk lamp", (0.75, 0.7), 0.8), ("mug", (0.6, 0.0), 0.7), ("pen holder", (-0.7, 0.4), 0.8),
    ("stapler", (-0.6, 0.0), 0.5), ("scissors", (-0.5, -0.3), 0.4), ("book", (-0.7, -0.2), 0.6),
    ("cell phone", (0.5, -0.5), 0.4), ("headphones", (0.7, -0.2), 0.4),
    ("tissue box", (0.8, 0.2), 0.2), ("telephone", (-0.8, 0.5), 0.4),
    ("picture frame", (0.5, 0.7), 0.2),
)  # fmt: skip


def furnish_office(site: Site) -> None:
    """A desk with what one works with, a chair before it, books, files."""
    desk = site.stand(site.pick("desk", most=(1.9, 0.95, 1.3), least=(0.9, 0.5, 0.6), colored=0.4), 0.8)
    if desk:
        site.stand_in_access(desk)
        chair = site.pick("office chair", most=(0.8, 0.8, 1.3), colored=0.5)
        for gap in (0.06, 0.15, 0.25):
            if site.before(desk, chair, gap, np.pi):
                break
        _on_desk(site, desk)
    case = site.stand(site.pick("bookshelf", most=(1.5, 0.5, 2.3), least=(0.4, 0.2, 1.2), colored=0.4), 0.5)
    fill_shelf(site, case, ("book",) * 14 + ("box", "globe", "camera", "vase"))
    files = site.stand(site.pick("filing cabinet", most=(0.8, 0.7, 1.3), colored=0.5), 0.5)
    printer = site.pick("printer", most=(0.5, 0.5, 0.4))
    for carrier in (files, desk):
        if site.put(printer, carrier, yaw=0.0):
            break
    for label in ("bin", "computer"):
        site.stand(site.pick(label, most=(0.35, 0.5, 0.5)), 0.0)
    if site.chance(0.5):
        site.hang(site.pick("whiteboard", most=(1.6, 0.3, 1.3)), 0.95, clear=0.3)
    if site.chance(0.5):
        site.stand(site.pick("plant", most=(0.7, 0.7, 1.6)), 0.0, prefer=corner_first)
    if site.chance(0.3):
        site.stand(site.pick("armchair", most=(1.0, 1.0, 1.2)), 0.4)


def furnish_playroom(site: Site) -> None:
    """A rug, a low table, shelves and boxes of toys; toys about."""
    rug = site.pick("rug", most=(2.0, 1.6, 9.0), exact=(None, None, 0.008))
    site.lay_rug(rug, None, 0.0)
    table = site.middle(site.pick("table", most=(0.9, 0.75, 0.8)), 0.55)
    chairs_around(site, table, "stool", 3)
    shelf = site.stand(site.pick("shelf", most=(1.3, 0.5, 1.6), least=(0.5, 0.2, 0.5)), 0.5)
    fill_shelf(
        site, shelf, ("book",) * 5 + ("box", "toy car", "teddy bear", "ball", "doll", "toy car", "box")
    )
    for label in ("crate", "basket", "box"):
        fill_basket(site, site.stand(site.pick(label, most=(0.65, 0.6, 0.5)), 0.0, prefer=corner_first))
    for label in ("toy car", "book", "doll", "teddy bear", "mug"):
        site.put(site.pick(label, most=(0.35, 0.35, 0.4)), table)
    for label in ("toy car", "ball", "teddy bear", "ball", "teddy bear", "toy car", "doll", "ottoman"):
        if site.chance(0.6):
            site.stand(site.pick(label, most=(0.65, 0.65, 0.5)), 0.0)


def furnish_gym(site: Site) -> None:
    """Treadmill and exercise bike, dumbbells, mats, a mirror, a bench with towel and bottle."""
    for label in ("treadmill", "exercise bike"):
        site.stand(site.pick(label, most=(1.0, 2.0, 1.7)), 0.4)
    bench = site.stand(site.pick("bench", most=(1.4, 0.5, 0.6)), 0.4)
    for label in ("bottle", "towel", "bottle", "headphones"):
        site.put(site.pick(label, most=(0.45, 0.4, 0.4)), bench)
    shelf = site.stand(site.pick("shelf", most=(1.1, 0.5, 1.6), least=(0.4, 0.2, 0.5)), 0.5)
    fill_shelf(site, shelf, ("dumbbell",) * 4 + ("bottle", "towel", "ball", "speaker"))
    for label in ("yoga mat", "dumbbell", "dumbbell", "ball", "fan", "yoga mat"):
        if site.chance(0.8):
            site.stand(site.pick(label, most=(0.75, 0.6, 0.8)), 0.0)
    site.hang(site.pick("mirror", most=(1.2, 0.2, 1.8)), 0.9, clear=0.4)


def furnish_storage(site: Site) -> None:
    """Shelves with boxes and tools, and what has no other place."""
    for _ in range(2):
        shelf = site.stand(site.pick("shelf", most=(1.3, 0.55, 2.2), least=(0.4, 0.2, 0.6)), 0.5)
        fill_shelf(
            site, shelf, ("box", "box", "toolbox", "drill", "hammer", "box", "jar", "basket", "bottle")
        )
    for label, most, share in (
        ("box", (0.65, 0.6, 0.5), 0.9), ("ladder", (0.7, 1.0, 2.0), 0.6), ("suitcase", (0.7, 0.5, 0.9), 0.7),
        ("vacuum cleaner", (0.5, 0.9, 1.2), 0.6), ("broom", (0.45, 0.3, 1.7), 0.6), ("bucket", (0.4, 0.4, 0.45), 0.6),
        ("crate", (0.65, 0.6, 0.5), 0.5), ("suitcase", (0.7, 0.5, 0.9), 0.4), ("box", (0.65, 0.6, 0.5), 0.5),
    ):  # fmt: skip
        if site.chance(share):
            fill_basket(site, site.stand(site.pick(label, most=most), 0.0, prefer=corner_first))


def _on_desk(site: Site, desk: Placed) -> None:
    if site.chance(0.6):
        monitor = site.pick("monitor", most=(0.75, 0.35, 0.6))
        site.put(monitor, desk, near=(0, 0.55), yaw=0.0)
        site.put(site.pick("keyboard", most=(0.55, 0.25, 0.1)), desk, near=(0, -0.5), yaw=0.0, within=0.4)
        site.put(site.pick("mouse"), desk, near=(0.45, -0.5), yaw=0.1, within=0.3)
    else:
        site.put(site.pick("laptop", most=(0.45, 0.45, 0.4)), desk, near=(0, -0.1), yaw=0.0)
    for label, near, share in _ON_DESK:
        if site.chance(share):
            site.put(site.pick(label, most=(0.4, 0.45, 0.6)), desk, near=near, within=0.5)
