"""How imperfect the perception is: one level a kind of mistake, 0 = never made."""

from __future__ import annotations

from dataclasses import dataclass

ODD_TAGS = ("text", "logo", "pipe", "shadow", "reflection")
"""What an enumerator names that is no thing; the vocabulary's blacklist holds most of them."""


@dataclass(frozen=True, slots=True)
class ImperfectParams:
    """Levels are probabilities in one view unless said otherwise. A thing's own inclination to a mistake is drawn
    once, evenly between never and twice the level, so that the same sofa is split again and again.

    missed: of a thing that covers no pixel; falls to a tenth as it covers more than `small` of the image. Twice
        that for one cut by the image's border.
    split: of a thing that covers more than `large` of the image: a part of it is detected as a thing beside it, or
        (every third thing) its parts instead of it. Parts are the same parts of space in every view,
        `part_size` metres (smallest, largest) wide.
    swallows_carrier: the mask of a thing holds a patch of what it stands or hangs on, the grown box's share of it.
    swallows_things: the mask of a thing holds most of the things on it; they are detected too.
    truncated: of a thing cut by the image's border: the mask shows only a part of what is in the image.
    border: pixels (standard deviation, of an image 640 wide) by which a mask is too wide or too narrow.
    synonym: the label is a near synonym. lookalike: a word for a thing that looks alike. wrong: any word. A word
        once wrong for a thing is mostly the same word again. Small things are mislabelled up to twice as often.
    hallucinated: expected number, in a frame, of boxes with a word for something that is not there.
    score: deviation of scores; small things lose up to twice that.

    small, large: shares of the image's pixels. min_pixels: fewer visible are never detected. structure: labels of
    structural things that are detected.
    """

    missed: float = 0.0
    split: float = 0.0
    swallows_carrier: float = 0.0
    swallows_things: float = 0.0
    truncated: float = 0.0
    border: float = 0.0
    synonym: float = 0.0
    lookalike: float = 0.0
    wrong: float = 0.0
    hallucinated: float = 0.0
    score: float = 0.0
    small: float = 0.001
    large: float = 0.015
    part_size: tuple[float, float] = (0.4, 0.8)
    min_pixels: int = 20
    structure: frozenset[str] = frozenset()


PERFECT = ImperfectParams()
"""Every visible thing once, with its exact mask and label."""

NOISY = ImperfectParams(
    missed=0.6,
    split=0.15,
    swallows_carrier=0.1,
    swallows_things=0.3,
    truncated=0.15,
    border=1.5,
    synonym=0.12,
    lookalike=0.06,
    wrong=0.015,
    hallucinated=0.25,
    score=0.08,
)
"""What a plausible open-vocabulary detector and segmenter do in a furnished home. No detector was measured."""
