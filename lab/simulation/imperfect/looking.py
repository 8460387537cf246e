"""One frame as an imperfect detector and segmenter see it: labelled masks with their features."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from lab.simulation.imperfect.contacts import Contacts, contacts
from lab.simulation.imperfect.features import FeatureModel, View
from lab.simulation.imperfect.frames import SeenFrame
from lab.simulation.imperfect.kinship import part_words
from lab.simulation.imperfect.masks import (
    box_of_mask,
    cut_short,
    on_border,
    parts,
    patch_of,
    with_border_error,
)
from lab.simulation.imperfect.naming import any_word, called
from lab.simulation.imperfect.params import ODD_TAGS, ImperfectParams
from lab.simulation.imperfect.streams import happens, stream
from lab.simulation.imperfect.truth import Truth
from ovip.scene.types import F32, I64, Bools, Box2
from ovip.scene.words import normalize_word
from services.perception.domain.segmentation import pixels_of, surface_mask

_FULL_WIDTH = 640.0  # pixels that levels in pixels refer to
_MARGIN = 0.1  # context around the box, share of its size, as perception's encoders crop
_SWALLOWED = 0.8  # of the things on a thing, where it swallows them
_HALLUCINATED_SIZE = (0.06, 0.25)  # of the image's sides


class Mistake(StrEnum):
    """What is wrong with a detection's mask, or all of it."""

    PART = "part"
    SWALLOWS_CARRIER = "swallows carrier"
    SWALLOWS_THINGS = "swallows things"
    TRUNCATED = "truncated"
    HALLUCINATED = "hallucinated"


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """One detection before lifting. object_id: what it is of in truth, 0 = hallucinated. mask: `(H, W)`.

    feature: `(D,)` unit. mistake: None where the mask is whole but for its border.
    """

    object_id: int
    label: str
    score: float
    box2: Box2
    mask: Bools
    feature: F32
    mistake: Mistake | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _Mask:
    object_id: int
    label: str
    score: float
    mask: Bools
    mistake: Mistake | None
    name: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class _Sight:
    """A frame and what can be counted in it. pixels: visible of each id."""

    seen: SeenFrame
    truth: Truth
    params: ImperfectParams
    seed: int
    pixels: I64
    contacts: Contacts

    def share(self, object_id: int) -> float:
        return float(self.pixels[object_id]) / self.seen.ids.size

    def smallness(self, object_id: int) -> float:
        """1 for a thing of no pixel, falling to 0."""
        return float(np.exp(-self.share(object_id) / self.params.small))

    def happens(self, mistake: str, level: float, object_id: int) -> bool:
        return happens(self.seed, mistake, level, object_id, self.seen.index)


def imperfect_looks(
    seen: SeenFrame, truth: Truth, model: FeatureModel, params: ImperfectParams, seed: int
) -> tuple[Look, ...]:
    """What is detected in a frame, by object id, hallucinations last; the same whatever other frames there are."""
    sight = _sight(seen, truth, params, seed)
    masks = [mask for object_id in _visible(sight) for mask in _masks_of(sight, object_id)]
    masks.extend(_hallucinations(sight))
    boxes = [box_of_mask(item.mask) for item in masks]
    views = [_view(sight, item, box) for item, box in zip(masks, boxes, strict=True)]
    features = model.image(views, truth, seed)
    return tuple(
        Look(item.object_id, item.label, item.score, box, item.mask, feature, item.mistake)
        for item, box, feature in zip(masks, boxes, features, strict=True)
    )


def _sight(seen: SeenFrame, truth: Truth, params: ImperfectParams, seed: int) -> _Sight:
    most = max([int(seen.ids.max(initial=0)), *truth])
    pixels = np.bincount(seen.ids.ravel(), minlength=most + 1)
    return _Sight(seen, truth, params, seed, pixels, contacts(seen.ids, seen.depth, pixels))


def _visible(sight: _Sight) -> list[int]:
    """Ids of what can be detected in the frame."""
    return [
        object_id
        for object_id in np.flatnonzero(sight.pixels >= max(1, sight.params.min_pixels)).tolist()
        if object_id in sight.truth and _is_detected(sight, object_id)
    ]


def _is_detected(sight: _Sight, object_id: int) -> bool:
    thing = sight.truth[object_id]
    return not thing.structural or normalize_word(thing.label) in sight.params.structure


def _masks_of(sight: _Sight, object_id: int) -> list[_Mask]:
    """The masks that a thing gets in a frame: none, one, or some where it is split."""
    mask = sight.seen.ids == object_id
    if _missed(sight, object_id, mask):
        return []
    pieces = _split(sight, object_id, mask)
    if pieces and _in_place(sight, object_id):
        return pieces
    return [_whole(sight, object_id, mask), *pieces[:1]]


def _missed(sight: _Sight, object_id: int, mask: Bools) -> bool:
    level = sight.params.missed * (0.1 + 0.9 * sight.smallness(object_id))
    return sight.happens("missed", level * (2 if on_border(mask) else 1), object_id)


def _split(sight: _Sight, object_id: int, mask: Bools) -> list[_Mask]:
    params = sight.params
    if sight.share(object_id) < params.large or not sight.happens("split", params.split, object_id):
        return []
    words = part_words(normalize_word(sight.truth[object_id].label))
    word = words[int(stream(sight.seed, "part word", object_id).integers(len(words)))]
    pieces = parts(sight.seen, mask, object_id, sight.seed, params.part_size)
    return [
        _Mask(
            object_id,
            word,
            _score(sight, object_id, f"part {number}"),
            _rough(sight, piece, object_id, f"part {number}"),
            Mistake.PART,
            f"part {number}",
        )
        for number, piece in enumerate(pieces)
    ]


