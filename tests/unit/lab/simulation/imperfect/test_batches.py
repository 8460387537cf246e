"""Batches as the mapper gets them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lab.simulation import SimulatedRoom
from lab.simulation.imperfect import (
    NOISY,
    PERFECT,
    FeatureModel,
    ImperfectParams,
    SeenFrame,
    Thing,
    coloured_frames,
    gated,
    imperfect_batches,
    imperfect_looks,
    onboard_of,
    onboard_with_features,
    truth_of,
)
from ovip.codec import encode_detection_batch
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.perception.domain.gate import GateParams
from services.perception.domain.lifting import LiftParams, lift, surface_cloud
from services.perception.domain.nearest import nearest_depth


@pytest.fixture(scope="module")
def room() -> SimulatedRoom:
    return SimulatedRoom()


@pytest.fixture(scope="module")
def room_things(room: SimulatedRoom) -> tuple[Thing, ...]:
    return tuple(Thing(o.object_id, o.label, (o.color,), o.structural) for o in room.objects)


@pytest.fixture(scope="module")
def room_frames(room: SimulatedRoom) -> list[SeenFrame]:
    return list(coloured_frames(room, room.walk()[:60:6]))


def test_detections_are_lifted_as_perception_lifts(
    room_frames: list[SeenFrame], room_things: tuple[Thing, ...]
) -> None:
    batches = list(imperfect_batches(room_frames, room_things, PERFECT))
    truth, model = truth_of(room_things), FeatureModel(tuple(t.label for t in room_things))
    for seen, batch in zip(room_frames, batches, strict=True):
        looks = imperfect_looks(seen, truth, model, PERFECT, 0)
        lifted = [(look, made) for look in looks if (made := lift(seen.frame, look.mask, LiftParams()))]
        assert len(lifted) == len(batch.detections) > 0
        for (look, made), detection in zip(lifted, batch.detections, strict=True):
            assert np.array_equal(detection.points, made.points) and np.array_equal(
                detection.colors, made.colors
            )
            assert np.array_equal(detection.box, made.box) and np.array_equal(detection.feature, look.feature)
            assert (detection.label, detection.box2) == (look.label, look.box2)
        assert np.array_equal(batch.surface, surface_cloud(seen.frame, LiftParams()))
        assert np.array_equal(batch.nearest, nearest_depth(seen.depth, farthest=LiftParams().farthest_seen))
        assert batch.words == tuple(sorted({look.label for look in looks})) and not batch.late


def test_the_same_seed_gives_the_same_bytes(
    room_frames: list[SeenFrame], room_things: tuple[Thing, ...]
) -> None:
    once, again, other = (
        [encode_detection_batch(b) for b in imperfect_batches(room_frames[:3], room_things, NOISY, seed)]
        for seed in (5, 5, 6)
    )
    assert once == again != other


def test_an_unsure_detection_drops_out(tabletop: list[SeenFrame], things: tuple[Thing, ...]) -> None:
    certain, unsure = (
        list(imperfect_batches(tabletop[:3], things, ImperfectParams(score=score))) for score in (0.0, 0.5)
    )
    assert sum(len(b.detections) for b in unsure) < sum(len(b.detections) for b in certain)
    assert all(d.score >= 0.35 for b in unsure for d in b.detections)


def test_perfect_batches_make_one_map_object_a_thing(
    room_frames: list[SeenFrame], room_things: tuple[Thing, ...], room: SimulatedRoom
) -> None:
    frames = list(coloured_frames(room, room.walk()[:160:5]))
    mapped = ObjectMap(MapParams())
    for batch in imperfect_batches(frames, room_things, PERFECT):
        mapped.integrate(batch)
    labels = [o.label for o in mapped.objects()]
    pixels = {t.object_id: sum(int((f.ids == t.object_id).sum() > 400) for f in frames) for t in room_things}
    well_seen = [t.label for t in room_things if not t.structural and pixels[t.object_id] >= 5]
    assert len(well_seen) >= 5
    for label in set(well_seen):
        assert labels.count(label) >= well_seen.count(label)


def test_gating_leaves_the_words_of_three_frames_or_more(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    batches = list(imperfect_batches(tabletop[:12], things, replace(NOISY, hallucinated=1.0)))
    left = list(gated(lambda: batches))
    named = {word: sum(word in b.words for b in batches) for b in batches for word in b.words}
    rare = {word for word, count in named.items() if count < 3}
    assert rare
    for before, after in zip(batches, left, strict=True):
        assert set(after.words) == {w for w in before.words if w not in rare} - GateParams().blacklist
        assert {d.label for d in after.detections} <= set(after.words)
        assert after.frame_id == before.frame_id and after.surface is before.surface
    assert {"mug", "table"} <= {d.label for b in left for d in b.detections}


def test_onboard_detections_are_the_looks(tabletop: list[SeenFrame], things: tuple[Thing, ...]) -> None:
    truth = truth_of(things)
    looks = imperfect_looks(tabletop[0], truth, FeatureModel(()), NOISY, 0)
    for look, plain, full in zip(looks, onboard_of(looks), onboard_with_features(looks), strict=True):
        assert (plain.label, plain.score, plain.box2) == (look.label, look.score, look.box2)
        assert plain.mask is look.mask is full.mask
        assert plain.feature is None and full.feature is look.feature
