"""Colours of regions: a function keeps its colour, and neighbours in the list do not share one."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

from ovip.scene.types import Region

UNKNOWN_COLOR = "#9aa0a6"
_COLORS = (
    "#e8a33d",  # kitchen
    "#4f9d69",  # living room
    "#5b8fd9",  # bathroom
    "#a47bd1",  # bedroom
    "#d9796b",  # dining room
    "#3fa7a3",  # office
    "#c98bb0",
    "#8ea33b",
    "#7d8fa8",
    "#c2703d",
)
_SLOTS = {
    "kitchen": 0,
    "living room": 1,
    "bathroom": 2,
    "bedroom": 3,
    "dining room": 4,
    "dining area": 4,
    "office": 5,
    "study": 5,
}


def region_colors(regions: Sequence[Region]) -> dict[str, str]:
    """Region id -> "#rrggbb". Unknown regions are grey; once all colours are taken they come again."""
    colors: dict[str, str] = {}
    taken: set[int] = set()
    for region in sorted(regions, key=lambda region: region.region_id):
        if region.function == "unknown":
            colors[region.region_id] = UNKNOWN_COLOR
            continue
        slot = _free_slot(_preferred_slot(region.function), taken)
        taken.add(slot)
        colors[region.region_id] = _COLORS[slot]
    return colors


def rgb(color: str) -> tuple[int, int, int]:
    """ "#rrggbb" as three numbers 0..255."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def _preferred_slot(function: str) -> int:
    return _SLOTS.get(function, zlib.crc32(function.encode()) % len(_COLORS))


def _free_slot(preferred: int, taken: set[int]) -> int:
    slots = [(preferred + step) % len(_COLORS) for step in range(len(_COLORS))]
    return next((slot for slot in slots if slot not in taken), preferred)
