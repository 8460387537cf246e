"""Imperfect looks: each kind of mistake does what it says, as often as it says, and none depends on another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lab.simulation import SimulatedRoom
from lab.simulation.imperfect import (
    NOISY,
    PERFECT,
    FeatureModel,
    ImperfectParams,
    Look,
    Mistake,
    SeenFrame,
    Thing,
    coloured_frames,
    imperfect_looks,
    truth_of,
)
from lab.simulation.imperfect.kinship import kin_words
from lab.simulation.imperfect.params import ODD_TAGS
from ovip.scene.types import Intrinsics

WALL, TABLE, FIRST_CUP, CUPS = 1, 2, 10, 24
CAMERA = Intrinsics(115.0, 115.0, 79.5, 59.5, 160, 120)
MODEL = FeatureModel(("mug", "table", "wall"), dimension=32)


def looks(
    frames: Sequence[SeenFrame], things: Sequence[Thing], params: ImperfectParams, seed: int = 0
) -> list[tuple[Look, ...]]:
    truth = truth_of(things)
    return [imperfect_looks(seen, truth, MODEL, params, seed) for seen in frames]


def same(a: Sequence[Look], b: Sequence[Look]) -> bool:
    return len(a) == len(b) and all(
        (x.object_id, x.label, x.score, x.box2, x.mistake)
        == (y.object_id, y.label, y.score, y.box2, y.mistake)
        and np.array_equal(x.mask, y.mask)
        and np.array_equal(x.feature, y.feature)
        for x, y in zip(a, b, strict=True)
    )


def test_perfect_perception_sees_each_visible_thing_once_with_its_exact_mask(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    seen = tabletop[0]
    (found,) = looks([seen], things, PERFECT)
    assert [look.object_id for look in found] == [TABLE, *range(FIRST_CUP, FIRST_CUP + CUPS)]
    for look in found:
        assert np.array_equal(look.mask, seen.ids == look.object_id)
        assert look.label == ("table" if look.object_id == TABLE else "mug")
        assert look.score == 1.0 and look.mistake is None
        assert np.linalg.norm(look.feature) == pytest.approx(1, abs=1e-6)


def test_perfect_perception_sees_all_of_the_simulated_room_that_is_in_view() -> None:
    room = SimulatedRoom()
    things = [Thing(o.object_id, o.label, (o.color,), o.structural) for o in room.objects]
    for seen in coloured_frames(room, room.walk()[::40]):
        visible = [t.object_id for t in things if not t.structural and (seen.ids == t.object_id).sum() >= 20]
        assert [look.object_id for look in looks([seen], things, PERFECT)[0]] == visible


def test_structure_is_detected_only_where_asked_for(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    asked = ImperfectParams(structure=frozenset({"wall"}))
    assert looks(tabletop[:1], things, asked)[0][0].object_id == WALL


def test_fewer_pixels_than_the_least_are_never_detected(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    (found,) = looks(tabletop[:1], things, ImperfectParams(min_pixels=14 * 14 + 1))
    assert [look.object_id for look in found] == [TABLE]


def test_the_same_seed_gives_the_same_and_another_other_looks(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    first, again = (looks(tabletop[:5], things, NOISY, seed=3) for _ in range(2))
    assert all(same(a, b) for a, b in zip(first, again, strict=True))
    assert not all(same(a, b) for a, b in zip(first, looks(tabletop[:5], things, NOISY, seed=4), strict=True))


@settings(max_examples=8, deadline=None)
@given(order=st.permutations(list(range(5))))
def test_a_frame_s_looks_do_not_depend_on_the_frames_before(
    tabletop: list[SeenFrame], things: tuple[Thing, ...], order: list[int]
) -> None:
    in_order = looks(tabletop[:5], things, NOISY)
    shuffled = looks([tabletop[i] for i in order], things, NOISY)
    assert all(same(found, in_order[i]) for i, found in zip(order, shuffled, strict=True))


def test_one_kind_of_mistake_does_not_change_the_others(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    plain = looks(tabletop[:10], things, ImperfectParams(synonym=0.3, score=0.1))
    fewer = looks(
        tabletop[:10], things, ImperfectParams(synonym=0.3, score=0.1, missed=0.5, hallucinated=1.0)
    )
    for all_of_it, some in zip(plain, fewer, strict=True):
        by_id = {look.object_id: look for look in all_of_it}
        assert all(same([look], [by_id[look.object_id]]) for look in some if look.object_id)


def test_small_things_are_missed_at_their_level_and_large_ones_at_a_tenth(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    found = looks(tabletop, things, ImperfectParams(missed=0.5, small=0.1))  # a mug has 0.0026 of the image
    mugs = np.mean([sum(look.object_id != TABLE for look in frame) for frame in found]) / CUPS
    assert 1 - mugs == pytest.approx(0.5 * (0.1 + 0.9 * np.exp(-0.0255)), abs=0.09)
    found = looks(tabletop, things, ImperfectParams(missed=0.5, small=1e-4))
    mugs = np.mean([sum(look.object_id != TABLE for look in frame) for frame in found]) / CUPS
    assert 1 - mugs == pytest.approx(0.05, abs=0.02)


def test_a_split_thing_is_seen_in_part_beside_itself_or_in_its_place(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    kinds = set()
    for seed in range(12):
        for found in looks(tabletop[:8], things, ImperfectParams(split=1.0), seed):
            table = [look for look in found if look.object_id == TABLE]
            pieces = [look for look in table if look.mistake is Mistake.PART]
            whole = tabletop[0].ids == TABLE
            assert not any(
                (piece.mask & ~whole).any() or np.array_equal(piece.mask, whole) for piece in pieces
            )
            kinds.add((len(table) - len(pieces), len(pieces) > 0))
    assert kinds >= {(1, False), (1, True), (0, True)}


def test_small_things_are_not_split(tabletop: list[SeenFrame], things: tuple[Thing, ...]) -> None:
    (found,) = looks(tabletop[:1], things, ImperfectParams(split=1.0))
    assert all(look.mistake is None for look in found if look.object_id != TABLE)


def test_a_mug_s_mask_may_hold_the_table_under_it(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    found = [
        look for frame in looks(tabletop, things, ImperfectParams(swallows_carrier=0.2)) for look in frame
    ]
    ids, mugs = tabletop[0].ids, [look for look in found if look.object_id >= FIRST_CUP]
    wrong = [look for look in mugs if look.mistake is Mistake.SWALLOWS_CARRIER]
    assert len(wrong) / len(mugs) == pytest.approx(0.2, abs=0.05)
    for look in wrong:
        assert look.label == "mug"
        assert set(np.unique(ids[look.mask])) == {look.object_id, TABLE}
        assert look.mask[ids == look.object_id].all()


def test_a_table_s_mask_may_hold_the_mugs_on_it_which_are_seen_too(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    ids, wrong = tabletop[0].ids, 0
    for seed in range(5):
        for found in looks(tabletop[:20], things, ImperfectParams(swallows_things=0.5), seed):
            assert len(found) == 1 + CUPS
            if found[0].mistake is Mistake.SWALLOWS_THINGS:
                wrong += 1
                inside = set(np.unique(ids[found[0].mask]).tolist())
                assert TABLE in inside and WALL not in inside
                assert 0.5 * CUPS < len(inside) - 1 <= CUPS
    assert 20 < wrong < 80


def test_only_what_the_image_cuts_is_truncated_further(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    params = ImperfectParams(truncated=0.5, structure=frozenset({"wall"}))
    found = [
        look for seed in range(6) for frame in looks(tabletop[:20], things, params, seed) for look in frame
    ]
    cut = [look for look in found if look.mistake is Mistake.TRUNCATED]
    assert 0 < len(cut) < 120 and all(look.object_id == WALL for look in cut)
    assert all(look.mask.sum() < 0.8 * (tabletop[0].ids == WALL).sum() for look in cut)


def test_borders_are_off_by_the_pixels_of_their_level(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    found = looks(tabletop, things, ImperfectParams(border=4.0))  # two pixels at this width
    widths = [look.box2.x1 - look.box2.x0 for frame in found for look in frame if look.object_id >= FIRST_CUP]
    assert np.std((np.array(widths) - 14) / 2) == pytest.approx(2.0, abs=0.2)
    assert np.mean(widths) == pytest.approx(14, abs=0.3)


def test_hallucinations_are_sporadic(tabletop: list[SeenFrame], things: tuple[Thing, ...]) -> None:
    found = [
        look
        for seed in range(5)
        for frame in looks(tabletop, things, ImperfectParams(hallucinated=0.3), seed)
        for look in frame
        if look.object_id == 0
    ]
    assert len(found) / (5 * len(tabletop)) == pytest.approx(0.3, abs=0.08)
    assert {look.label for look in found} <= {*kin_words(), *ODD_TAGS}
    assert all(look.mistake is Mistake.HALLUCINATED and look.mask.any() for look in found)
    centres = np.array([[look.box2.x0, look.box2.y0] for look in found])
    assert len(np.unique(centres.round(), axis=0)) > 0.95 * len(found)  # nowhere twice


def test_scores_scatter_and_small_things_score_less(
    tabletop: list[SeenFrame], things: tuple[Thing, ...]
) -> None:
    found = looks(tabletop, things, ImperfectParams(score=0.08, small=0.01))
    table = [look.score for frame in found for look in frame if look.object_id == TABLE]
    mugs = [look.score for frame in found for look in frame if look.object_id != TABLE]
    assert np.mean(table) == pytest.approx(1 - 2 * 0.08, abs=0.03)
    assert np.mean(mugs) < np.mean(table) - 0.08
    assert np.std(table) == pytest.approx(0.08, abs=0.02)
    assert min(mugs) >= 0.05 and max(table) <= 1


def test_the_mug_s_feature_moves_towards_the_table_where_its_mask_swallows_it() -> None:
    """The encoder sees what the mask and its crop hold."""
    ids = np.full((120, 160), 2, np.uint16)
    ids[50:70, 70:90] = 10
    seen_alone = SeenFrame(0, 0, CAMERA, np.eye(4), None, np.full((120, 160), 2.0, np.float32), ids)
    truth = truth_of([Thing(2, "table"), Thing(10, "mug")])
    model = FeatureModel(("mug", "table"))
    table = model.text(["table"])[0]
    exact, patched = [], []
    for seed in range(40):
        exact.append(imperfect_looks(seen_alone, truth, model, PERFECT, seed)[1].feature @ table)
        wrong = imperfect_looks(seen_alone, truth, model, ImperfectParams(swallows_carrier=1.0), seed)[1]
        if wrong.mistake is Mistake.SWALLOWS_CARRIER:
            patched.append(wrong.feature @ table)
    assert np.mean(patched) > np.mean(exact) + 0.005
