"""View-area weights and feature fusion (AWF, Eqs. 3 and 4)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ovip.scene.types import Box2


@dataclass(frozen=True, slots=True)
class FusionParams:
    """sigma_v: width of the view-centre prior (paper: 0.6)."""

    sigma_v: float = 0.6


def view_weight(box: Box2, width: int, height: int, params: FusionParams) -> float:
    """w_k = (a_k / HW) exp(-2 |p_k - p_0|^2 / (sigma_v^2 (W^2 + H^2))): large, centred views weigh most (Eq. 3).

    a_k: the box's area in pixels; p_k its centre; p_0 = (W/2, H/2).
    """
    px, py = (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2
    off_centre = (px - width / 2) ** 2 + (py - height / 2) ** 2
    return (
        box.area / (height * width) * math.exp(-2 * off_centre / (params.sigma_v**2 * (width**2 + height**2)))
    )
