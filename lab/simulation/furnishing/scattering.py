"""Small things left about: whatever surface an area has, something lies on it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from lab.simulation.furnishing.site import Site
from lab.simulation.home import inside_polygon

_LEFT_ABOUT: Mapping[str, tuple[str, ...]] = {
    "kitchen": ("mug", "bottle", "glass", "spoon", "bowl", "jar", "salt shaker", "cup", "sponge", "plate"),
    "dining area": ("glass", "wine glass", "bottle", "mug", "salt shaker", "candle", "spoon", "book"),
    "living room": ("remote control", "book", "mug", "glass", "cell phone", "vase", "candle", "headphones"),
    "bedroom": ("book", "cell phone", "glass", "headphones", "box", "hat", "bottle", "tablet"),
    "bathroom": ("bottle", "soap", "sponge", "toothbrush", "candle", "jar"),
    "office": ("book", "mug", "pen holder", "bottle", "cell phone", "scissors", "glass", "tablet"),
    "laundry": ("bottle", "bottle", "sponge", "box", "jar"),
    "hallway": ("book", "bag", "hat", "cell phone", "bottle"),
    "entryway": ("book", "bag", "hat", "cell phone", "bottle"),
    "playroom": ("toy car", "doll", "book", "ball", "teddy bear", "mug"),
    "gym": ("bottle", "headphones", "cell phone"),
    "storage": ("hammer", "drill", "box", "bottle", "jar", "scissors"),
    "balcony": ("mug", "bottle", "book", "glass"),
}
_CARRIERS = (
    "kitchen cabinet", "dishwasher", "dining table", "table", "coffee table", "desk", "sideboard",
    "nightstand", "chest of drawers", "tv stand", "washing machine", "dryer", "shelf", "filing cabinet", "washbasin",
    "kitchen island", "stool", "bench", "piano", "bathtub",
)  # fmt: skip
_SEATS = ("sofa", "bed", "armchair")
_SMALL = (0.34, 0.34, 0.34)


def scatter(site: Site) -> None:
    """One to three small things on each table, board or chest; now and then one on a seat."""
    words = _LEFT_ABOUT[site.area.function]
    carriers = [
        thing
        for thing in site.stead.placed
        if thing.ware.label in (*_CARRIERS, *_SEATS)
        and inside_polygon(site.area.polygon, np.array([[thing.x, thing.y]]))[0]
    ]
    for carrier in carriers:
        most = 4 if carrier.ware.label in _CARRIERS else 2
        for _ in range(int(site.rng.integers(0, most))):
            word = words[int(site.rng.integers(len(words)))]
            site.put(site.pick(word, most=_SMALL), carrier)
