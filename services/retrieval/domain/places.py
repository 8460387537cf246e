"""Which regions a spoken place means: by display name, by function, or by the same room function under
another name.
"""

from __future__ import annotations

from collections.abc import Sequence

from ovip.scene.types import Region
from ovip.scene.words import normalize_word
from services.retrieval.domain.priors import function_of


def matching_regions(place: str, regions: Sequence[Region]) -> tuple[Region, ...]:
    """Regions called `place`; none where no region is. `kitchen` means `kitchen 2` too, `lounge` a living
    room.
    """
    word = normalize_word(place)
    if not word:
        return ()
    named = tuple(region for region in regions if normalize_word(region.display_name) == word)
    if named:
        return named
    function = function_of(word)
    return tuple(
        region
        for region in regions
        if normalize_word(region.function) == word or (function and function_of(region.function) == function)
    )
