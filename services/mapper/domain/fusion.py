"""What a view weighs in its object's feature (AWF, Eqs. 3 and 4)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from ovip.scene.types import Box2


class Weighting(StrEnum):
    """view-area: the paper's. area: without its view-centre prior. count: every view alike, ConceptGraphs' mean."""

    VIEW_AREA = "view-area"
    AREA = "area"
    COUNT = "count"


@dataclass(frozen=True, slots=True)
class FusionParams:
    """sigma_v: width of the view-centre prior (paper: 0.6). weighting: the others are ablations."""

    sigma_v: float = 0.6
    weighting: Weighting = Weighting.VIEW_AREA


def fusion_weight(box: Box2, width: int, height: int, params: FusionParams) -> float:
    """w_k of a view whose detection has `box` (pixels) in an image of `width` x `height`."""
    if params.weighting is Weighting.COUNT:
        return 1.0
    if params.weighting is Weighting.AREA:
        return box.area / (height * width)
    return view_weight(box, width, height, params.sigma_v)


def view_weight(box: Box2, width: int, height: int, sigma_v: float) -> float:
    """w_k = (a_k / HW) exp(-2 |p_k - p_0|^2 / (sigma_v^2 (W^2 + H^2))): large, centred views weigh most (Eq. 3).

    a_k: the box's area in pixels; p_k its centre; p_0 = (W/2, H/2).
    """
    px, py = (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2
    off_centre = (px - width / 2) ** 2 + (py - height / 2) ** 2
    return box.area / (height * width) * math.exp(-2 * off_centre / (sigma_v**2 * (width**2 + height**2)))
