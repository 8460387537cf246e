"""The object map: who is who (IPA), what is fused (AWF), what upkeep does, and that it is the same every time."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import Box2, Detection, DetectionBatch, MapDelta, MapObject, StepKind
from services.mapper.domain.association import AssociationParams
from services.mapper.domain.fusion import view_weight
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.domain.upkeep import UpkeepParams
from tests.builders import SECOND, axis, batch, camera, detection, leaning, random_run, same

SEEN_ONCE = MapParams(upkeep=UpkeepParams(confirm_frames=1))
K = camera()


def _map_of(*batches: DetectionBatch, params: MapParams = SEEN_ONCE) -> ObjectMap:
    made = ObjectMap(params)
    for one in batches:
        _step(made, one)
    return made


def _step(made: ObjectMap, one: DetectionBatch) -> list[MapDelta]:
    """A batch, and upkeep where it is due."""
    deltas = [made.integrate(one)]
    if made.upkeep_due:
        deltas.append(made.upkeep())
    return deltas


def _ids(made: ObjectMap) -> list[str]:
    return [o.object_id for o in made.objects(include_unconfirmed=True)]


# Joining


def test_the_first_detections_become_objects_in_their_order() -> None:
    made = ObjectMap(SEEN_ONCE)

    delta = made.integrate(batch(1, detection("cup"), detection("lamp", (2, 0, 0), (2.2, 0.2, 0.2))))

    assert delta == MapDelta(1, "r.s.00000001", created=("o000001", "o000002"))
    assert [(o.object_id, o.label) for o in made.objects()] == [("o000001", "cup"), ("o000002", "lamp")]


def test_the_same_thing_seen_again_stays_one_object() -> None:
    made = _map_of(*(batch(n, detection("cup")) for n in range(1, 6)))

    (cup,) = made.objects()
    assert (cup.observations, cup.frames, made.frames, made.detections) == (5, 5, 5, 5)
    assert (cup.first_seen_ns, cup.last_seen_ns) == (1 * SECOND, 5 * SECOND)


def test_two_like_things_in_two_places_are_two_objects() -> None:
    left, right = detection("cup"), detection("cup", (1, 0, 0), (1.2, 0.2, 0.2))

    made = _map_of(*(batch(n, left, right) for n in range(1, 15)))

    assert [o.observations for o in made.objects()] == [14, 14]


def test_a_cup_on_a_table_stays_its_own_object_and_the_table_does_not_swallow_it() -> None:
    """The cup's box lies wholly inside the table's; the two look much alike."""
    table = detection("table", (0, 0, 0), (1.2, 0.8, 0.8), feature=axis(0))
    cup = detection("cup", (0.5, 0.3, 0.6), (0.6, 0.4, 0.7), feature=leaning(0, 1, 0.95))

    made = _map_of(*(batch(n, table, cup) for n in range(1, 25)))

    first, second = made.objects()
    assert (first.label, first.label_counts) == ("table", {"table": 24})
    assert (second.label, second.label_counts) == ("cup", {"cup": 24})
    assert second.box == pytest.approx([0.5, 0.3, 0.6, 0.6, 0.4, 0.7], abs=0.02)


def test_a_cup_stays_its_own_object_whichever_is_seen_first() -> None:
    table = detection("table", (0, 0, 0), (1.2, 0.8, 0.8), feature=axis(0))
    cup = detection("cup", (0.5, 0.3, 0.6), (0.6, 0.4, 0.7), feature=leaning(0, 1, 0.95))
    turns = [batch(1, cup), batch(2, table), batch(3, cup), batch(4, table), batch(5, table, cup)]

    assert [o.label_counts for o in _map_of(*turns).objects()] == [{"cup": 3}, {"table": 3}]


def test_another_label_joins_where_place_and_looks_outweigh_the_penalty() -> None:
    """IoU 1 + cos 1 - 0.5 = 1.5 > 1.05; with a cosine of 0.5 it is 1.0, which is not."""
    cup = detection("cup")

    joined = _map_of(batch(1, cup), batch(2, detection("mug")))
    apart = _map_of(batch(1, cup), batch(2, detection("mug", feature=leaning(0, 1, 0.5))))

    assert [o.label_counts for o in joined.objects()] == [{"cup": 1, "mug": 1}]
    assert len(apart.objects()) == 2


def test_detections_of_one_frame_are_scored_against_the_map_before_it() -> None:
    """The second would join what the first of its own frame has just made, were it there already."""
    first = detection("cup", (0, 0, 0), (0.2, 0.2, 0.2))
    second = detection("cup", (0.18, 0, 0), (0.38, 0.2, 0.2), feature=leaning(0, 1, 0.8))
    loose = MapParams(
        AssociationParams(tau=0.5), upkeep=UpkeepParams(confirm_frames=1, merge_similarity=0.99)
    )

    assert len(_map_of(batch(1, first, second), params=loose).objects()) == 2
    assert len(_map_of(batch(1, first), batch(2, second), params=loose).objects()) == 1


def test_an_empty_frame_counts_and_changes_no_object() -> None:
    made = _map_of(batch(1, detection("cup")))

    delta = made.integrate(batch(2))

    assert delta == MapDelta(2, "r.s.00000002")
    assert (made.version, made.frames, made.detections) == (2, 2, 1)


def test_a_late_batch_is_no_new_frame_of_the_scene() -> None:
    made = _map_of(batch(1), batch(1, detection("cup"), late=True))

    assert (made.version, made.frames, made.detections) == (2, 1, 1)
    assert made.objects()[0].frames == 1


def test_an_empty_map_shows_nothing() -> None:
    assert ObjectMap().objects() == ()
    assert ObjectMap().find("o000001") is None
    assert ObjectMap().cloud_of("o000001") is None


# Fusion


def test_features_fuse_by_view_weight_by_hand() -> None:
    """Eq. 4: S = w1 f1 + w2 f2, Omega = w1 + w2, g = S/|S|."""
    large, small = Box2(16, 12, 48, 36), Box2(0, 0, 16, 12)
    w1 = view_weight(large, K.width, K.height, 0.6)
    w2 = view_weight(small, K.width, K.height, 0.6)
    f1, f2 = axis(0), leaning(0, 1, 0.6)

    made = _map_of(
        batch(1, detection("cup", feature=f1, box2=large)), batch(2, detection("cup", feature=f2, box2=small))
    )

    (cup,) = made.objects()
    s = np.array([w1 + 0.6 * w2, 0.8 * w2])
    assert w1 == pytest.approx(0.25)  # a quarter of the image, centred
    assert cup.view_weight == pytest.approx(w1 + w2)
    assert cup.feature[:2] == pytest.approx(s / np.linalg.norm(s), abs=1e-6)
    assert np.linalg.norm(cup.feature) == pytest.approx(1.0, abs=1e-6)


def test_the_best_view_is_the_heaviest_and_the_first_of_equals() -> None:
    far, near = Box2(28, 20, 36, 28), Box2(16, 12, 48, 36)

    made = _map_of(
        batch(1, detection("cup", box2=far)),
        batch(2, detection("cup", box2=near)),
        batch(3, detection("cup", box2=near)),
    )

    (cup,) = made.objects()
    assert (cup.best_frame_id, cup.best_box2) == ("r.s.00000002", near)


def test_the_label_is_the_most_frequent_and_of_equals_the_first_seen() -> None:
    labels = ["mug", "cup", "cup", "mug"]
    made = ObjectMap(SEEN_ONCE)
    seen = []
    for n, label in enumerate(labels, 1):
        made.integrate(batch(n, detection(label)))
        seen.append(made.objects()[0].label)

    assert seen == ["mug", "mug", "cup", "mug"]
    assert made.objects()[0].label_counts == {"mug": 2, "cup": 2}


def test_geometry_grows_with_what_is_seen() -> None:
    left = detection("table", (0, 0, 0), (1.0, 0.5, 0.02))
    more = detection("table", (0.4, 0, 0), (1.4, 0.5, 0.02))

    (table,) = _map_of(batch(1, left), batch(2, more)).objects()

    assert table.box == pytest.approx([0, 0, 0, 1.4, 0.5, 0.02], abs=0.02)
    assert table.centroid == pytest.approx([0.7, 0.25, 0.01], abs=0.05)


def test_colours_are_the_mean_of_the_voxels() -> None:
    (cup,) = _map_of(
        batch(1, detection("cup", color=(100, 0, 0))), batch(2, detection("cup", color=(200, 50, 0)))
    ).objects()

    assert cup.mean_color == pytest.approx([150, 25, 0])


# Confirming and forgetting


def test_an_object_is_shown_once_enough_frames_saw_it() -> None:
    made = ObjectMap(MapParams(upkeep=UpkeepParams(confirm_frames=3)))
    shown = []
    for n in range(1, 5):
        made.integrate(batch(n, detection("cup"), detection("cup", (3, 0, 0), (3.2, 0.2, 0.2))))
        shown.append(len(made.objects()))

    assert shown == [0, 0, 2, 2]
    assert len(_ids(made)) == 2


def test_seen_twice_in_one_frame_is_seen_by_one_frame() -> None:
    twice = MapParams(upkeep=UpkeepParams(confirm_frames=2))
    first = batch(1, detection("cup"))
    again = batch(2, detection("cup"), detection("cup", (0.02, 0, 0), (0.22, 0.2, 0.2)))

    (cup,) = _map_of(first, again, params=twice).objects()

    assert (cup.frames, cup.observations) == (2, 3)


def test_what_was_not_seen_again_is_forgotten_and_what_was_confirmed_is_not() -> None:
    params = MapParams(upkeep=UpkeepParams(every=2, confirm_frames=2, forget_after=4))
    ghost = detection("umbrella", (3, 0, 0), (3.2, 0.2, 0.2))
    made = _map_of(batch(1, detection("cup"), ghost), batch(2, detection("cup")), params=params)

    removed = [delta.removed for n in range(3, 9) for delta in _step(made, batch(n)) if delta.removed]

    assert removed == [("o000002",)]  # at the upkeep after batch 6, four or more after batch 1
    assert made.version == 8 + 4  # upkeep is a version of its own
    assert _ids(made) == ["o000001"]
    assert made.find("o000002") is None


# Merging duplicates


def _long_table(low: float, high: float) -> Detection:
    return detection("table", (low, 0, 0), (high, 0.6, 0.04))


def test_parts_that_grow_together_merge_and_the_one_seen_more_often_stays() -> None:
    made = _map_of(batch(1, _long_table(0, 1)), *(batch(n, _long_table(1.02, 2)) for n in range(2, 5)))
    assert _ids(made) == ["o000001", "o000002"]

    delta = made.integrate(batch(5, _long_table(0.4, 1.6)))

    assert delta.aliases == {"o000001": "o000002"}
    assert delta.updated == ("o000002",)
    (table,) = made.objects()
    assert table.object_id == "o000002"
    assert table.box == pytest.approx([0, 0, 0, 2, 0.6, 0.04], abs=0.02)
    assert table.observations == 5
    assert table.version == 5


def test_upkeep_merges_once_and_then_finds_nothing_to_do() -> None:
    """Merging waits for upkeep; two halves of a table that a third view joins are two till then."""
    patient = MapParams(upkeep=UpkeepParams(every=100, confirm_frames=1, eager=False))
    parts = [batch(1, _long_table(0, 1)), batch(2, _long_table(1.02, 2)), batch(3, _long_table(0.4, 1.6))]
    made = _map_of(*parts, params=patient)
    before = made.version
    assert len(made.objects()) == 2

    assert made.changed_since_upkeep
    delta = made.upkeep()

    assert (delta.version, delta.frame_id, delta.aliases) == (before + 1, "", {"o000002": "o000001"})
    assert delta.updated == ("o000001",)
    assert len(made.objects()) == 1
    assert not made.changed_since_upkeep
    assert made.upkeep() == MapDelta(before + 2, "", StepKind.UPKEEP)


def test_an_id_merged_away_still_finds_its_survivor_through_a_chain() -> None:
    made = _map_of(
        batch(1, _long_table(0, 1)),
        *(batch(n, _long_table(1.02, 2)) for n in range(2, 5)),
        *(batch(n, _long_table(2.02, 3)) for n in range(5, 13)),
        batch(13, _long_table(0.4, 1.6)),
        batch(14, _long_table(1.0, 2.9)),
    )

    assert _ids(made) == ["o000003"]
    assert made.aliases == {"o000001": "o000002", "o000002": "o000003"}
    for name in ("o000001", "o000002", "o000003"):
        found, points = made.find(name), made.cloud_of(name)
        assert found is not None and points is not None
        assert found.object_id == "o000003"
        assert len(points[0]) == found.voxels
    assert ObjectMap.restore([made.segment()], SEEN_ONCE).find("o000001") is not None


def test_merging_adds_the_accumulators() -> None:
    parts = [batch(1, _long_table(0, 1)), batch(2, _long_table(1.02, 2)), batch(3, _long_table(0.4, 1.6))]
    made = _map_of(*parts)

    (table,) = made.objects()
    weight = view_weight(parts[0].detections[0].box2, K.width, K.height, 0.6)
    assert table.view_weight == pytest.approx(3 * weight)
    assert table.label_counts == {"table": 3}
    assert (table.first_seen_ns, table.last_seen_ns) == (1 * SECOND, 3 * SECOND)


def test_things_of_other_looks_never_merge_as_duplicates_whatever_their_labels() -> None:
    place = {"low": (0, 0, 0), "high": (1, 0.6, 0.04)}
    named = _map_of(
        *(
            batch(n, detection("table", **place), detection("desk", feature=axis(3), **place))
            for n in range(1, 25)
        )
    )
    looking = _map_of(
        *(
            batch(n, detection("table", **place), detection("table", feature=axis(3), **place))
            for n in range(1, 25)
        )
    )

    assert len(named.objects()) == 2
    assert len(looking.objects()) == 2


def test_one_thing_under_two_names_becomes_one_once_the_two_cover_much_the_same() -> None:
    """A fifth of the one lies on the other, which is not enough; once the sofa is seen to go on, half of each does."""
    sofa, couch = (
        detection("sofa", (0, 0, 0), (1, 0.6, 0.6)),
        detection("couch", (0.8, 0, 0), (2.2, 0.6, 0.6)),
    )
    made = _map_of(batch(1, sofa), batch(2, couch))
    assert _ids(made) == ["o000001", "o000002"]

    delta = made.integrate(batch(3, detection("sofa", (0.3, 0, 0), (1.7, 0.6, 0.6))))

    assert delta.aliases == {"o000002": "o000001"}
    (one,) = made.objects()
    assert (one.label, one.label_counts) == ("sofa", {"sofa": 2, "couch": 1})


def test_like_things_of_two_names_that_only_touch_stay_two() -> None:
    """A bookcase beside a cupboard, alike and touching: by overlap only one label merges."""
    left, right = _long_table(0, 1), detection("desk", (1.0, 0, 0), (2, 0.6, 0.04))

    made = _map_of(*(batch(n, left, right) for n in range(1, 25)))

    assert sorted(o.label for o in made.objects()) == ["desk", "table"]


# Wrong batches


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"feature": axis(0, 4)}, "expected a feature of 8 numbers like the map's, got 4"),
        ({"feature": np.full(8, np.nan, np.float32)}, "expected finite"),
        ({"box": np.full(6, np.inf)}, "expected finite"),
        ({"points": np.full((20, 3), np.nan, np.float32)}, "expected"),
        ({"points": np.zeros((0, 3), np.float32), "colors": np.zeros((0, 3), np.uint8)}, "expected points"),
        ({"colors": np.zeros((1, 3), np.uint8)}, "expected points with a colour each"),
    ],
)
def test_a_batch_that_cannot_be_the_maps_is_refused_whole_and_changes_nothing(
    change: dict[str, Any], words: str
) -> None:
    made = _map_of(batch(1, detection("cup")))
    before = made.state_hash()
    bad = dataclasses.replace(detection("cup"), **change)

    with pytest.raises(InvalidInput, match=words):
        made.integrate(batch(2, detection("cup"), bad))

    assert made.state_hash() == before


def test_a_refused_first_batch_does_not_decide_the_feature_space() -> None:
    made = ObjectMap(SEEN_ONCE)

    with pytest.raises(InvalidInput, match="expected a feature of 4 numbers like the map's, got 8"):
        made.integrate(batch(1, detection("cup", feature=axis(0, 4)), detection("cup")))

    made.integrate(batch(2, detection("cup")))
    assert len(made.objects()) == 1


# The same every time


SEEDS = st.integers(0, 2**32 - 1)
BUSY = MapParams(upkeep=UpkeepParams(every=3, confirm_frames=2, forget_after=6))
SETTINGS = settings(max_examples=25)


@given(SEEDS, st.integers(0, 25))
@SETTINGS
def test_a_map_written_down_and_read_back_is_the_same_bytes_and_goes_on_as_if_never_stopped(
    seed: int, cut: int
) -> None:
    run = random_run(seed, 25)
    never_stopped, stopped = ObjectMap(BUSY), ObjectMap(BUSY)
    expected = [_step(never_stopped, one) for one in run]
    deltas = [_step(stopped, one) for one in run[:cut]]

    data = stopped.segment()
    again = ObjectMap.restore([data])

    assert again.segment() == data
    assert again.params == BUSY
    assert again.state_hash() == stopped.state_hash()
    assert all(map(same, again.objects(True), stopped.objects(True)))
    assert deltas + [_step(again, one) for one in run[cut:]] == expected
    assert again.state_hash() == never_stopped.state_hash()


@given(SEEDS)
@SETTINGS
def test_the_same_batches_give_the_same_map_to_the_bit(seed: int) -> None:
    assert _map_of(*random_run(seed, 20), params=BUSY).segment() == (
        _map_of(*random_run(seed, 20), params=BUSY).segment()
    )


def test_maps_that_differ_in_one_detection_hash_differently() -> None:
    one = _map_of(batch(1, detection("cup")))
    other = _map_of(batch(1, detection("cup", color=(200, 100, 51))))

    assert one.state_hash() != other.state_hash()


@given(SEEDS)
@SETTINGS
def test_whoever_follows_the_deltas_knows_every_object_and_every_change(seed: int) -> None:
    made, known = ObjectMap(BUSY), dict[str, MapObject]()
    steps: list[Callable[[], MapDelta]] = []
    for one in random_run(seed, 30):
        steps += [partial(made.integrate, one), made.upkeep][: 1 + (len(steps) % 3 == 0)]
    for version, step in enumerate(steps, 1):
        delta = step()
        now = {o.object_id: o for o in made.objects(include_unconfirmed=True)}

        assert delta.version == version
        assert set(known) - set(delta.removed) - set(delta.aliases) | set(delta.created) == set(now)
        assert not set(delta.created) & set(known)
        for object_id, o in now.items():
            if object_id in (*delta.created, *delta.updated):
                assert o.version == version
            else:
                assert same(o, known[object_id]), "changed in silence"
        known = now


@given(SEEDS)
@SETTINGS
def test_ids_are_never_reused_and_no_view_is_lost(seed: int) -> None:
    params = dataclasses.replace(BUSY, upkeep=dataclasses.replace(BUSY.upkeep, forget_after=10**6))
    made, born = ObjectMap(params), list[str]()
    run = random_run(seed, 30)
    for one in run:
        born += [name for delta in _step(made, one) for name in delta.created]
        assert len(born) == len(set(born))
        for object_id in born:
            assert made.find(object_id) is not None

    objects: Sequence[MapObject] = made.objects(include_unconfirmed=True)
    assert sum(o.observations for o in objects) == sum(len(one.detections) for one in run) == made.detections
    assert sum(sum(o.label_counts.values()) for o in objects) == made.detections
    weights = [view_weight(d.box2, K.width, K.height, 0.6) for one in run for d in one.detections]
    assert sum(o.view_weight for o in objects) == pytest.approx(sum(weights))


@given(SEEDS, st.lists(st.integers(1, 12), max_size=4))
@SETTINGS
def test_segments_of_what_changed_make_the_whole_map(seed: int, cuts: list[int]) -> None:
    """Cut anywhere, whatever was born, changed, merged or forgotten between the cuts."""
    made, run = ObjectMap(BUSY), iter(random_run(seed, 48))
    segments, since = list[bytes](), 0
    for length in [*cuts, 5]:
        for _, one in zip(range(length), run, strict=False):
            _step(made, one)
        segments.append(made.segment(since))
        since = made.version

    again = ObjectMap.restore(segments)

    assert again.state_hash() == made.state_hash()
    assert again.segment() == made.segment()
    assert again.aliases == made.aliases


@given(SEEDS, st.lists(st.booleans(), min_size=40, max_size=40))
@SETTINGS
def test_looking_at_a_map_and_writing_it_down_on_the_way_changes_no_bit_of_it(
    seed: int, looks: list[bool]
) -> None:
    """With frames that see through things: what is watched of them is state, too."""
    rng = np.random.default_rng(seed)
    run = [
        dataclasses.replace(
            one, nearest=rng.uniform(0, 4, (12, 16)).astype(np.float32) * (rng.random() < 0.7)
        )
        for one in random_run(seed, 40)
    ]
    left_alone, looked_at, segments, since = ObjectMap(BUSY), ObjectMap(BUSY), list[bytes](), 0
    for one, look in zip(run, looks, strict=True):
        _step(left_alone, one)
        _step(looked_at, one)
        if look:
            looked_at.state_hash()
            looked_at.objects(include_unconfirmed=True, include_departed=True)
            segments.append(looked_at.segment(since))
            since = looked_at.version
    segments.append(looked_at.segment(since))

    assert looked_at.state_hash() == left_alone.state_hash()
    assert ObjectMap.restore(segments).state_hash() == left_alone.state_hash()


def test_a_segment_tells_only_what_changed() -> None:
    many = [detection("cup", (3.0 * i, 0, 0), (3.0 * i + 0.2, 0.2, 0.2)) for i in range(40)]
    made = _map_of(batch(1, *many))
    made.upkeep()
    whole, since = len(made.segment()), made.version

    made.integrate(batch(2, many[7]))

    assert len(made.segment(since)) < whole / 20


# Broken snapshots


def test_a_snapshot_cut_off_is_corrupt_wherever_it_is_cut() -> None:
    data = _map_of(*random_run(1, 5)).segment()
    for end in range(0, len(data), max(1, len(data) // 200)):
        with pytest.raises(Corrupt, match="map snapshot"):
            ObjectMap.restore([data[:end]])


def test_bytes_after_a_snapshots_end_are_corrupt() -> None:
    with pytest.raises(Corrupt, match="map snapshot: expected"):
        ObjectMap.restore([_map_of(batch(1, detection("cup"))).segment() + b"x"])


def test_a_segment_of_changes_alone_is_no_map() -> None:
    made = _map_of(batch(1, detection("cup")))
    first = made.segment()
    made.integrate(batch(2, detection("cup")))
    made.integrate(batch(3, detection("cup")))

    with pytest.raises(Corrupt, match="a segment since version 2 follows one of version none"):
        ObjectMap.restore([made.segment(2)])
    with pytest.raises(Corrupt, match="a segment since version 2 follows one of version 1"):
        ObjectMap.restore([first, made.segment(2)])
    with pytest.raises(Corrupt, match="at least one"):
        ObjectMap.restore([])


def test_a_snapshot_of_another_format_is_refused_in_words() -> None:
    data = bytearray(_map_of(batch(1, detection("cup"))).segment())
    data[8] = 9

    with pytest.raises(InvalidInput, match="map snapshot of format 9: this version reads format 2"):
        ObjectMap.restore([bytes(data)])


def test_an_empty_map_survives_its_snapshot() -> None:
    assert ObjectMap.restore([ObjectMap().segment()]).state_hash() == ObjectMap().state_hash()


def test_other_settings_hold_from_their_version_on() -> None:
    made = _map_of(batch(1, detection("cup")), params=MapParams())
    assert made.objects() == ()

    delta = made.adopt(SEEN_ONCE)

    assert delta == MapDelta(2, "", StepKind.SETTINGS)
    assert len(made.objects()) == 1
    assert ObjectMap.restore([made.segment()]).params == SEEN_ONCE
