"""Features as a CLIP-like encoder would give them: two cones with a gap, and crops that show what they contain.

An image feature is
    x = sqrt(common) c + sum_j w_j z_j + sqrt(aspect) A_i d + sqrt(noise(view)) n, at unit length
with z_j the content of each thing j in the crop by its share w_j, i the thing itself, d the direction it is seen
from, n new in every frame. A content is
    z_j = aligned m_j + sqrt(looks) l_j + sqrt(instance) o_j
with m_j the meaning of its label and attributes, which is all that the texts share with it; l_j what its class
looks like; o_j what only this thing looks like, in every view.

Levels. Texts and images lie in two separate cones (Liang et al., "Mind the Gap", NeurIPS 2022): a text and its
image have a cosine near 0.25 to 0.3, a wrong text 0.19 to 0.22 (openai/CLIP issue 405: 0.25, 0.22 and 0.19 for
three texts), while two images of anything have one near 0.5 (for the cones and their means, Levi and Gilboa, "The
Double-Ellipsoid Geometry of CLIP", 2024). Small things in a crop are classified worse for what else it shows
(Saranrittichai et al., "Zero-Shot Visual Classification with Guided Cropping", 2023). No image encoder was
measured here: the levels of images are set to reproduce these figures; those of texts are measured (`anchors`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from lab.simulation.imperfect.anchors import (
    FIRST_SEMANTIC,
    AnchorParams,
    conformity,
    meaning,
    spectrum,
)
from lab.simulation.imperfect.kinship import kin_of
from lab.simulation.imperfect.streams import stream
from lab.simulation.imperfect.truth import TrueThing, Truth
from ovip.errors import InvalidInput
from ovip.scene.types import F32, F64
from ovip.scene.words import normalize_word

SMALLEST_DIMENSION = 32
_TEMPLATES = ("a photo of a ", "a photo of an ", "a photo of the ", "an image of ", "a photo of ")


@dataclass(frozen=True, slots=True)
class FeatureParams:
    """Energies of an image feature's parts in a good view; they sum to about 1.

    common: what all images share. gap: cosine of that with what all texts share. aligned: weight (not energy) of
    what it means. looks, instance, aspect, noise: see the module. kind_looks, synonym_looks: shares of a class's
    looks common to its kind and to its near synonyms. meant: share of instance, aspect and noise that lies as
    meanings lie, and so moves the classification; the rest is in any direction. meant_looks: the same share of a
    class's looks: what misleads in every view of every such thing. attribute: weight of an attribute's meaning
    beside the label's.

    On the small house (45 classes, exact masks of 83 things) these levels give: right text 0.27, wrong 0.21; a thing
    seen well twice 0.85, its class 0.75, another class 0.58; first among the classes 0.69 of things over 80 pixels
    wide, 0.52 over 32, 0.38 below, 0.75 once all of a thing's views are averaged.

    clear_side: side in pixels of a 640 pixel wide image's crop from which on a view is good (an encoder sees 224).
    smaller: noise added per halving below it, as a multiple. truncated, off_centre, blurred: noise added, as a
    multiple, where the whole crop's rim is the image's, where it lies in a corner, where the blur is as long as it.
    context: weight of a pixel around the mask beside one inside. structure: of a pixel of a wall, floor, ceiling.
    """

    common: float = 0.52
    gap: float = 0.33
    aligned: float = 0.147
    looks: float = 0.23
    instance: float = 0.09
    aspect: float = 0.05
    noise: float = 0.053
    kind_looks: float = 0.15
    synonym_looks: float = 0.45
    meant: float = 0.75
    meant_looks: float = 0.35
    attribute: float = 0.35
    clear_side: float = 160.0
    smaller: float = 2.0
    truncated: float = 3.0
    off_centre: float = 0.5
    blurred: float = 2.0
    context: float = 0.35
    structure: float = 0.5


@dataclass(frozen=True, slots=True)
class View:
    """One crop. frame: its index. thing: object id that the view is of, 0 = of nothing.

    inside: pixels of each object within the mask, around: within the crop but not the mask. side: square root of
    the crop's pixels, in an image 640 wide. truncated, off_centre: 0..1. blur: pixels, at 640. direction: `(3,)`
    unit, world, from the camera to the thing. name: tells several views of a thing in a frame apart.
    """

    frame: int
    thing: int
    inside: dict[int, int]
    around: dict[int, int]
    side: float
    truncated: float
    off_centre: float
    blur: float
    direction: F64
    name: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class _Content:
    """What a thing brings into a feature: `(D,)`, and its looks from the world's three directions `(3, D)`."""

    content: F64
    aspects: F64


