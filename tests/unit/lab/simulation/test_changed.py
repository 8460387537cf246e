"""Changed places: what went is gone, what moved is where it was put, and nothing else is touched."""

from __future__ import annotations

import numpy as np
import pytest

from lab.simulation.changed import Change, ChangedRoom, ChangeParams, changed_home, loose_things, some_change
from lab.simulation.home import Relation, RelationKind
from lab.simulation.room import SimulatedRoom
from ovip.scene.boxes import box_of
from ovip.scene.types import F64
from tests.unit.lab.simulation.box_homes import BED, MUG, TABLE, box_home

HOME = box_home()
SIZES = ChangeParams(removed=0, moved=1)


def vertices_of(object_id: int, change: Change) -> F64:
    mesh = changed_home(HOME, change).mesh
    corners = mesh.vertices[mesh.triangles[mesh.object_ids == object_id]]
    return np.asarray(corners.reshape(-1, 3), np.float64)


class TestHome:
    def test_what_was_carried_away_leaves_no_face_no_object_and_no_relation(self) -> None:
        after = changed_home(HOME, Change(frozenset([MUG])))

        assert MUG not in after.mesh.object_ids
        assert MUG not in {thing.object_id for thing in after.objects}
        assert all(MUG not in (r.subject, r.object) for r in after.relations)
        assert len(after.mesh.triangles) == len(HOME.mesh.triangles) - 12

    def test_what_moved_keeps_its_shape_and_has_its_box_and_area_where_it_is(self) -> None:
        """From the table at (2, 2.35, 0.75) to the bed at (9, 0.5, 0.5)."""
        after = changed_home(HOME, Change(moved={MUG: np.array([7.0, -1.85, -0.25])}))
        mug = after.object_with(MUG)

        assert mug.box == pytest.approx([8.95, 0.45, 0.5, 9.05, 0.55, 0.62])
        assert box_of(vertices_of(MUG, Change(moved={MUG: np.array([7.0, -1.85, -0.25])}))) == pytest.approx(
            mug.box, abs=1e-5
        )
        assert mug.area_id != HOME.object_with(MUG).area_id
        assert Relation(MUG, RelationKind.ON, TABLE) not in after.relations

    def test_nothing_else_is_touched(self) -> None:
        change = Change(frozenset([BED]), {MUG: np.array([0.2, 0.0, 0.0])})
        after = changed_home(HOME, change)

        assert after.object_with(TABLE) is HOME.object_with(TABLE)
        assert np.array_equal(vertices_of(TABLE, change), vertices_of(TABLE, Change()))
        for name in ("normals", "uv", "material_ids"):
            assert len(getattr(after.mesh, name)) == len(after.mesh.triangles)

    def test_no_change_changes_nothing(self) -> None:
        after = changed_home(HOME, Change())

        assert np.array_equal(after.mesh.triangles, HOME.mesh.triangles)
        assert after.objects == HOME.objects

    def test_loose_is_what_can_be_carried_and_carries_nothing(self) -> None:
        assert [thing.object_id for thing in loose_things(HOME, SIZES)] == [MUG]
        assert MUG not in [t.object_id for t in loose_things(HOME, ChangeParams(smallest=0.2))]

    def test_a_moved_thing_rests_on_another_s_face_at_a_height_for_hands_and_clear_of_all(self) -> None:
        for seed in range(8):
            change = some_change(HOME, seed, SIZES)
            box = changed_home(HOME, change).object_with(MUG).box

            on_table = bool((box[:2] >= [1.5, 2.0]).all() and (box[3:5] <= [2.5, 2.8]).all())
            assert set(change.moved) == {MUG} and not change.removed
            assert box[2] == pytest.approx(0.75 if on_table else 0.5)
            assert np.linalg.norm(change.moved[MUG]) >= SIZES.away

    def test_some_change_is_the_seed_s(self) -> None:
        first, again = some_change(HOME, 3, SIZES), some_change(HOME, 3, SIZES)

        assert np.array_equal(first.moved[MUG], again.moved[MUG])
        assert some_change(HOME, 3, ChangeParams(removed=1, moved=0)).removed == {MUG}

    def test_where_no_place_is_free_nothing_moves(self) -> None:
        assert not some_change(HOME, 0, ChangeParams(removed=0, moved=1, away=50.0)).moved


class TestRoom:
    room = SimulatedRoom(2)
    pose = room.walk()[40]

    def test_a_room_without_a_thing_shows_what_was_behind_it(self) -> None:
        _, depth, ids = self.room.render(self.pose)
        shown = int(np.bincount(ids[ids > 10].ravel()).argmax())
        changed = ChangedRoom(2, Change(frozenset([shown])))
        _, empty, left = changed.render(self.pose)

        assert shown not in left
        assert (empty[ids == shown] > depth[ids == shown] - 1e-4).all()
        assert np.array_equal(empty[ids != shown], depth[ids != shown])
        with pytest.raises(KeyError):
            changed.object_with(shown)

    def test_a_moved_thing_is_rendered_in_its_box(self) -> None:
        table = next(thing for thing in self.room.objects if thing.label == "table")
        changed = ChangedRoom(2, Change(moved={table.object_id: np.array([0.3, -0.2, 0.0])}))

        assert changed.object_with(table.object_id).box == pytest.approx(
            table.box + np.array([0.3, -0.2, 0, 0.3, -0.2, 0])
        )
        assert len(changed.objects) == len(self.room.objects)
        assert not changed.is_free(changed.object_with(table.object_id).box[:2] + 0.1)
