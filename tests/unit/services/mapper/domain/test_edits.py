"""Operators' edits: refused in words before anything changes, and kept by all that comes later."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.errors import Conflict, InvalidInput, NotFound
from ovip.scene.edits import Delete, Edit, EditRequest, Merge, Pin, Rename, Split
from ovip.scene.types import Detection, MapDelta, Presence, StepKind
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.domain.upkeep import UpkeepParams
from tests.builders import axis, batch, detection, leaning, random_run

CUP = detection("cup")
LAMP = detection("lamp", (2, 0, 0), (2.2, 0.2, 0.2), feature=axis(1))
BOOK = detection("book", (0, 2, 0), (0.2, 2.2, 0.2), feature=axis(2))


def _seen(*detections: Detection, frames: int = 4, after: ObjectMap | None = None) -> ObjectMap:
    """A map that saw the same things in so many more frames, with upkeep at the end."""
    made = after or ObjectMap()
    for _ in range(frames):
        made.integrate(batch(made.frames + 1, *detections))
    made.upkeep()
    return made


def _edit(made: ObjectMap, edit: Edit, made_on: int | None = None) -> MapDelta:
    made_on = made.version if made_on is None else made_on
    return made.edit(EditRequest(f"e{made.version}", made_on, "ann", edit))


def _shown(made: ObjectMap) -> list[tuple[str, str]]:
    return [(o.object_id, o.label) for o in made.objects()]


# What is refused


@pytest.mark.parametrize("made_on", [0, -3, 6])
def test_an_edit_on_a_version_that_is_none_of_the_maps_is_refused(made_on: int) -> None:
    made = _seen(CUP)

    with pytest.raises(InvalidInput, match="1 to 5"):
        _edit(made, Rename("o000001", "mug"), made_on)


@pytest.mark.parametrize("name", ["o000002", "cup", "o1", "o-00001", "", "o" + "9" * 500, "o00000١"])
def test_an_id_that_the_map_never_gave_is_not_found(name: str) -> None:
    with pytest.raises(NotFound):
        _edit(_seen(CUP), Delete(name))


def test_an_edit_made_before_the_object_became_another_is_a_conflict() -> None:
    made = _seen(CUP)
    seen = made.version
    _edit(made, Rename("o000001", "mug"))

    with pytest.raises(Conflict, match="o000001 was changed at version 6"):
        _edit(made, Rename("o000001", "glass"), seen)


def test_seeing_the_object_again_is_no_conflict() -> None:
    made = _seen(CUP)
    seen = made.version
    _seen(CUP, after=made)

    assert _edit(made, Rename("o000001", "mug"), seen).updated == ("o000001",)


def test_an_edit_of_what_was_merged_since_says_into_what() -> None:
    made = _seen(CUP, LAMP)
    seen = made.version
    _edit(made, Merge("o000001", ("o000002",)))

    with pytest.raises(Conflict, match="o000002 was merged into o000001"):
        _edit(made, Rename("o000002", "light"), seen)


def test_an_alias_that_the_operator_could_have_known_means_its_survivor() -> None:
    made = _seen(CUP, LAMP)
    _edit(made, Merge("o000001", ("o000002",)))

    _edit(made, Rename("o000002", "light"))

    assert _shown(made) == [("o000001", "light")]


def test_an_edit_of_what_was_given_up_as_noise_is_a_conflict() -> None:
    made = ObjectMap(MapParams(upkeep=UpkeepParams(forget_after=2)))
    made.integrate(batch(1, CUP, LAMP))
    for number in range(2, 6):
        made.integrate(batch(number, CUP))
    made.upkeep()

    with pytest.raises(Conflict, match="o000002 was given up as noise"):
        _edit(made, Rename("o000002", "light"), 1)


def test_an_edit_of_what_an_operator_deleted_says_so_and_when() -> None:
    made = _seen(CUP)
    seen = made.version
    _edit(made, Delete("o000001"))

    with pytest.raises(Conflict, match="deleted by an operator at version 6"):
        _edit(made, Rename("o000001", "mug"), seen)
    with pytest.raises(NotFound, match="deleted by an operator at version 6"):
        _edit(made, Rename("o000001", "mug"))


@pytest.mark.parametrize(
    ("edit", "error", "says"),
    [
        (Rename("o000001", "!!"), InvalidInput, "expected a word"),
        (Rename("o000001", "cup " * 200), InvalidInput, "200 characters"),
        (Merge("o000001", ()), InvalidInput, "at least one"),
        (Merge("o000001", ("o000002", "o000001")), InvalidInput, "with itself"),
        (Merge("o000001", ("o000002", "o000009")), NotFound, "o000009"),
        (Split("o000001", np.array([5.0, 5, 5, 6, 6, 6])), InvalidInput, "holds none"),
        (Split("o000001", np.array([-1.0, -1, -1, 6, 6, 6])), InvalidInput, "holds all"),
        (Split("o000001", np.array([0.1, 0, 0, 0.0, 1, 1])), InvalidInput, "low corner below"),
        (Split("o000001", np.array([0.0, 0, 0, math.nan, 1, 1])), InvalidInput, "finite"),
        (Split("o000001", np.zeros(4)), InvalidInput, "six"),
    ],
)
def test_what_cannot_be_is_refused_and_changes_nothing(edit: Edit, error: type[Exception], says: str) -> None:
    made = _seen(CUP, LAMP)
    before, version = made.state_hash(), made.version

    with pytest.raises(error, match=says):
        _edit(made, edit)

    assert (made.state_hash(), made.version) == (before, version)


# Rename


def test_a_given_label_is_shown_and_detections_go_on_joining_by_what_they_say() -> None:
    made = _seen(CUP)

    delta = _edit(made, Rename("o000001", " Favourite_Mugs "))
    _seen(CUP, after=made)

    (cup,) = made.objects()
    assert (delta.kind, delta.updated, delta.version) == (StepKind.EDIT, ("o000001",), 6)
    assert (cup.label, cup.label_given, cup.label_counts) == ("favourite mug", True, {"cup": 8})
    assert cup.revision == 6


def test_an_empty_label_lets_the_majority_decide_again() -> None:
    made = _seen(CUP)
    _edit(made, Rename("o000001", "mug"))

    _edit(made, Rename("o000001", ""))

    (cup,) = made.objects()
    assert (cup.label, cup.label_given) == ("cup", False)


def test_two_things_that_an_operator_named_differently_are_never_merged() -> None:
    """Two fragments of a chair that upkeep would make one."""
    seat, back = _chair()
    made, unnamed = (ObjectMap(MapParams(upkeep=UpkeepParams(eager=False))) for _ in range(2))
    for each in (made, unnamed):
        for number in range(1, 4):
            each.integrate(batch(number, seat, back))
    _edit(made, Rename("o000001", "left chair"))
    _edit(made, Rename("o000002", "right chair"))

    made.upkeep()
    unnamed.upkeep()

    assert _shown(made) == [("o000001", "left chair"), ("o000002", "right chair")]
    assert _shown(unnamed) == [("o000001", "chair")]


# Merge


def test_merged_objects_add_and_their_ids_lead_to_the_one_that_stays() -> None:
    made = _seen(CUP, LAMP, BOOK)
    before = {o.object_id: o for o in made.objects()}

    delta = _edit(made, Merge("o000002", ("o000001", "o000003", "o000001")))

    (lamp,) = made.objects()
    assert delta.aliases == {"o000001": "o000002", "o000003": "o000002"}
    assert (delta.updated, delta.removed) == (("o000002",), ())
    assert lamp.label_counts == {"lamp": 4, "cup": 4, "book": 4}
    assert lamp.observations == 12
    assert lamp.frames == 4  # the same four saw all three
    assert lamp.voxels == sum(o.voxels for o in before.values())
    assert lamp.view_weight == pytest.approx(sum(o.view_weight for o in before.values()))
    assert made.find("o000003") == lamp


def test_a_pinned_object_is_not_merged_away_by_a_slip() -> None:
    made = _seen(CUP, LAMP)
    _edit(made, Pin("o000002"))

    with pytest.raises(Conflict, match="pinned"):
        _edit(made, Merge("o000001", ("o000002",)))

    _edit(made, Merge("o000002", ("o000001",)))
    assert [o.object_id for o in made.objects()] == ["o000002"]


def test_merging_what_was_split_takes_the_split_back() -> None:
    made = _seen(_table_and_cup(), frames=5)
    _edit(made, Split("o000001", CUP_PLACE, "cup"))

    _edit(made, Merge("o000001", ("o000002",)))
    _seen(_table_and_cup(), after=made, frames=12)

    assert len(made.objects()) == 1


# Split

CUP_PLACE = np.array([0.35, 0.35, 0.82, 0.65, 0.65, 1.2])


def _table_and_cup() -> Detection:
    """One mask that covers a table and the cup on it."""
    table, cup = detection("table", (0, 0, 0.6), (1, 1, 0.8)), _cup_on_it()
    return detection("table", points=np.concatenate([table.points, cup.points]))


def _cup_on_it() -> Detection:
    return detection("cup", (0.4, 0.4, 0.85), (0.6, 0.6, 1.0), feature=leaning(0, 1, 0.97))


def test_a_split_off_part_is_a_thing_of_its_own_and_the_sums_are_shared() -> None:
    made = _seen(_table_and_cup(), frames=5)
    (whole,) = made.objects()

    delta = _edit(made, Split("o000001", CUP_PLACE, "Cups"))

    table, cup = made.objects()
    share = cup.voxels / whole.voxels
    assert (delta.created, delta.updated) == (("o000002",), ("o000001",))
    assert (table.label, cup.label, cup.label_given) == ("table", "cup", True)
    assert table.voxels + cup.voxels == whole.voxels
    assert cup.box[:3] == pytest.approx([0.4, 0.4, 0.85], abs=0.01)
    assert table.box[5] < 0.82
    assert cup.view_weight == pytest.approx(share * whole.view_weight)
    assert table.view_weight + cup.view_weight == pytest.approx(whole.view_weight)
    assert (cup.observations, table.observations) == (1, 5)  # shares of five, at least one
    assert np.allclose(cup.feature, whole.feature)
    assert (cup.frames, table.frames) == (5, 5)


def test_a_part_without_a_name_is_called_as_the_whole() -> None:
    made = _seen(_table_and_cup(), frames=5)
    _edit(made, Rename("o000001", "desk"))

    _edit(made, Split("o000001", CUP_PLACE))

    assert _shown(made) == [("o000001", "desk"), ("o000002", "desk")]


def test_what_was_split_stays_two_though_the_detector_goes_on_taking_it_for_one() -> None:
    made = _seen(_table_and_cup(), frames=5)
    _edit(made, Split("o000001", CUP_PLACE))
    cup = made.objects()[1].box

    _seen(_table_and_cup(), after=made, frames=15)

    table, still = made.objects()
    assert np.allclose(still.box, cup)
    assert table.box[5] < 0.82
    assert table.observations == 20


def test_parts_are_kept_apart_through_later_merges() -> None:
    """The cup becomes one with a mug; the mug is then kept from the table, too."""
    made = _seen(_table_and_cup(), LAMP, frames=5)
    _edit(made, Split("o000001", CUP_PLACE))
    _edit(made, Merge("o000002", ("o000003",)))
    assert _apart(made, "o000001") == {"o000002"}

    _edit(made, Pin("o000002"))
    _edit(made, Split("o000002", np.array([1.9, -1, -1, 3, 1, 1])))

    assert _apart(made, "o000001") == {"o000002", "o000004"}
    assert _apart(made, "o000002") == {"o000001", "o000004"}
    assert _apart(made, "o000004") == {"o000001", "o000002"}
    _edit(made, Merge("o000004", ("o000001",)))
    assert _apart(made, "o000002") == {"o000004"}


def _apart(made: ObjectMap, object_id: str) -> frozenset[str]:
    record = made.table.get(object_id)
    assert record is not None
    return record.apart


# Delete


def test_what_is_deleted_is_never_shown_again_though_it_is_detected_again() -> None:
    made = _seen(CUP, LAMP)

    delta = _edit(made, Delete("o000001"))
    later = [made.integrate(batch(20 + n, CUP, LAMP)) for n in range(15)]
    later.append(made.upkeep())

    assert delta.removed == ("o000001",)
    assert _shown(made) == [("o000002", "lamp")]
    assert made.objects(include_unconfirmed=True, include_departed=True) == made.objects()
    assert made.find("o000001") is None
    assert made.cloud_of("o000001") is None
    assert made.deleted_at("o000001") == delta.version
    assert all("o000001" not in (*d.created, *d.updated, *d.returned) for d in later)


def test_a_fragment_of_a_deleted_thing_that_turns_up_later_is_swallowed_too() -> None:
    seat, back = _chair()
    made = _seen(seat)
    _edit(made, Delete("o000001"))

    _seen(seat, back, after=made, frames=12)

    assert made.objects() == ()


def test_deleting_one_of_two_like_things_beside_each_other_leaves_the_other() -> None:
    """Two objects for one chair: upkeep may not let the deleted one swallow what the operator left."""
    seat, back = _chair()
    made = ObjectMap(MapParams(upkeep=UpkeepParams(eager=False)))
    for number in range(1, 4):
        made.integrate(batch(number, seat, back))
    assert len(made.objects()) == 2
    _edit(made, Delete("o000001"))

    _seen(seat, back, after=made, frames=12)

    assert [o.object_id for o in made.objects()] == ["o000002"]


def test_a_deleted_thing_stands_in_no_relation() -> None:
    made = _seen(CUP, detection("table", (-0.5, -0.5, -0.3), (0.5, 0.5, -0.01), feature=axis(1)))
    assert [r.other_id for r in made.objects()[0].relations] == ["o000002"]

    delta = _edit(made, Delete("o000002"))

    assert made.objects()[0].relations == ()
    assert delta.updated == ("o000001",)


def _chair() -> tuple[Detection, Detection]:
    """Two views of one thing that share a third of it and are too different in box to associate."""
    seat = detection("chair", (0, 0, 0), (0.3, 0.5, 0.5))
    back = detection("chair", (0.2, 0, 0), (0.9, 0.5, 0.5), feature=leaning(0, 1, 0.86))
    return seat, back


# Pin


def test_a_pinned_object_is_the_one_that_stays_when_upkeep_merges() -> None:
    seat, back = _chair()
    without, pinned = ObjectMap(), ObjectMap()
    for made in (without, pinned):
        for number in range(1, 6):
            made.integrate(batch(number, seat))
        made.integrate(batch(6, LAMP))
    _edit(without, Rename("o000002", ""))
    pinned.integrate(batch(7, LAMP))
    for made in (without, pinned):
        made.params = MapParams(upkeep=UpkeepParams(eager=False))
        made.integrate(batch(8, back))
    _edit(pinned, Pin("o000003"))

    without.upkeep()
    pinned.upkeep()

    assert without.aliases == {"o000003": "o000001"}
    assert pinned.aliases == {"o000001": "o000003"}


def test_two_pinned_objects_never_merge() -> None:
    seat, back = _chair()
    made = ObjectMap(MapParams(upkeep=UpkeepParams(eager=False)))
    made.integrate(batch(1, seat, back))
    _edit(made, Pin("o000001"))
    _edit(made, Pin("o000002"))

    _seen(seat, back, after=made, frames=5)

    assert [o.object_id for o in made.objects()] == ["o000001", "o000002"]


def test_a_pinned_object_is_shown_and_never_forgotten_and_unpinned_it_is_noise_again() -> None:
    made = ObjectMap(MapParams(upkeep=UpkeepParams(forget_after=5)))
    made.integrate(batch(1, LAMP))
    _edit(made, Pin("o000001"))
    _seen(CUP, after=made, frames=20)
    assert [o.label for o in made.objects()] == ["lamp", "cup"]

    _edit(made, Pin("o000001", pinned=False))
    made.upkeep()

    assert [o.label for o in made.objects()] == ["cup"]


def test_pinning_what_was_given_up_says_that_it_is_there() -> None:
    made = _seen(CUP)
    record = made.table.get("o000001")
    assert record is not None
    record.presence = Presence.MOVED_OR_REMOVED
    assert made.objects() == ()

    delta = _edit(made, Pin("o000001"))

    assert delta.returned == ("o000001",)
    assert [o.presence for o in made.objects()] == [Presence.PRESENT]


# All edits


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.lists(st.integers(0, 4), min_size=1, max_size=6))
def test_edits_amid_perception_replay_bit_for_bit_and_survive_snapshots(seed: int, kinds: list[int]) -> None:
    run = random_run(seed, 6 * len(kinds) + 6)
    made, replayed, resumed = ObjectMap(), ObjectMap(), ObjectMap()
    for at, one in enumerate(run):
        request = _some_edit(made, kinds[at // 6 - 1], at) if at % 6 == 0 and at else None
        maps = (made, replayed, resumed)
        outcomes = [_outcome(each, request) for each in maps]
        assert outcomes[0] == outcomes[1] == outcomes[2]
        for each in maps:
            each.integrate(one)
            if each.upkeep_due:
                each.upkeep()
        resumed = ObjectMap.restore([resumed.segment()])
    assert made.state_hash() == replayed.state_hash() == resumed.state_hash()


def _some_edit(made: ObjectMap, kind: int, at: int) -> EditRequest | None:
    names: Sequence[str] = [o.object_id for o in made.objects(include_unconfirmed=True)]
    if not names:
        return None
    one, other = names[at % len(names)], names[(at // 6) % len(names)]
    found = made.find(one)
    assert found is not None
    half = np.array([*found.box[:3] - 1, *found.centroid])
    edits: list[Edit] = [Rename(one, "thing"), Merge(one, (other,)), Split(one, half), Delete(one), Pin(one)]
    return EditRequest(f"e{at}", made.version, "ann", edits[kind])


def _outcome(made: ObjectMap, request: EditRequest | None) -> MapDelta | str:
    if request is None:
        return ""
    try:
        return made.edit(request)
    except (Conflict, InvalidInput) as error:
        return str(error)