@dataclass(slots=True, eq=False)
class FeatureModel:
    """Text and image features of a seeded encoder; the same words give the same texts whatever the labels.

    labels: classes known besides the table of kin; a phrase that ends in a known class is that class with
    attributes ("red mug"), any other is a class of its own.
    """

    labels: Sequence[str]
    dimension: int = 512
    seed: int = 0
    anchors: AnchorParams = field(default_factory=AnchorParams)
    params: FeatureParams = field(default_factory=FeatureParams)
    _deviations: F64 = field(init=False, repr=False)
    _known: frozenset[str] = field(init=False, repr=False)
    _contents: dict[tuple[int, int, str, tuple[str, ...]], _Content] = field(
        init=False, repr=False, default_factory=dict
    )

    def __post_init__(self) -> None:
        if self.dimension < SMALLEST_DIMENSION:
            raise InvalidInput(f"dimension: expected at least {SMALLEST_DIMENSION}, got {self.dimension}")
        self._deviations = spectrum(self.dimension)
        self._known = frozenset(normalize_word(label) for label in self.labels)

    @property
    def space(self) -> str:
        """What names this feature space."""
        return f"lab-clip-{self.dimension}-{self.seed}"

    def text(self, labels: Sequence[str]) -> F32:
        """Unit features `(N, D)` of labels, phrases, or either in a prompt ("A photo of a mug.")."""
        features = [self._text(normalize_word(_without_template(label))) for label in labels]
        return np.asarray(features, np.float32).reshape(len(features), self.dimension)

    def image(self, views: Sequence[View], truth: Truth, seed: int = 0) -> F32:
        """Unit features `(N, D)` of crops; seed: the scene's, for what is its things' and its frames' own."""
        features = [self._image(view, truth, seed) for view in views]
        return np.asarray(features, np.float32).reshape(len(features), self.dimension)

    def noise(self, view: View) -> float:
        """Energy of what is new in this view: more where the crop is small, cut, off centre or blurred."""
        p = self.params
        halvings = max(0.0, float(np.log2(p.clear_side / max(view.side, 1.0))))
        worse = (
            p.smaller * halvings
            + p.truncated * view.truncated
            + p.off_centre * view.off_centre
            + p.blurred * min(1.0, view.blur / max(view.side, 1.0))
        )
        return p.noise * (1 + worse)

    def _text(self, phrase: str) -> F64:
        attributes, label = self._parsed(phrase)
        common = conformity(label, self.seed, self.anchors)
        feature = np.sqrt(1 - common**2) * self._meaning(label, attributes)
        feature[0] += common
        return np.asarray(feature, np.float64)

    def _image(self, view: View, truth: Truth, seed: int) -> F64:
        p = self.params
        feature = self._mixed(view, truth, seed)
        if view.thing in truth:
            feature += np.sqrt(p.aspect) * (view.direction @ self._content(truth[view.thing], seed).aspects)
        noise = stream(seed, "noise", view.thing, view.frame, view.name)
        feature += np.sqrt(self.noise(view)) * self._any(noise, p.meant)
        feature[:FIRST_SEMANTIC] += np.sqrt(p.common) * np.array([p.gap, np.sqrt(1 - p.gap**2)])
        return np.asarray(feature / np.linalg.norm(feature), np.float64)

    def _mixed(self, view: View, truth: Truth, seed: int) -> F64:
        """The contents of all that the crop shows, by what it shows of them."""
        weights: dict[int, float] = {}
        for pixels, weight in ((view.inside, 1.0), (view.around, self.params.context)):
            for object_id, count in pixels.items():
                if object_id in truth:
                    faint = self.params.structure if truth[object_id].structural else 1.0
                    weights[object_id] = weights.get(object_id, 0.0) + weight * faint * count
        total = sum(weights.values())
        mixed = np.zeros(self.dimension)
        for object_id, weight in weights.items():
            mixed += weight / total * self._content(truth[object_id], seed).content
        return mixed

    def _content(self, thing: TrueThing, seed: int) -> _Content:
        key = (seed, thing.object_id, thing.label, thing.attributes)
        if key not in self._contents:
            self._contents[key] = self._made(thing, seed)
        return self._contents[key]

    def _made(self, thing: TrueThing, seed: int) -> _Content:
        p = self.params
        label = normalize_word(thing.label)
        own = stream(seed, "instance", thing.object_id, label)
        content = (
            p.aligned * self._meaning(label, tuple(normalize_word(word) for word in thing.attributes))
            + np.sqrt(p.looks) * self._looks(label)
            + np.sqrt(p.instance) * self._any(own, p.meant)
        )
        return _Content(content, np.stack([self._any(own, p.meant) for _ in range(3)]))

    def _meaning(self, label: str, attributes: Sequence[str]) -> F64:
        meant = meaning(label, self._deviations, self.seed, self.anchors)
        for attribute in attributes:
            meant = meant + self.params.attribute * meaning(
                attribute, self._deviations, self.seed, self.anchors
            )
        return np.asarray(meant / np.linalg.norm(meant), np.float64)

    def _looks(self, label: str) -> F64:
        p, kin = self.params, kin_of(label)
        own = self._any(stream(self.seed, "looks", label), p.meant_looks)
        if kin is None:
            return own
        mixed = (
            np.sqrt(p.kind_looks) * self._any(stream(self.seed, "looks of kind", kin.kind), p.meant_looks)
            + np.sqrt(p.synonym_looks)
            * self._any(stream(self.seed, "looks of", *kin.synonyms), p.meant_looks)
            + np.sqrt(1 - p.kind_looks - p.synonym_looks) * own
        )
        return np.asarray(mixed / np.linalg.norm(mixed), np.float64)

    def _any(self, rng: np.random.Generator, share: float) -> F64:
        """A unit vector `(D,)`: `share` of its energy lies as meanings lie, the rest in any direction."""
        meant, rest = rng.standard_normal((2, len(self._deviations)))
        meant *= self._deviations
        mixed = np.sqrt(share) * meant / np.linalg.norm(meant) + np.sqrt(1 - share) * rest / np.linalg.norm(
            rest
        )
        return np.concatenate([np.zeros(FIRST_SEMANTIC), mixed / np.linalg.norm(mixed)])

    def _parsed(self, phrase: str) -> tuple[tuple[str, ...], str]:
        """Attributes and class of a phrase, by the longest known class that it ends in."""
        words = phrase.split(" ")
        for at in range(len(words)):
            label = " ".join(words[at:])
            if label in self._known or kin_of(label):
                return tuple(words[:at]), label
        return (), phrase


def _without_template(text: str) -> str:
    plain = text.strip().rstrip(".")
    start = next((t for t in _TEMPLATES if plain.lower().startswith(t)), "")
    return plain[len(start) :]
