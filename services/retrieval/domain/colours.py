"""Colour words judged from a mean colour in CIELAB (SPEC 6: without a VLM).

A basic colour is a soft region of CIELAB (D65): lightness L 0..100, chroma C = |(a, b)|, hue h in degrees.
Membership is the least of three ramps, each 1 inside its range and falling to 0 over a margin. Rules, hues
from the sRGB colours of those names; measured on a real kitchen's recording: white mug L 80 C 2, patterned
mug L 67 C 10, reddish-brown chairs L 23-37 C 12-22 h 28-51, grey-black chair L 42 C 4, light wood table L
65-78 C 10-18 h 70.

White and black depend on the exposure, which indoors is dark and warm: an object that is lighter (darker)
than every alike one by a margin gains, one that is outdone loses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from skimage.color import rgb2lab

from ovip.scene.types import F64
from services.retrieval.domain.judgement import Judgement, Verdict


@dataclass(frozen=True, slots=True)
class ColourParams:
    """Memberships that settle it, and the lead in lightness that counts in full for white and black."""

    accept: float = 0.55
    reject: float = 0.25
    lead: float = 12.0
    lead_weight: float = 0.3


@dataclass(frozen=True, slots=True)
class _Range:
    """1 between low and high, 0 beyond the margin."""

    low: float
    high: float
    margin: float

    def of(self, value: F64) -> F64:
        outside = np.maximum(np.maximum(self.low - value, value - self.high), 0.0)
        return np.asarray(np.clip(1.0 - outside / self.margin, 0.0, 1.0))


_ANY_HUE = _Range(-360.0, 360.0, 1.0)
# lightness, chroma, hue (a range may start below 0: hues are taken around its middle)
_BASIC: dict[str, tuple[_Range, _Range, _Range]] = {
    "white": (_Range(75, 100, 30), _Range(0, 11, 12), _ANY_HUE),
    "black": (_Range(0, 22, 22), _Range(0, 10, 10), _ANY_HUE),
    "grey": (_Range(32, 68, 20), _Range(0, 9, 9), _ANY_HUE),
    "red": (_Range(18, 62, 15), _Range(30, 200, 22), _Range(5, 42, 22)),
    "pink": (_Range(62, 95, 20), _Range(16, 200, 10), _Range(-30, 25, 20)),
    "orange": (_Range(48, 85, 15), _Range(38, 200, 20), _Range(50, 74, 14)),
    "brown": (_Range(15, 60, 15), _Range(11, 50, 8), _Range(30, 82, 16)),
    "yellow": (_Range(65, 100, 20), _Range(30, 200, 18), _Range(82, 108, 14)),
    "green": (_Range(10, 95, 10), _Range(13, 200, 9), _Range(112, 185, 22)),
    "blue": (_Range(8, 92, 10), _Range(11, 200, 8), _Range(200, 306, 22)),
    "purple": (_Range(10, 80, 15), _Range(14, 200, 10), _Range(308, 338, 18)),
}
_BY_EXPOSURE = {"white": 1.0, "black": -1.0}


def membership(colour: str, rgb: F64) -> F64:
    """How much `(N, 3)` mean colours, RGB 0..255, are of a basic colour -> `(N,)` in 0..1."""
    lightness, chroma, hue = _lightness_chroma_hue(rgb)
    in_lightness, in_chroma, in_hue = _BASIC[colour]
    middle = (in_hue.low + in_hue.high) / 2
    around = middle + (hue - middle + 180.0) % 360.0 - 180.0
    least = np.minimum(np.minimum(in_lightness.of(lightness), in_chroma.of(chroma)), in_hue.of(around))
    return np.asarray(least)


def judge_colour(colour: str, rgb: F64, params: ColourParams | None = None) -> tuple[Judgement, ...]:
    """Each of N alike instances with mean colours `(N, 3)`, RGB 0..255, against a basic colour."""
    params = params or ColourParams()
    if not len(rgb):
        return ()
    absolute = membership(colour, rgb)
    lead = _lead(colour, rgb, params)
    scores = np.where(absolute > 0, np.clip(absolute + params.lead_weight * lead, 0.0, 1.0), 0.0)
    others = {name: membership(name, rgb) for name in _BASIC}
    return tuple(
        Judgement(
            _verdict(score, params), float(score), _why(colour, float(score), others, k, float(lead[k]))
        )
        for k, score in enumerate(scores)
    )


def _lightness_chroma_hue(rgb: F64) -> tuple[F64, F64, F64]:
    lab = rgb2lab(np.asarray(rgb, dtype=np.float64)[None] / 255.0)[0]
    return lab[:, 0], np.hypot(lab[:, 1], lab[:, 2]), np.degrees(np.arctan2(lab[:, 2], lab[:, 1])) % 360.0


def _lead(colour: str, rgb: F64, params: ColourParams) -> F64:
    """-1..1: by how much each is the lightest (white) or darkest (black) of the instances; 0 for one."""
    if colour not in _BY_EXPOSURE or len(rgb) < 2:
        return np.zeros(len(rgb))
    lightness, chroma, _ = _lightness_chroma_hue(rgb)
    key = _BY_EXPOSURE[colour] * lightness - 0.5 * chroma
    best_other = np.array([np.delete(key, k).max() for k in range(len(key))])
    return np.asarray(np.clip((key - best_other) / params.lead, -1.0, 1.0))


def _verdict(score: float, params: ColourParams) -> Verdict:
    if score >= params.accept:
        return Verdict.ACCEPT
    return Verdict.REJECT if score <= params.reject else Verdict.UNSURE


def _why(colour: str, score: float, others: dict[str, F64], index: int, lead: float) -> str:
    strongest = max(others, key=lambda name: others[name][index])
    relative = ""
    if lead and colour in _BY_EXPOSURE:
        tone = "lightest" if colour == "white" else "darkest"
        relative = f", the {tone} of its kind" if lead > 0 else f", not the {tone} of its kind"
    looks = f" (looks {strongest})" if strongest != colour and others[strongest][index] > 0.3 else ""
    return f"{colour} {score:.2f} by its mean colour{relative}{looks}"


def closest_colour(rgb: Sequence[float] | F64) -> str:
    """The basic colour that a mean colour, RGB 0..255, is most of; empty where it is none."""
    rows = np.asarray(rgb, dtype=np.float64).reshape(1, 3)
    scores = {name: float(membership(name, rows)[0]) for name in _BASIC}
    best = max(scores, key=lambda name: scores[name])
    return best if scores[best] > 0 else ""
