"""The change protocol on a corner of the small room: what it counts, and that the mapper notices."""

from __future__ import annotations

from dataclasses import replace

import pytest

from lab.evaluation.experiment import Row
from lab.evaluation.experiments.change import _pooled, _shares, owners_of, score
from lab.evaluation.mapping.stages import Shown, Stage, room_stage, walked
from lab.simulation.imperfect import PERFECT
from services.mapper.domain.object_map import map_of
from services.mapper.domain.params import MapParams
from services.mapper.domain.presence import PresenceParams


@pytest.fixture(scope="module")
def stage() -> Stage:
    """Views of the table and of the counter, with a depth camera's noise and drift, and a perfect detector."""
    whole = room_stage(1)
    return replace(whole, poses=[*whole.poses[34:50], *whole.poses[88::3]], imperfect=PERFECT)


@pytest.fixture(scope="module")
def rows(stage: Stage) -> tuple[Row, Row]:
    static, changed = score(stage)
    return static, changed


def test_a_static_room_loses_nothing(rows: tuple[Row, Row]) -> None:
    static, _ = rows

    assert static["objects"] >= 8
    assert static["_removed"] == static["_for_a_while"] == static["wrong_moves"] == 0


def test_things_carried_off_a_table_are_noticed_within_few_views_and_the_others_stay(
    rows: tuple[Row, Row],
) -> None:
    _, changed = rows

    assert changed["could_notice"] >= 3
    assert changed["_noticed"] == changed["could_notice"]
    assert min(changed["_views"]) >= PresenceParams().through_frames
    assert changed["_lost"] == 0


def test_a_mug_put_onto_the_counter_keeps_its_id_there(rows: tuple[Row, Row]) -> None:
    _, changed = rows

    assert (changed["moves"], changed["_same"], changed["wrong_moves"]) == (1, 1, 0)


def test_a_mapper_that_gives_nothing_up_notices_nothing(stage: Stage) -> None:
    never = PresenceParams(departed_share=float("inf"), small_share=float("inf"))
    short = replace(stage, poses=stage.poses[-6:])

    _, changed = score(short, MapParams(presence=never))

    assert changed["could_notice"] >= 1
    assert changed["_noticed"] == changed["_same"] == 0


def test_a_walk_shows_what_it_saw_and_what_it_looked_past(stage: Stage) -> None:
    short = replace(stage, poses=stage.poses[-4:])
    _, first = walked(short, short.before, 0)
    batches, second = walked(short, short.after, 1, first)
    laptop = next(thing for thing in stage.things if thing.label == "laptop")

    assert [batch.frame_id for batch in batches] == ["000004", "000005", "000006", "000007"]
    assert first.views[laptop.object_id] == [0, 1, 2, 3]
    assert laptop.object_id not in second.views
    assert set(second.past[laptop.object_id]) <= {4, 5, 6, 7} and len(second.past[laptop.object_id]) >= 2
    assert not first.past


def test_owners_are_the_things_that_most_points_lie_on(stage: Stage) -> None:
    short = replace(stage, poses=stage.poses[-5:])
    batches, shown = walked(short, short.before, 0)
    base = map_of(batches)
    labels = {thing.object_id: thing.label for thing in stage.things}

    owners = owners_of(base, shown)

    assert owners and all(labels[owner] == base.find(o).label for o, owner in owners.items() if owner)  # type: ignore[union-attr]
    assert set(owners_of(base, Shown()).values()) == {0}


def test_shares_by_hand() -> None:
    static = {"config": "static", "objects": 10, "wrong_moves": 0, "_removed": 1, "_for_a_while": 2}
    static |= {"_objects_of_things": 8, "_removed_of_things": 0, "scene": "a"}
    rows: list[Row] = [static, {**static, "objects": 30, "_removed": 0, "scene": "b"}]

    pooled = _shares(_pooled(rows))

    assert pooled["objects"] == 40
    assert pooled["false_removals"] == pytest.approx(1 / 40)
    assert pooled["for_a_while"] == pytest.approx(4 / 40)
    assert pooled["strict"] == {"false_removals": 0.0}
    assert "scene" not in pooled and not any(column.startswith("_") for column in pooled)


def test_views_pool_before_their_median_and_nothing_to_notice_is_no_share() -> None:
    none = {"config": "changed", "could_notice": 0, "moves": 0, "_noticed": 0, "_could_notice_thick": 0}
    none |= {"_noticed_thick": 0, "_same": 0, "_stayed": 5, "_lost": 0, "_views": []}

    pooled = _shares(_pooled([{**none, "_views": [3, 9]}, {**none, "_views": [4]}]))

    assert (pooled["views"], pooled["most_views"]) == (4.0, 9)
    assert pooled["noticed"] is None and pooled["same"] is None
    assert pooled["others_lost"] == 0.0
    assert _shares(none)["views"] is None
