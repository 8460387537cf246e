"""Tiers 1 to 3 on one question: map lookup, tag retrieval, history re-detection (CARA, SPEC 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ovip.scene.answers import Candidate, FrameRecord, TierResult
from ovip.scene.types import Detection, MapObject, Region
from services.retrieval.case import Case, Doubt, Ruling, chosen, judged, ranked, spoken
from services.retrieval.domain.confirm import target_words
from services.retrieval.domain.judgement import Judgement, Verdict
from services.retrieval.domain.lookup import ObjectMatch, look_up, unsettled
from services.retrieval.domain.names import match_name
from services.retrieval.domain.query import ANYTHING
from services.retrieval.domain.tags import Segment, bridge, score_frames
from services.retrieval.domain.vocabulary import synonyms
from services.retrieval.domain.votes import Sighting, Survivor, sight, vote
from services.retrieval.judge import Shot

_MOST_JUDGED = 24
_MOST_SURVIVORS = 6
_MORE_FRAMES = 2  # that a doubtful voxel must gain to be judged again


async def look_in_map(case: Case) -> Ruling:
    """Tier 1: objects by class name; no VLM call. The matches stay in the case for Tier 2's judgement."""
    objects = case.evidence.regions_of(case.places)
    labels = {item.label for item in objects}
    for target in case.alternatives or (case.target,):
        if target.noun == ANYTHING and target.purpose:
            return Ruling(TierResult.MISSING, f"nothing is known that serves to {target.purpose!r}")
        words = [target.noun, *(word for label in labels for word in synonyms(label))]
        lookup = look_up(target, objects, await case.evidence.texts(words), case.limits.names)
        if lookup.matches:
            case.target = target
            break
    case.matches = lookup.matches
    found = (
        tuple(as_candidate(match) for match in lookup.matches) if lookup.result is TierResult.FOUND else ()
    )
    return Ruling(lookup.result, lookup.why, found)


async def look_in_tags(case: Case) -> Ruling:
    """Tier 2: Tier 1's open instances judged on their best frames, else frames whose tags name the target."""
    if case.matches:
        ruling = await _judge_instances(case)
        if ruling.result is not TierResult.REJECTED:
            return ruling
        tagged = await _look_at_hot_frames(case)
        return replace(tagged, result=_worse(tagged.result), why=f"{ruling.why}; {tagged.why}")
    return await _look_at_hot_frames(case)


async def look_in_history(case: Case) -> Ruling:
    """Tier 3: the grounder again over the likeliest regions' frames, voxel votes, each survivor confirmed
    (VVC).
    """
    if case.target.noun == ANYTHING:
        return Ruling(TierResult.SKIPPED, "the question names no class that a grounder could look for")
    records, _ = await case.evidence.frames()
    if not records:
        return Ruling(TierResult.MISSING, "the frame history is empty")
    case.priors = await case.judge.priors(case.target, case.regions())
    sightings: list[Sighting] = []
    doubtful: tuple[Candidate, ...] = ()
    seen_regions: list[str] = []
    looked, blind, known_wrong = 0, 0, len(case.rejected)
    for name, frame_ids in _history(case, records):
        grounded = await ground(case, frame_ids)
        if case.unseeable:
            return Ruling(TierResult.MISSING, f"the grounder has no way to see {case.target.noun!r}")
        sightings.extend(grounded.sightings)
        blind += grounded.blind
        looked, seen_regions = looked + len(frame_ids), [*seen_regions, name]
        found, open_ones = await confirm_votes(case, sightings)
        if found:
            why = f"{found[0].why}; likeliest regions first by {case.priors.why}"
            return Ruling(TierResult.FOUND, why, found, open_ones)
        doubtful = open_ones or doubtful
    where = f"{looked} frames of {', '.join(seen_regions)}"
    if doubtful:
        return Ruling(TierResult.AMBIGUOUS, f"voted for in {where}, but not confirmed", (), doubtful)
    if len(case.rejected) > known_wrong:
        return Ruling(
            TierResult.REJECTED, f"{len(sightings)} detections in {where}, none voted for and confirmed"
        )
    if blind == looked:
        return Ruling(
            TierResult.MISSING, f"whoever looked at {where} may have no way to see {case.target.noun!r}"
        )
    if not sightings:
        return Ruling(TierResult.MISSING, f"the grounder sees no {case.target.noun!r} in {where}")
    enough = f"{case.limits.votes.frames} frames that is not already rejected"
    return Ruling(
        TierResult.MISSING, f"{len(sightings)} detections in {where}, no voxel with votes from {enough}"
    )


@dataclass(frozen=True, slots=True)
class Grounded:
    """What frames show of the target. blind: number of frames whose grounder may have no way to see it."""

    sightings: tuple[Sighting, ...] = ()
    blind: int = 0