def _in_place(sight: _Sight, object_id: int) -> bool:
    """Whether a thing's parts are seen instead of it: every third thing's."""
    return bool(stream(sight.seed, "parts in place", object_id).random() < 1 / 3)


def _whole(sight: _Sight, object_id: int, mask: Bools) -> _Mask:
    mask, mistake = _mistaken(sight, object_id, mask)
    return _Mask(
        object_id,
        called(
            sight.truth[object_id].label,
            object_id,
            sight.smallness(object_id),
            sight.params,
            sight.seed,
            sight.seen.index,
        ),
        _score(sight, object_id, ""),
        _rough(sight, mask, object_id, ""),
        mistake,
    )


def _mistaken(sight: _Sight, object_id: int, mask: Bools) -> tuple[Bools, Mistake | None]:
    """At most one mistake a mask."""
    params, seen = sight.params, sight.seen
    carried = [i for i in sight.contacts.carried_by(object_id) if i in sight.truth and _is_detected(sight, i)]
    if carried and sight.happens("swallows things", params.swallows_things, object_id):
        rng = stream(sight.seed, "swallowed", object_id, seen.index)
        swallowed = [i for i in carried if rng.random() < _SWALLOWED] or carried
        return mask | np.isin(seen.ids, swallowed), Mistake.SWALLOWS_THINGS
    carrier = sight.contacts.carrier.get(object_id)
    if carrier and sight.happens("swallows carrier", params.swallows_carrier, object_id):
        rng = stream(sight.seed, "patch", object_id, seen.index)
        return mask | patch_of(seen.ids == carrier, mask, rng), Mistake.SWALLOWS_CARRIER
    if on_border(mask) and sight.happens("truncated", params.truncated, object_id):
        return cut_short(mask, stream(sight.seed, "cut", object_id, seen.index)), Mistake.TRUNCATED
    return mask, None


def _rough(sight: _Sight, mask: Bools, object_id: int, name: str) -> Bools:
    deviation = sight.params.border * sight.seen.intrinsics.width / _FULL_WIDTH
    draw = stream(sight.seed, "border", object_id, sight.seen.index, name).standard_normal()
    return with_border_error(mask, round(deviation * draw))


def _score(sight: _Sight, object_id: int, name: str) -> float:
    draw = stream(sight.seed, "score", object_id, sight.seen.index, name).standard_normal()
    lost = sight.params.score * (2 + draw + 2 * sight.smallness(object_id))
    return float(np.clip(1 - lost, 0.05, 1.0))


def _hallucinations(sight: _Sight) -> list[_Mask]:
    """Boxes anywhere, masked by the surface in them, with a word for nothing that is there."""
    rng = stream(sight.seed, "hallucinated", sight.seen.index)
    return [
        made
        for number in range(int(rng.poisson(sight.params.hallucinated)))
        if (made := _hallucination(sight, rng, number)) is not None
    ]


def _hallucination(sight: _Sight, rng: np.random.Generator, number: int) -> _Mask | None:
    height, width = sight.seen.ids.shape
    w, h = rng.uniform(*_HALLUCINATED_SIZE, 2) * (width, height)
    x, y = rng.uniform(0, 1, 2) * (width - w, height - h)
    word = ODD_TAGS[int(rng.integers(len(ODD_TAGS)))] if rng.random() < 0.3 else any_word(rng)
    score = float(rng.uniform(0.36, 0.7))
    mask = surface_mask(sight.seen.depth, Box2(float(x), float(y), float(x + w), float(y + h)))
    if mask.sum() < max(1, sight.params.min_pixels):
        return None
    return _Mask(0, word, score, mask, Mistake.HALLUCINATED, f"hallucinated {number}")


def _view(sight: _Sight, item: _Mask, box: Box2) -> View:
    """What an encoder sees of a detection: its box with a margin."""
    seen, k = sight.seen, sight.seen.intrinsics
    x0, y0, x1, y1 = pixels_of(_grown(box), seen.ids.shape)
    ids, mask = seen.ids[y0:y1, x0:x1], item.mask[y0:y1, x0:x1]
    full = _FULL_WIDTH / k.width
    cx, cy = (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2
    ray = seen.world_from_camera[:3, :3] @ np.array([(cx - k.cx) / k.fx, (cy - k.cy) / k.fy, 1.0])
    off = ((cx - k.width / 2) ** 2 + (cy - k.height / 2) ** 2) / ((k.width**2 + k.height**2) / 4)
    return View(
        frame=seen.index,
        thing=item.object_id,
        inside=_counted(ids[mask]),
        around=_counted(ids[~mask]),
        side=float(np.sqrt(ids.size)) * full,
        truncated=_rim_on_border(box, k.width, k.height),
        off_centre=float(min(1.0, off)),
        blur=seen.blur * full,
        direction=ray / np.linalg.norm(ray),
        name=item.name,
    )


def _grown(box: Box2) -> Box2:
    dx, dy = _MARGIN * (box.x1 - box.x0), _MARGIN * (box.y1 - box.y0)
    return Box2(box.x0 - dx, box.y0 - dy, box.x1 + dx, box.y1 + dy)


def _counted(ids: np.ndarray[tuple[int, ...], np.dtype[np.uint16]]) -> dict[int, int]:
    counts = np.bincount(ids.ravel())
    return {int(i): int(counts[i]) for i in np.flatnonzero(counts) if i > 0}


def _rim_on_border(box: Box2, width: int, height: int) -> float:
    """Share of a box's rim that is the image's."""
    w, h = box.x1 - box.x0, box.y1 - box.y0
    on = (box.x0 <= 0) * h + (box.x1 >= width) * h + (box.y0 <= 0) * w + (box.y1 >= height) * w
    return float(on / (2 * (w + h)))
