"""A map over time: what is carried away is given up, what turns up elsewhere is known again, what is hidden stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ovip.scene.types import F32, DetectionBatch, Presence, RelationKind
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.domain.upkeep import UpkeepParams
from tests.builders import SECOND, axis, batch, block, camera, detection, leaning, pose

SEEN_ONCE = MapParams(upkeep=UpkeepParams(confirm_frames=1))
K = camera(160, 120, 120.0)
THROUGH = SEEN_ONCE.presence.through_frames
WALL, NOTHING, CURTAIN = 3.0, 0.0, 1.0
HERE = ((2.0, -0.15, 0.85), (2.2, 0.15, 1.15))
THERE = ((2.0, 0.45, 0.85), (2.2, 0.75, 1.15))


def _frame(number: int, depth: float, *seen: tuple[str, object, F32]) -> DetectionBatch:
    """A look along +x from 1 m above the floor; `depth` metres is what was measured everywhere."""
    found = [
        detection(label, points=block(*place, 0.02), feature=feature)  # type: ignore[misc]
        for label, place, feature in seen
    ]
    nearest = np.full((30, 40), depth, np.float32)
    return replace(batch(number, *found, k=K), nearest=nearest, world_from_camera=pose(z=1.0))


BOX = ("box", HERE, axis(0))


def _map_with_a_box(frames: int = 3) -> ObjectMap:
    made = ObjectMap(SEEN_ONCE)
    for n in range(1, frames + 1):
        made.integrate(_frame(n, 2.0, BOX))
    made.upkeep()
    return made


def test_a_thing_carried_away_is_given_up_after_so_many_views_that_see_through_it() -> None:
    made = _map_with_a_box()

    departed = [made.integrate(_frame(10 + n, WALL)).departed for n in range(THROUGH)]

    assert departed == [()] * (THROUGH - 1) + [("o000001",)]
    assert made.objects() == ()
    (gone,) = made.objects(include_departed=True)
    assert gone.presence is Presence.MOVED_OR_REMOVED
    assert gone.revision == made.version
    assert made.find("o000001") == gone


@pytest.mark.parametrize("depth", [NOTHING, CURTAIN, 2.0])
def test_what_is_hidden_unmeasured_or_still_there_is_never_given_up(depth: float) -> None:
    made = _map_with_a_box()
    for n in range(10, 60):
        assert made.integrate(_frame(n, depth)).departed == ()

    assert len(made.objects()) == 1


def test_one_look_at_the_thing_itself_starts_the_count_anew() -> None:
    made = _map_with_a_box()
    for n in range(10, 60):
        seen = [BOX] if n % THROUGH == 0 else []
        made.integrate(_frame(n, WALL, *seen))

    assert len(made.objects()) == 1


def test_a_pinned_thing_is_not_given_up() -> None:
    made = _map_with_a_box()
    next(iter(made.table)).pinned = True
    for n in range(10, 20):
        made.integrate(_frame(n, WALL))

    assert len(made.objects()) == 1


def test_a_thing_put_back_is_there_again_under_its_id() -> None:
    made = _map_with_a_box()
    for n in range(10, 20):
        made.integrate(_frame(n, WALL))

    delta = made.integrate(_frame(20, 2.0, BOX))

    assert delta.returned == delta.updated == ("o000001",)
    assert [o.object_id for o in made.objects()] == ["o000001"]


def _moved(feature: F32, label: str = "box", gone_first: bool = True) -> ObjectMap:
    """The box goes; something turns up half a metre beside, before or after the old place was seen empty."""
    made = _map_with_a_box()
    looks = [_frame(20 + n, WALL) for n in range(THROUGH)]
    for look in looks:
        look.nearest[:, :15] = NOTHING  # the new place is not in sight
    finds = [_frame(30 + n, NOTHING, (label, THERE, feature)) for n in range(4)]
    for n, one in enumerate([*looks, *finds] if gone_first else [*finds, *looks], 20):
        made.integrate(replace(one, frame_id=f"r.s.{n:08d}", timestamp_ns=n * SECOND))
    made.upkeep()
    return made


@pytest.mark.parametrize("gone_first", [True, False])
def test_a_thing_put_elsewhere_goes_on_there_under_its_id_with_where_it_was(gone_first: bool) -> None:
    made = _moved(leaning(0, 1, 0.99), gone_first=gone_first)

    (box,) = made.objects(include_departed=True)
    assert box.object_id == "o000001"
    assert box.centroid[1] == pytest.approx(0.6, abs=0.02)
    assert [move.origin[1] for move in box.moves] == [pytest.approx(0.0, abs=0.02)]
    assert box.observations == 7
    assert made.resolve("o000002") == "o000001"


@pytest.mark.parametrize(("feature", "label"), [(leaning(0, 1, 0.8), "box"), (axis(0), "bag")])
def test_what_looks_or_is_called_otherwise_is_another_thing(feature: F32, label: str) -> None:
    made = _moved(feature, label)

    assert [o.object_id for o in made.objects()] == ["o000002"]
    assert len(made.objects(include_departed=True)) == 2


def test_a_frame_without_depth_says_nothing() -> None:
    made = _map_with_a_box()
    before = made.state_hash()
    for n in range(10, 20):
        made.integrate(batch(n, k=K))

    assert made.objects()[0].version == 3
    assert made.state_hash() != before  # frames were counted


# Relations


def _table_and_cup(cup_x: float = 0.5) -> DetectionBatch:
    table = np.concatenate(
        [block((0, 0, 0.7), (1.2, 0.8, 0.7), 0.02), block((0.02, 0.02, 0), (0.06, 0.06, 0.7), 0.02)]
    )
    cup = block((cup_x, 0.3, 0.72), (cup_x + 0.1, 0.4, 0.82), 0.02)
    return batch(
        1,
        detection("table", points=table.astype(np.float32), feature=axis(0)),
        detection("cup", points=cup, feature=axis(1)),
    )


def test_upkeep_relates_what_changed_with_the_evidence() -> None:
    made = ObjectMap(SEEN_ONCE)
    made.integrate(_table_and_cup())
    assert made.objects()[1].relations == ()

    delta = made.upkeep()

    (relation,) = made.objects()[1].relations
    assert (relation.kind, relation.other_id) == (RelationKind.ON, "o000001")
    assert relation.evidence["gap"] == pytest.approx(0.02, abs=0.02)
    assert "o000002" in delta.updated


def test_a_relation_goes_when_the_other_thing_does() -> None:
    made = ObjectMap(SEEN_ONCE)
    made.integrate(_table_and_cup())
    made.upkeep()
    table, _ = made.table
    table.presence = Presence.MOVED_OR_REMOVED
    made.table.unsettle(table)

    delta = made.upkeep()

    assert made.find("o000002").relations == ()  # type: ignore[union-attr]
    assert "o000002" in delta.updated


def test_upkeep_measures_nothing_anew_where_nothing_changed() -> None:
    made = ObjectMap(SEEN_ONCE)
    made.integrate(_table_and_cup())
    made.upkeep()
    version = made.objects()[1].version

    made.integrate(batch(2))
    made.upkeep()

    assert made.objects()[1].version == version