async def ground(case: Case, frame_ids: Sequence[str]) -> Grounded:
    """Sightings of the target's words in the frames, batch by batch; nothing where it cannot be seen at all."""
    if await is_unseeable(case):
        return Grounded(blind=len(frame_ids))
    words = target_words(case.target.noun)
    sightings: list[Sighting] = []
    blind = 0
    for at in range(0, len(frame_ids), case.limits.ground_batch):
        batch = frame_ids[at : at + case.limits.ground_batch]
        found, unseen = await case.evidence.sources.grounder.ground(case.evidence.scene, batch, words)
        blind += len(batch) if set(words) <= set(unseen) else 0
        for frame_id in batch:
            named = _named(case, found.get(frame_id, ()))
            sightings.extend(sight(frame_id, item, case.limits.votes) for item in named)
    return Grounded(tuple(sightings), blind)


async def is_unseeable(case: Case) -> bool:
    """Whether no grounder at hand has a way to see the target; asked once a question."""
    if case.unseeable is None:
        case.unseeable = not await case.evidence.can_see(target_words(case.target.noun))
    return case.unseeable


async def confirm_votes(
    case: Case, sightings: Sequence[Sighting]
) -> tuple[tuple[Candidate, ...], tuple[Candidate, ...]]:
    """(found, doubtful) of the voxels that enough frames agree on.

    What was rejected stays rejected; a doubtful voxel is judged again when it has gained frames.
    """
    standing = [s for s in vote(sightings, case.limits.votes) if not case.is_rejected(s.position)]
    fresh = [s for s in standing if _worth_judging(case, s)][:_MOST_SURVIVORS]
    judgements = await case.judge.confirm(case.target, [_survivor_shot(case, survivor) for survivor in fresh])
    pairs = judged(case, [_survivor_candidate(case, survivor) for survivor in fresh], judgements)
    for survivor, (verdict, candidate) in zip(fresh, pairs, strict=True):
        case.doubts.pop(survivor.voxel, None)
        if verdict is Verdict.UNSURE:
            case.doubts[survivor.voxel] = Doubt(candidate, len(survivor.frames))
    return chosen(pairs, Verdict.ACCEPT), ranked([doubt.candidate for doubt in case.doubts.values()])


def as_candidate(match: ObjectMatch) -> Candidate:
    """A mapped object as a candidate."""
    item = match.object
    return Candidate(
        label=item.label,
        position=item.centroid,
        score=match.score,
        why=f"{match.name.kind.value}, seen in {item.frames} frames",
        object_id=item.object_id,
        box=item.box,
        frame_id=item.best_frame_id,
        box2=item.best_box2,
    )


async def _judge_instances(case: Case) -> Ruling:
    matches = case.matches[:_MOST_JUDGED]
    judgements = await case.judge.attributes(case.target, [_object_shot(case, match) for match in matches])
    pairs = judged(case, [as_candidate(match) for match in matches], judgements)
    found, doubtful = chosen(pairs, Verdict.ACCEPT), chosen(pairs, Verdict.UNSURE)
    if found:
        equal = f"; {len(found)} equal instances, the best seen first" if len(found) > 1 else ""
        return Ruling(TierResult.FOUND, f"{found[0].why}{equal}", found, doubtful)
    if not doubtful:
        return Ruling(TierResult.REJECTED, f"none of {len(matches)} objects is {_asked(case)}")
    unjudged = _unjudged(judgements)
    what = f"{spoken(unjudged)} could not be judged" if unjudged else f"none is clearly {_asked(case)}"
    many = f"{len(doubtful)} candidate{'s' * (len(doubtful) > 1)} ranked"
    return Ruling(TierResult.AMBIGUOUS, f"{what}; {many}", (), doubtful, unjudged)


async def _look_at_hot_frames(case: Case) -> Ruling:
    if case.target.noun == ANYTHING:
        return Ruling(TierResult.MISSING, "the question names no class that a tag could name")
    records, features = await case.evidence.frames()
    records = _in_places(case, records)
    tags = [record.tags for record in records]
    words = {word for frame in tags for word in frame}
    texts = await case.evidence.texts([case.target.noun, *(s for word in words for s in synonyms(word))])
    if texts is not None:
        texts = replace(texts, features={**texts.features, **features})
    scores, named = score_frames(case.target.noun, tags, texts, case.limits.names)
    segments = bridge(scores, named, case.limits.tags)[: case.limits.tags.best]
    if not segments:
        return Ruling(TierResult.MISSING, f"no tag of {len(records)} frames names {case.target.noun!r}")
    return await _judge_segments(case, records, segments)


async def _judge_segments(case: Case, records: Sequence[FrameRecord], segments: Sequence[Segment]) -> Ruling:
    """Grounds the target in each segment's best frame, judges what is there, lifts the accepted box to 3D."""
    tagged = (
        f"tagged {spoken([segment.word for segment in segments])} in {len(segments)} segments of the walk"
    )
    grounded = await ground(case, list(dict.fromkeys(records[segment.best].frame_id for segment in segments)))
    if case.unseeable:
        why = f"{tagged}, but the grounder has no way to see {case.target.noun!r}"
        return Ruling(TierResult.MISSING, why)
    fresh = [sighting for sighting in grounded.sightings if not case.is_rejected(sighting.center)]
    if not fresh:
        return Ruling(TierResult.MISSING, f"{tagged}, but nothing new is seen in their best frames")
    judgements = await case.judge.confirm(case.target, [_sighting_shot(case, sighting) for sighting in fresh])
    pairs = judged(case, [_sighting_candidate(case, sighting) for sighting in fresh], judgements)
    if found := chosen(pairs, Verdict.ACCEPT):
        return Ruling(TierResult.FOUND, f"{tagged}; {found[0].why}", found, chosen(pairs, Verdict.UNSURE))
    # one doubtful view is no reason to stop: the history may hold better ones
    return Ruling(TierResult.REJECTED, f"{tagged}, {len(fresh)} detections there, none confirmed")


