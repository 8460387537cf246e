"""Snapshots go on from one another and begin anew before they grow too long; the count of objects follows deltas."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from ovip.scene.edits import Delete, EditRequest, Pin, Rename
from services.mapper.counting import ShownCount
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.domain.upkeep import UpkeepParams
from services.mapper.snapshots import Snapshot, next_segment
from tests.builders import random_run

PARAMS = MapParams(upkeep=UpkeepParams(every=3, confirm_frames=2, forget_after=5))


def based_on(version: int, *sizes: int) -> Snapshot:
    return Snapshot(version, tuple(f"{n}" for n in range(len(sizes))), sizes, "", "0-0")


def test_the_first_snapshot_holds_everything() -> None:
    objects = ObjectMap(PARAMS)
    objects.integrate(random_run(1, 1)[0])

    assert next_segment(objects, None) == (objects.segment(0), None)


def test_a_snapshot_adds_to_the_one_before_until_the_additions_outgrow_it() -> None:
    objects = ObjectMap(PARAMS)
    for one in random_run(1, 4):
        objects.integrate(one)
    small, large = based_on(2, 1000, 400, 600), based_on(2, 1000, 400, 601)

    assert next_segment(objects, small) == (objects.segment(2), small)
    assert next_segment(objects, large) == (objects.segment(0), None)


def test_a_snapshot_has_64_segments_at_most() -> None:
    objects = ObjectMap(PARAMS)
    objects.integrate(random_run(1, 1)[0])

    assert next_segment(objects, based_on(0, 10_000, *62 * [1]))[1] is not None
    assert next_segment(objects, based_on(0, 10_000, *63 * [1]))[1] is None


@given(seed=st.integers(0, 10_000), every=st.integers(1, 7))
@settings(max_examples=15)
def test_segments_in_turn_hold_what_a_whole_one_holds(seed: int, every: int) -> None:
    objects = ObjectMap(PARAMS)
    base: Snapshot | None = None
    segments: list[bytes] = []
    for number, one in enumerate(random_run(seed, 20), 1):
        objects.integrate(one)
        if objects.upkeep_due:
            objects.upkeep()
        if number % every == 0:
            segment, since = next_segment(objects, base)
            segments = [*segments, segment] if since else [segment]
            sizes = tuple(map(len, segments))
            base = Snapshot(objects.version, tuple(map(str, sizes)), sizes, "", "0-0")
            assert ObjectMap.restore(segments).state_hash() == objects.state_hash()


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15)
def test_the_count_kept_by_deltas_is_the_number_that_readers_get(seed: int) -> None:
    objects, shown = ObjectMap(PARAMS), ShownCount()
    for number, one in enumerate(random_run(seed, 16)):
        deltas = [objects.integrate(one)]
        if objects.upkeep_due:
            deltas.append(objects.upkeep())
        if number % 5 == 4:
            names = [o.object_id for o in objects.objects(include_unconfirmed=True)][: 1 + seed % 3]
            for name, edit in zip(
                names, (Pin(names[0]), Delete(names[-1]), Rename(names[0], "x")), strict=False
            ):
                try:
                    deltas.append(objects.edit(EditRequest(f"{number}{name}", objects.version, "t", edit)))
                except InvalidInput:
                    continue
        counts = [shown.count(objects, delta) for delta in deltas]
        assert counts[-1] == len(objects.objects())


def test_a_missed_version_is_counted_anew() -> None:
    objects, shown = ObjectMap(PARAMS), ShownCount()
    for number, one in enumerate(random_run(3, 12)):
        delta = objects.integrate(one)
        if number % 3 == 0:
            assert shown.count(objects, delta) == len(objects.objects())
