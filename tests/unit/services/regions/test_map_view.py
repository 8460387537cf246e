"""The map's objects: read when the log says that one changed, and not before."""

from __future__ import annotations

import pytest

from ovip.codec import encode_delta
from ovip.scene.types import MapDelta, StepKind
from ovip.store import Entry
from services.regions.map_view import MapView
from tests.unit.services.regions.homes import PlainMap, mapped


def entry(version: int, kind: StepKind = StepKind.FRAME, **changed: object) -> Entry:
    delta = MapDelta(version, "f0", kind, **changed)  # type: ignore[arg-type]
    return Entry(f"{version}-0", {"delta": encode_delta(delta)})


async def test_objects_come_by_id_with_the_version_they_are_of() -> None:
    view = MapView("home", PlainMap(mapped("b", "stove", 1, 2), mapped("a", "bed", 3, 4)), "0-0")
    objects, version = await view.objects()
    assert (objects.ids, objects.labels, version) == (("a", "b"), ("bed", "stove"), 1)
    assert objects.centres.tolist() == [[3.0, 4.0, 0.5], [1.0, 2.0, 0.5]]


async def test_an_empty_map_has_no_objects() -> None:
    objects, _ = await MapView("home", PlainMap(), "0-0").objects()
    assert objects.ids == ()
    assert objects.centres.shape == (0, 3)


async def test_versions_that_touch_no_object_are_counted_without_reading_the_map() -> None:
    home = PlainMap(mapped("a", "bed", 1, 1))
    view = MapView("home", home, "0-0")
    await view.objects()
    assert not view.look_at([entry(2), entry(3, StepKind.UPKEEP)])
    _, version = await view.objects()
    assert (version, view.after, home.asked) == (3, "3-0", 1)


@pytest.mark.parametrize(
    "change",
    [
        {"created": ("a",)},
        {"updated": ("a",)},
        {"removed": ("a",)},
        {"aliases": {"a": "b"}},
        {"departed": ("a",)},
        {"returned": ("a",)},
        {"moved": ("a",)},
        {"kind": StepKind.SETTINGS},
        {"kind": StepKind.EDIT},
        {"kind": StepKind.JOIN},
    ],
)
async def test_any_change_of_an_object_and_any_act_of_an_operator_reads_the_map_again(
    change: dict[str, object],
) -> None:
    home = PlainMap(mapped("a", "bed", 1, 1))
    view = MapView("home", home, "0-0")
    await view.objects()
    home.objects, home.version = (), 2
    assert view.look_at([entry(2, **change)])  # type: ignore[arg-type]
    objects, version = await view.objects()
    assert (objects.ids, version, home.asked) == ((), 2, 2)


async def test_an_entry_that_cannot_be_read_may_have_changed_anything() -> None:
    view = MapView("home", PlainMap(), "0-0")
    assert view.look_at([Entry("7-0", {"delta": b"\xff\xff"})])
    assert view.look_at([Entry("8-0", {})])
    assert view.after == "8-0"