def _history(case: Case, records: Sequence[FrameRecord]) -> list[tuple[str, list[str]]]:
    """(region name, frames to ground), likeliest region first, within the budget of frames; all frames
    without regions.
    """
    known = [record.frame_id for record in records]
    regions = [region for region in case.regions() if region.frame_ids]
    if not regions:
        return [("the whole scene", _spread(known, case.limits.history_frames))]
    priors = case.priors.by_region if case.priors else {}
    ranked: list[Region] = sorted(regions, key=lambda region: -priors.get(region.region_id, 0.0))
    left, share = case.limits.history_frames, -(-case.limits.history_frames // min(len(ranked), 3))
    batches: list[tuple[str, list[str]]] = []
    for region in ranked:
        frames = _spread([f for f in known if f in set(region.frame_ids)], min(share, left))
        left -= len(frames)
        if frames:
            batches.append((region.display_name or region.region_id, frames))
    return batches or [("the whole scene", _spread(known, case.limits.history_frames))]


def _spread(items: Sequence[str], most: int) -> list[str]:
    """At most `most` items, evenly spaced over the walk, in order."""
    if len(items) <= most:
        return list(items)
    return [items[int(k)] for k in np.linspace(0, len(items) - 1, most).round()] if most > 0 else []


def _in_places(case: Case, records: Sequence[FrameRecord]) -> list[FrameRecord]:
    if not case.places:
        return list(records)
    inside = {frame_id for region in case.places for frame_id in region.frame_ids}
    return [record for record in records if record.frame_id in inside]


def _named(case: Case, detections: Sequence[Detection]) -> list[Detection]:
    """Detections whose label means the target: a grounder may answer with more than it was asked for."""
    return [d for d in detections if match_name(case.target.noun, d.label, None, case.limits.names)]


def _object_shot(case: Case, match: ObjectMatch) -> Shot:
    item: MapObject = match.object
    attributes = unsettled(case.target, match)
    return Shot(
        item.best_frame_id,
        item.best_box2,
        item.mean_color,
        item.box,
        ((item.feature, item.label),),
        attributes,
    )


def _sighting_shot(case: Case, s: Sighting) -> Shot:
    return Shot(s.frame_id, s.box2, s.mean_color, s.box, ((s.feature, s.label),), case.target.attributes)


def _survivor_shot(case: Case, survivor: Survivor) -> Shot:
    best = survivor.sightings[0]
    color = np.mean([s.mean_color for s in survivor.sightings], axis=0)
    views = tuple((s.feature, s.label) for s in survivor.sightings)
    return Shot(best.frame_id, best.box2, color, survivor.box, views, case.target.attributes)


def _sighting_candidate(case: Case, s: Sighting) -> Candidate:
    why = f"{s.label!r} detected with {s.score:.2f}"
    return Candidate(s.label, s.center, s.score, why, _mapped_as(case, s), s.box, s.frame_id, s.box2)


def _survivor_candidate(case: Case, survivor: Survivor) -> Candidate:
    best = survivor.sightings[0]
    return Candidate(
        label=best.label,
        position=survivor.position,
        score=max(s.score for s in survivor.sightings),
        why=f"{len(survivor.frames)} frames agree on one {case.limits.votes.voxel:g} m voxel",
        object_id=_mapped_as(case, best),
        box=survivor.box,
        frame_id=best.frame_id,
        box2=best.box2,
    )


def _mapped_as(case: Case, s: Sighting) -> str:
    """The mapped object of that name whose box holds the sighting's centre; empty where there is none."""
    for item in case.evidence.scene_map.objects:
        inside = ((s.center >= item.box[:3]) & (s.center <= item.box[3:])).all()
        if inside and match_name(case.target.noun, item.label, None, case.limits.names):
            return item.object_id
    return ""


def _asked(case: Case) -> str:
    words = [*(attribute.word for attribute in case.target.attributes)]
    words += [f"{relation.words} the {relation.anchor}" for relation in case.target.relations]
    return spoken(words) if words else "what was asked for"


def _worth_judging(case: Case, survivor: Survivor) -> bool:
    doubt = case.doubts.get(survivor.voxel)
    return doubt is None or len(survivor.frames) >= doubt.frames + _MORE_FRAMES


def _unjudged(judgements: Sequence[Judgement]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(word for judgement in judgements for word in judgement.unjudged))


def _worse(result: TierResult) -> TierResult:
    """Instances were rejected and tags had nothing: the tier rejected."""
    return TierResult.REJECTED if result is TierResult.MISSING else result
