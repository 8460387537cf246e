"""Judging what geometry and names leave open: a VLM within a budget, else the documented fallback, which is
noted.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.errors import NotFound, Unavailable
from ovip.scene.types import F32, F64, Box2, Region
from services.retrieval.domain.attributes import Subject, can_judge, judge_attributes
from services.retrieval.domain.confirm import (
    ConfirmParams,
    confirm_by_features,
    distractors,
    target_words,
    without_label,
)
from services.retrieval.domain.judgement import Judgement, Verdict, combine
from services.retrieval.domain.names import NameParams, TextFeatures, match_names
from services.retrieval.domain.places import matching_regions
from services.retrieval.domain.priors import Priors, table_priors
from services.retrieval.domain.query import Attribute, Target
from services.retrieval.domain.questions import (
    ask_about_crops,
    ask_for_priors,
    ask_for_things,
    read_crops,
    read_priors,
    read_things,
)
from services.retrieval.domain.relations import judge_relation
from services.retrieval.domain.vocabulary import ROOMS_OF
from services.retrieval.evidence import Evidence
from services.retrieval.ports import Crops
from services.retrieval.vlm_budget import UNANSWERED, VlmBudget

CROPS_A_CALL = 6
_PURPOSE_LIKENESS = 0.45  # MiniLM: "sit on" is .54 from chair, "charge my phone" .66 from charger


@dataclass(frozen=True, slots=True)
class Shot:
    """A candidate as it is judged: where it is best seen, its colour, box and features.

    mean_color: `(3,)` RGB; box: `(6,)` metres. views: a feature `(D,)` and the detector's label each.
    attributes: what this candidate's name leaves open.
    """

    frame_id: str
    box2: Box2 | None
    mean_color: F64
    box: F64
    views: tuple[tuple[F32, str], ...]
    attributes: tuple[Attribute, ...]


_Fallback = Callable[[Target, Sequence[Shot]], Awaitable[tuple[Judgement, ...]]]


class Judge:
    """One question's judge."""

    def __init__(self, vlm: VlmBudget, crops: Crops, evidence: Evidence) -> None:
        self.vlm = vlm
        self._crops = crops
        self._evidence = evidence

    async def priors(self, target: Target, regions: Sequence[Region]) -> Priors:
        """S(goal | region) by the VLM, else by the room table."""
        labels = {item.object_id: item.label for item in self._evidence.scene_map.objects}
        described = [
            (r.region_id, r.display_name, r.function, [labels[i] for i in r.object_ids if i in labels])
            for r in regions
        ]
        fallback = await self._table_priors(target, regions)
        if not regions:
            return fallback
        try:
            reply = read_priors(await self.vlm.ask(ask_for_priors(target.phrase, described)))
        except UNANSWERED as error:
            self.vlm.fell_back(f"priors: {fallback.why}", error)
            return fallback
        return Priors(
            {r.region_id: reply.get(r.region_id, fallback.by_region[r.region_id]) for r in regions}, "the VLM"
        )

    async def attributes(self, target: Target, shots: Sequence[Shot]) -> tuple[Judgement, ...]:
        """Each alike instance against the target's attributes (VLM on its crop, else colour and box) and
        relations.
        """
        if not shots:
            return ()
        relations = [self._relations(target, shot) for shot in shots]
        if not any(shot.attributes for shot in shots):
            return tuple(relations)
        how = "attributes: mapped colours and boxes"
        seen = await self._see_or(target, shots, how, self._by_colour_and_box)
        return _both(seen, relations)

    async def confirm(self, target: Target, shots: Sequence[Shot]) -> tuple[Judgement, ...]:
        """Each voted or grounded candidate: is it the target at all, attributes included; relations by
        geometry.
        """
        if not shots:
            return ()
        how = "confirmation: encoder features against the target and other words"
        seen = await self._see_or(target, shots, how, self._by_features)
        return _both(seen, [self._relations(target, shot) for shot in shots])

    async def things_for(self, target: Target) -> tuple[str, ...]:
        """Nouns of things that serve the target's purpose, best first: by the VLM, else the most alike table
        words.
        """
        try:
            return read_things(await self.vlm.ask(ask_for_things(target.phrase)))
        except UNANSWERED as error:
            self.vlm.fell_back("purpose: household words alike in text features", error)
            return await self._alike_words(target.purpose)

    async def _see_or(
        self, target: Target, shots: Sequence[Shot], how: str, fallback: _Fallback
    ) -> tuple[Judgement, ...]:
        """VLM verdicts on crops, a few a call; from the first that cannot be had on, the fallback's."""
        judged: list[Judgement] = []
        while len(judged) < len(shots):
            try:
                judged.extend(await self._see(target, shots[len(judged) : len(judged) + CROPS_A_CALL]))
            except UNANSWERED as error:
                self.vlm.fell_back(how, error)
                return (*judged, *await fallback(target, shots[len(judged) :]))
        return tuple(judged)

    async def _see(self, target: Target, shots: Sequence[Shot]) -> tuple[Judgement, ...]:
        self.vlm.check_open()
        try:
            images = [await self._crop(shot) for shot in shots]
        except NotFound as error:
            raise Unavailable(f"a frame to look at is gone: {error}") from error
        return read_crops(await self.vlm.ask(ask_about_crops(target.phrase, len(shots)), images), len(shots))

    async def _crop(self, shot: Shot) -> bytes:
        if not shot.frame_id or shot.box2 is None:
            raise Unavailable("a candidate has no frame to look at")
        image = await self._evidence.sources.frames.get_rgb(self._evidence.scene, shot.frame_id)
        return await self._crops.crop(image, shot.box2)

    def _relations(self, target: Target, shot: Shot) -> Judgement:
        return combine(
            [
                judge_relation(r, shot.box, self._anchors(r.anchor))
                for r in target.relations
                if not self.is_place(r.anchor)
            ]
        )

    def _anchors(self, anchor: str) -> F64:
        labels = {item.label for item in self._evidence.scene_map.objects}
        names = {match.name for match in match_names(anchor, tuple(labels), None, NameParams())}
        boxes = [item.box for item in self._evidence.scene_map.objects if item.label in names]
        return np.array(boxes).reshape(-1, 6)

    def is_place(self, anchor: str) -> bool:
        """Whether a relation's anchor is a region rather than an object: it chose the regions already."""
        return bool(matching_regions(anchor, self._evidence.partition.regions))

    async def _by_colour_and_box(self, target: Target, shots: Sequence[Shot]) -> tuple[Judgement, ...]:
        likeness = await self._likeness(target, shots)
        subjects = [Subject(s.mean_color, s.box, like) for s, like in zip(shots, likeness, strict=True)]
        alike = {shot.attributes for shot in shots}
        if len(alike) == 1:
            return judge_attributes(shots[0].attributes, subjects)
        return tuple(judge_attributes(s.attributes, subjects)[k] for k, s in enumerate(shots))

    async def _by_features(self, target: Target, shots: Sequence[Shot]) -> tuple[Judgement, ...]:
        """Encoder similarity for the kind, colour and box for the attributes."""
        attributes = await self._by_colour_and_box(target, shots)
        words, others = target_words(target.noun), distractors(target.noun)
        texts = await self._evidence.texts([*words, *others, *_labels(shots)])
        if texts is None:
            unseen = Judgement(Verdict.UNSURE, 0.5, "no text features to confirm it by", (target.noun,))
            return tuple(combine([unseen, attribute]) for attribute in attributes)
        own = np.stack([texts.features[word] for word in words])
        rivals = np.stack([texts.features[word] for word in others])
        kinds = [confirm_by_features(target.noun, _images(shot, texts), own, rivals) for shot in shots]
        return tuple(combine([kind, attribute]) for kind, attribute in zip(kinds, attributes, strict=True))

    async def _likeness(self, target: Target, shots: Sequence[Shot]) -> list[float]:
        """Cosine of each shot's image with the phrase: ranks what cannot be judged; 0 where unknown."""
        if all(can_judge(shot.attributes) for shot in shots):
            return [0.0] * len(shots)
        texts = await self._evidence.texts([target.phrase, *_labels(shots)])
        if texts is None:
            return [0.0] * len(shots)
        return [_mean_cosine(_images(shot, texts), texts.features[target.phrase]) for shot in shots]

    async def _table_priors(self, target: Target, regions: Sequence[Region]) -> Priors:
        functions = {region.region_id: region.function or region.display_name for region in regions}
        texts = await self._evidence.texts([target.noun, *ROOMS_OF]) if regions else None
        return table_priors(target.noun, functions, texts)

    async def _alike_words(self, purpose: str) -> tuple[str, ...]:
        """At most two table words; words of the purpose itself ("phone" of "charge my phone") are no answer
        to it.
        """
        texts = await self._evidence.texts([purpose, *ROOMS_OF])
        if texts is None:
            return ()
        said = set(purpose.split())
        words = [word for word in ROOMS_OF if not said & set(word.split())]
        cosines = {word: float(texts.features[word] @ texts.features[purpose]) for word in words}
        best = sorted(words, key=lambda word: -cosines[word])[:2]
        return tuple(word for word in best if cosines[word] >= _PURPOSE_LIKENESS)


def _both(seen: Sequence[Judgement], relations: Sequence[Judgement]) -> tuple[Judgement, ...]:
    return tuple(combine([a, b]) if b.why else a for a, b in zip(seen, relations, strict=True))


def _labels(shots: Sequence[Shot]) -> list[str]:
    return [label for shot in shots for _, label in shot.views]


def _images(shot: Shot, texts: TextFeatures) -> list[F32]:
    """The views' features without what the detector's label put into them."""
    share = ConfirmParams().share_in(texts.space)
    return [
        without_label(view, texts.features[label], share)
        if view.shape == texts.features[label].shape
        else view
        for view, label in shot.views
    ]


def _mean_cosine(views: Sequence[F32], phrase: F32) -> float:
    usable = [view for view in views if view.shape == phrase.shape]
    return float(np.mean([view @ phrase for view in usable])) if usable else 0.0
