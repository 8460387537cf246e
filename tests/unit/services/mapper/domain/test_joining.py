"""Joining two maps: sums add, what is one thing becomes one, and what operators said holds on."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from ovip.scene.edits import Delete, Edit, EditRequest, Merge, Pin, Rename, Split
from ovip.scene.types import F64, Detection, DetectionBatch, StepKind
from services.mapper.domain.association import AssociationParams
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.joining import moved_cloud, upright
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.domain.registration import turn
from services.mapper.domain.upkeep import UpkeepParams
from tests.builders import axis, batch, block, detection, leaning, random_run

STAY = np.eye(4)
NO_UPKEEP = MapParams(upkeep=UpkeepParams(eager=False, confirm_frames=1))
CUP = detection("cup")
LAMP = detection("lamp", (2, 0, 0), (2.2, 0.2, 0.2), feature=axis(1))


def _map_of(*batches: DetectionBatch, params: MapParams = NO_UPKEEP) -> ObjectMap:
    made = ObjectMap(params)
    for one in batches:
        made.integrate(one)
    return made


def _seen(*detections: Detection, first: int = 1, frames: int = 3) -> ObjectMap:
    return _map_of(*(batch(n, *detections) for n in range(first, first + frames)))


def _edit(made: ObjectMap, edit: Edit) -> None:
    made.edit(EditRequest("e", made.version, "ann", edit))


def _moved(detection: Detection, pose: F64) -> Detection:
    points = (detection.points @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)
    box = np.concatenate([points.min(axis=0), points.max(axis=0)]).astype(np.float64)
    return dataclasses.replace(detection, points=points, box=box)


# What becomes of the objects


def test_what_both_saw_is_one_object_and_the_rest_gets_new_ids() -> None:
    mine, other = _seen(CUP), _seen(LAMP, CUP, first=10)

    delta, ids = mine.join(other, STAY)

    assert ids == {"o000001": "o000002", "o000002": "o000001"}
    assert (delta.kind, delta.version) == (StepKind.JOIN, 4)
    assert (delta.created, delta.updated) == (("o000002",), ("o000001",))
    cup, lamp = mine.objects()
    assert (cup.label, cup.observations, cup.frames) == ("cup", 6, 6)
    assert (lamp.label, lamp.observations, lamp.frames) == ("lamp", 3, 3)
    assert (mine.frames, mine.detections) == (6, 9)


def test_a_map_seen_from_another_world_joins_where_it_belongs() -> None:
    pose = turn(2.0)
    pose[:3, 3] = 4.0, -7.0, 0.3
    there = np.asarray(np.linalg.inv(pose), np.float64)
    mine, other = _seen(CUP), _seen(_moved(LAMP, there), _moved(CUP, there), first=10)

    _, ids = mine.join(other, pose)

    assert ids == {"o000001": "o000002", "o000002": "o000001"}
    assert mine.objects()[1].box == pytest.approx(LAMP.box, abs=0.005)
    assert mine.objects()[0].box == pytest.approx(CUP.box, abs=0.005)


def test_pairs_are_one_to_one_and_the_best_come_first() -> None:
    """Two cups there overlap the one here: the nearer is it, the other is a thing of its own."""
    near, far = (
        detection("cup", (0.02, 0, 0), (0.22, 0.2, 0.2)),
        detection("cup", (0.08, 0, 0), (0.28, 0.2, 0.2)),
    )
    mine, other = _seen(CUP), ObjectMap(dataclasses.replace(NO_UPKEEP, association=_strict()))
    for number in range(10, 13):
        other.integrate(batch(number, far, near))
    assert len(other.objects()) == 2

    _, ids = mine.join(other, STAY)

    assert ids == {"o000001": "o000002", "o000002": "o000001"}


def _strict() -> AssociationParams:
    return dataclasses.replace(NO_UPKEEP.association, tau=1.7)


def test_aliases_of_the_other_map_lead_to_what_their_survivor_became() -> None:
    mine, other = _seen(CUP), _seen(LAMP, CUP)
    _edit(other, Merge("o000002", ("o000001",)))

    _, ids = mine.join(other, STAY)

    assert ids["o000001"] == ids["o000002"]
    assert mine.find(ids["o000001"]) is not None


def test_upkeep_is_due_after_a_long_map_joined() -> None:
    mine, other = _seen(CUP), _seen(CUP, first=10, frames=12)

    mine.join(other, STAY)

    assert mine.upkeep_due


# Refusals


@pytest.mark.parametrize(
    ("pose", "says"),
    [
        (np.eye(3), "4x4"),
        (np.full((4, 4), np.nan), "finite"),
        (np.diag([2.0, 2, 2, 1]), "rigid"),
        (np.diag([-1.0, 1, 1, 1]), "rigid"),
        (np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]), "tilts by 90.0 degrees"),
        (np.vstack([np.eye(4)[:3], [0, 0, 1, 1]]), "rigid"),
    ],
)
def test_a_transform_that_is_none_of_an_upright_world_is_refused(pose: F64, says: str) -> None:
    mine, other = _seen(CUP), _seen(LAMP)
    before = mine.state_hash()

    with pytest.raises(InvalidInput, match=says):
        mine.join(other, pose)

    assert (mine.state_hash(), mine.version) == (before, 3)


def test_a_slight_tilt_passes() -> None:
    tilt = np.eye(4)
    tilt[1:3, 1:3] = [[np.cos(0.02), -np.sin(0.02)], [np.sin(0.02), np.cos(0.02)]]

    assert np.array_equal(upright(tilt, "pose"), tilt)


def test_a_map_cannot_be_joined_with_itself() -> None:
    mine = _seen(CUP)

    with pytest.raises(InvalidInput, match="itself"):
        mine.join(mine, STAY)


def test_maps_of_different_features_are_refused() -> None:
    other = _map_of(batch(1, detection("cup", feature=axis(0, 5))))

    with pytest.raises(InvalidInput, match="8 numbers .* got 5"):
        _seen(CUP).join(other, STAY)


# Sums


def test_joining_an_empty_map_changes_nothing_but_the_version() -> None:
    mine = _seen(CUP, LAMP)
    before = mine.objects()

    delta, ids = mine.join(ObjectMap(), STAY)

    assert (delta.version, delta.created, delta.updated, ids) == (4, (), (), {})
    assert mine.objects() == before
    assert (mine.frames, mine.detections) == (3, 6)


def test_an_empty_map_takes_all_of_the_other() -> None:
    other = _seen(CUP, LAMP)

    mine = ObjectMap(NO_UPKEEP)
    _, ids = mine.join(other, STAY)

    assert ids == {"o000001": "o000001", "o000002": "o000002"}
    assert [(o.label, o.frames, o.voxels) for o in mine.objects()] == [
        (o.label, o.frames, o.voxels) for o in other.objects()
    ]


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 12))
def test_two_maps_of_one_run_join_to_the_sums_of_the_map_of_all_of_it(seed: int, cut: int) -> None:
    run = random_run(seed, 12)
    whole, mine, other = (_map_of(*part) for part in (run, run[:cut], run[cut:]))

    mine.join(other, STAY)

    assert (mine.frames, mine.detections) == (whole.frames, whole.detections)
    assert _totals(mine)[0] == _totals(whole)[0]
    assert np.allclose(_totals(mine)[1], _totals(whole)[1])
    assert np.array_equal(_totals(mine)[2], _totals(whole)[2])


def _totals(made: ObjectMap) -> tuple[dict[str, int], F64, F64]:
    """Counts of labels; S and Omega; sums of the voxels: points and colours. Over all objects."""
    records, labels = list(made.table), dict[str, int]()
    for record in records:
        for label, count in record.label_counts.items():
            labels[label] = labels.get(label, 0) + count
    if not records:
        return labels, np.zeros(1), np.zeros(5)
    sums = [np.append(made.table.feature_sum(r), r.view_weight) for r in records]
    tallies = np.sum([r.cloud.tally.sum(axis=0) for r in records], axis=0)
    observations = sum(r.observations for r in records)
    return labels, np.sum(sums, axis=0), np.array([observations, tallies[0], *tallies[4:]], np.float64)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 11))
def test_where_association_agrees_the_joined_map_is_the_map_of_all_frames(seed: int, cut: int) -> None:
    """Six things far apart, seen cleanly: both maps find the same objects."""
    rng = np.random.default_rng(seed)
    run = [
        batch(n, *(_thing(int(i), rng) for i in rng.permutation(6)[: rng.integers(1, 7)]))
        for n in range(1, 13)
    ]
    whole, mine, other = (_map_of(*part) for part in (run, run[:cut], run[cut:]))

    mine.join(other, STAY)

    joined = {o.label: o for o in mine.objects()}
    assert len(joined) == len(mine.objects()) == len(whole.objects())
    for expected in whole.objects():
        found = joined[expected.label]
        assert (found.label_counts, found.observations, found.frames) == (
            expected.label_counts, expected.observations, expected.frames
        )  # fmt: skip
        assert (found.first_seen_ns, found.last_seen_ns) == (expected.first_seen_ns, expected.last_seen_ns)
        assert found.view_weight == pytest.approx(expected.view_weight)
        assert np.allclose(found.feature, expected.feature, atol=1e-6)
        a, b = _cloud(mine, found.object_id), _cloud(whole, expected.object_id)
        assert np.array_equal(a.keys, b.keys)
        assert np.array_equal(a.tally, b.tally)
        assert np.array_equal(found.box, expected.box)


def _thing(i: int, rng: np.random.Generator) -> Detection:
    low = np.array([3.0 * i, 0, 0]) + rng.normal(0, 0.005, 3)
    return detection(f"thing {i}", tuple(low), tuple(low + 0.3), feature=leaning(i, 7, 0.98))


def _cloud(made: ObjectMap, object_id: str) -> VoxelCloud:
    record = made.table.get(object_id)
    assert record is not None
    return record.cloud


# Clouds


def test_a_cloud_that_does_not_move_stays_the_same_to_the_bit() -> None:
    cloud = VoxelCloud.of(block((0, 0, 0), (1, 1, 1)), np.zeros((9261, 3), np.uint8), 0.02)

    assert moved_cloud(cloud, STAY, 0.02) is cloud


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.floats(-4, 4), st.sampled_from([0.02, 0.03]), st.integers(0, 2))
def test_a_moved_cloud_keeps_its_points_colours_and_middle(
    seed: int, yaw: float, size: float, level: int
) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (300, 3)).astype(np.float32)
    cloud = VoxelCloud.of(points, rng.integers(0, 256, (300, 3)).astype(np.uint8), 0.02).at_level(level)
    pose = turn(yaw)
    pose[:3, 3] = rng.uniform(-5, 5, 3)

    moved = moved_cloud(cloud, pose, size)

    assert moved.counts.sum() == 300
    assert np.array_equal(moved.tally[:, 4:].sum(axis=0), cloud.tally[:, 4:].sum(axis=0))
    middle = (cloud.means * cloud.counts[:, None]).sum(axis=0) / 300
    found = (moved.means * moved.counts[:, None]).sum(axis=0) / 300
    assert np.allclose(found, pose[:3, :3] @ middle + pose[:3, 3], atol=1e-4)
    assert (np.diff(moved.keys) > 0).all()


# What operators said


def test_what_is_deleted_here_swallows_what_arrives() -> None:
    mine = _seen(CUP)
    _edit(mine, Delete("o000001"))

    delta, ids = mine.join(_seen(CUP, first=10), STAY)

    assert (delta.created, delta.updated, mine.objects()) == ((), (), ())
    assert mine.deleted_at(ids["o000001"]) == 4


def test_what_is_deleted_there_stays_hidden_and_takes_nothing_from_here() -> None:
    mine, other = _seen(CUP), _seen(CUP, LAMP, first=10)
    for name in ("o000001", "o000002"):
        _edit(other, Delete(name))

    delta, ids = mine.join(other, STAY)
    mine.upkeep()

    assert [o.object_id for o in mine.objects()] == ["o000001"]
    assert delta.created == ()
    assert mine.deleted_at(ids["o000002"]) == delta.version
    mine.integrate(batch(30, LAMP))
    assert [o.object_id for o in mine.objects()] == ["o000001"]


def test_names_and_pins_and_splits_of_the_other_hold_here() -> None:
    mine, other = _seen(LAMP), _seen(CUP, LAMP, first=10)
    _edit(other, Rename("o000002", "reading light"))
    _edit(other, Pin("o000002"))
    _edit(other, Split("o000001", np.array([-1.0, -1, -1, 0.1, 1, 1])))

    _, ids = mine.join(other, STAY)

    light = mine.find(ids["o000002"])
    assert light is not None
    assert (light.object_id, light.label, light.pinned) == ("o000001", "reading light", True)
    rest = mine.table.get(ids["o000001"])
    assert rest is not None
    assert rest.apart == {ids["o000003"]}


def test_a_join_replays_bit_for_bit() -> None:
    run = random_run(4, 20)
    pose = turn(0.3)
    joined = []
    for _ in range(2):
        mine = _map_of(*run[:10])
        mine.join(_map_of(*run[10:]), pose)
        mine.upkeep()
        joined.append(mine.state_hash())

    assert joined[0] == joined[1]
