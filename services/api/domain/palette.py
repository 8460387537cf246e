"""Colours of regions: a function keeps its colour in every scene, and its second region gets a shade of it."""

from __future__ import annotations

import colorsys
import zlib
from collections import Counter
from collections.abc import Sequence

from ovip.scene.types import Region

UNKNOWN_COLOR = "#9aa0a6"
TINT = 0.42
"""Share of a region's colour in the colour of its floor, over white; the dashboard's style sheet says the same."""

PAPER, FLOOR, WALL = (247, 245, 240), (255, 255, 255), (58, 67, 80)
INK, SOFT, HAZE = (31, 39, 51), (91, 101, 116), (226, 223, 214)
DOOR, FRONTIER, STAIRS = (122, 74, 36), (201, 74, 48), (88, 84, 120)
"""What is not a region: unseen, floor, walls; words, words of less weight, hatching; marks."""
_OF_FUNCTION = {
    "kitchen": "#e8923a",
    "dining area": "#d9b32c",
    "living room": "#58a567",
    "bedroom": "#5b8fd9",
    "bathroom": "#2fa6a9",
    "office": "#8e78d3",
    "laundry": "#6f93b3",
    "entryway": "#b57b52",
    "hallway": "#b7a079",
    "gym": "#d3625f",
    "playroom": "#d97bb0",
    "storage": "#98836f",
    "garage": "#7c8799",
    "balcony": "#94b145",
}
_SAME_AS = {
    "dining room": "dining area",
    "study": "office",
    "corridor": "hallway",
    "entrance": "entryway",
    "lounge": "living room",
    "toilet": "bathroom",
    "closet": "storage",
    "terrace": "balcony",
}
_OTHERS = ("#c2703d", "#5d9c8b", "#a86fa3", "#8ea33b", "#c9678a", "#4f86a6", "#a8894a", "#7f74b8")
_SHADES = ((0.0, 0.0), (0.02, -0.12), (-0.02, 0.10), (0.035, 0.05), (-0.03, -0.18), (0.0, 0.17))
"""Turn of the hue and change of the lightness of a function's first, second, ... region; then they come again."""


def region_colors(regions: Sequence[Region]) -> dict[str, str]:
    """Region id -> "#rrggbb". Unknown regions are grey."""
    seen: Counter[str] = Counter()
    colors: dict[str, str] = {}
    for region in sorted(regions, key=lambda region: (len(region.region_id), region.region_id)):
        colors[region.region_id] = _shade(function_color(region.function), seen[region.function])
        seen[region.function] += region.function != "unknown"
    return colors


def function_color(function: str) -> str:
    """The colour of a function's first region, "#rrggbb"; one that nobody foresaw gets one by its name."""
    if function == "unknown":
        return UNKNOWN_COLOR
    other = _OTHERS[zlib.crc32(function.encode()) % len(_OTHERS)]
    return _OF_FUNCTION.get(_SAME_AS.get(function, function), other)


def rgb(color: str) -> tuple[int, int, int]:
    """ "#rrggbb" as three numbers 0..255."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def mixed(color: tuple[int, int, int], other: tuple[int, int, int], share: float) -> tuple[int, int, int]:
    """`color` with a share, 0..1, of `other` in it."""
    red, green, blue = (round((1 - share) * a + share * b) for a, b in zip(color, other, strict=True))
    return red, green, blue


def _shade(color: str, number: int) -> str:
    turn, lighter = _SHADES[number % len(_SHADES)]
    hue, light, vivid = colorsys.rgb_to_hls(*(value / 255 for value in rgb(color)))
    shaded = colorsys.hls_to_rgb((hue + turn) % 1, min(0.78, max(0.3, light + lighter)), vivid)
    return "#" + "".join(f"{round(255 * value):02x}" for value in shaded)
