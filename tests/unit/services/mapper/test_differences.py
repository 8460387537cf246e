"""What differs between two versions of a map, object by object."""

from __future__ import annotations

import dataclasses

import numpy as np

from ovip.scene.types import Box2, MapObject, Move, Presence, Relation, RelationKind
from services.mapper.differences import changes_between, differing_fields
from tests.builders import axis


def thing(object_id: str = "o000001", **changes: object) -> MapObject:
    plain = MapObject(
        object_id=object_id,
        label="cup",
        label_counts={"cup": 3},
        centroid=np.zeros(3),
        box=np.array([0.0, 0, 0, 1, 1, 1]),
        feature=axis(0),
        view_weight=1.0,
        observations=3,
        frames=3,
        first_seen_ns=1,
        last_seen_ns=9,
        voxels=10,
        mean_color=np.zeros(3),
        best_frame_id="f",
        best_box2=Box2(0, 0, 1, 1),
        version=4,
    )
    return dataclasses.replace(plain, **changes)  # type: ignore[arg-type]


def itself(object_id: str) -> str:
    return object_id


def test_fields_that_differ_are_named_in_their_order() -> None:
    later = thing(
        label="mug",
        box=np.array([0.0, 0, 0, 1, 1, 2]),
        feature=axis(1),
        presence=Presence.MOVED_OR_REMOVED,
        pinned=True,
        relations=(Relation(RelationKind.ON, "o000002", {"gap": 0.01}),),
        moves=(Move(5, np.zeros(3)),),
    )

    assert differing_fields(thing(), later) == (
        "label",
        "box",
        "feature",
        "presence",
        "pinned",
        "relations",
        "moves",
    )


def test_evidence_and_origins_are_looked_into() -> None:
    on = Relation(RelationKind.ON, "o000002", {"gap": 0.01})
    before = thing(relations=(on,), moves=(Move(5, np.zeros(3)),))

    assert differing_fields(before, thing(relations=(on,), moves=(Move(5, np.zeros(3)),))) == ()
    moved = thing(relations=(on,), moves=(Move(5, np.ones(3)),))
    other = thing(relations=(dataclasses.replace(on, evidence={"gap": 0.02}),), moves=(Move(5, np.zeros(3)),))
    assert differing_fields(before, moved) == ("moves",)
    assert differing_fields(before, other) == ("relations",)


def test_an_object_that_changed_and_changed_back_is_the_same() -> None:
    assert changes_between([thing()], [thing(version=9)], itself) == ()


def test_objects_that_came_and_went_are_told_by_id() -> None:
    before, after = [thing("o000003"), thing("o000001")], [thing("o000001"), thing("o000002")]

    came, went = changes_between(before, after, itself)

    assert (came.object_id, came.before, came.fields) == ("o000002", None, ())
    assert (went.object_id, went.after, went.merged_into) == ("o000003", None, "")


def test_what_was_merged_is_told_with_its_survivor() -> None:
    (gone,) = changes_between([thing("o000003")], [], {"o000003": "o000001"}.__getitem__)

    assert gone.merged_into == "o000001"


def test_two_empty_maps_do_not_differ() -> None:
    assert changes_between([], [], itself) == ()
