"""Operators' edits over the log: done once or refused once, by whoever writes, asked for anywhere."""

from __future__ import annotations

import asyncio
import dataclasses
import json
from collections.abc import AsyncIterator

import numpy as np
import pytest
import pytest_asyncio

from ovip.errors import Conflict, Corrupt, InvalidInput, NotFound, OvipError, TooLarge, Unavailable
from ovip.scene.edits import Delete, Edit, EditRequest, Merge, Pin, Rename, Split
from ovip.scene.types import MapDelta, StepKind
from ovip.store import Store
from services.mapper.domain.object_map import ObjectMap
from services.mapper.history import History
from services.mapper.service import Mapper
from tests.builders import axis, batch, detection, random_run
from tests.integration.mappers import (
    OTHER,
    SCENE,
    SETTINGS,
    a_mapper,
    applied,
    expected,
    following,
    made_of,
    shifted,
    write,
)

THINGS = [
    detection("cup", (0, 0, 0), (0.2, 0.2, 0.2), axis(0)),
    detection("bowl", (1, 0, 0), (1.3, 0.3, 0.1), axis(1)),
    detection("shelf", (3, 0, 0), (5, 0.3, 0.3), axis(2)),
]
SEEN = [batch(n, *THINGS) for n in range(1, 6)]


@pytest_asyncio.fixture
async def mapper(store: Store) -> AsyncIterator[Mapper]:
    """A mapper that writes a kitchen with a cup, a bowl and a shelf: o000001 to o000003."""
    newest = await write(store, SEEN)
    async with following(store) as writing:
        await applied(writing, newest)
        yield writing


def asked(edit: Edit, edit_id: str = "e1", made_on: int = 7) -> EditRequest:
    return EditRequest(edit_id, made_on, "test", edit)


async def labels(mapper: Mapper) -> dict[str, str]:
    return {o.object_id: o.label for o in (await mapper.get_map(SCENE)).objects}


async def test_each_kind_of_edit_is_a_step_of_its_own(store: Store, mapper: Mapper) -> None:
    before = await mapper.get_map(SCENE)
    part = np.array([2.9, -0.1, -0.1, 4.0, 0.4, 0.4])
    edits = (
        Rename("o000001", "mug"),
        Pin("o000001"),
        Split("o000003", part, "box"),
        Merge("o000001", ("o000002",)),
        Delete("o000003"),
    )
    deltas = [
        await mapper.edit(SCENE, asked(edit, f"e{n}", before.version + n)) for n, edit in enumerate(edits)
    ]

    assert [d.kind for d in deltas] == 5 * [StepKind.EDIT]
    assert [d.version for d in deltas] == [before.version + n for n in range(1, 6)]
    assert deltas[2].created == ("o000004",)
    assert deltas[3].aliases == {"o000002": "o000001"}
    assert await labels(mapper) == {"o000001": "mug", "o000004": "box"}
    assert (await a_mapper(store).get_map(SCENE)).state_hash == (await mapper.get_map(SCENE)).state_hash
    assert (await mapper.verify(SCENE)).holds


async def test_an_edit_outlives_later_frames_and_a_restart(store: Store, mapper: Mapper) -> None:
    await mapper.edit(SCENE, asked(Rename("o000001", "mug")))
    await mapper.edit(SCENE, asked(Delete("o000002"), "e2"))
    newest = await write(store, [batch(n, *THINGS) for n in range(6, 14)])
    await applied(mapper, newest)

    assert await labels(mapper) == {"o000001": "mug", "o000003": "shelf"}
    assert await labels(a_mapper(store)) == await labels(mapper)


async def test_the_same_edit_again_changes_nothing_and_is_answered_alike(
    store: Store, mapper: Mapper
) -> None:
    request = asked(Rename("o000001", "mug"))
    deltas = await asyncio.gather(*(mapper.edit(SCENE, request) for _ in range(5)))
    later = await a_mapper(store).edit(SCENE, request)

    assert all(delta == later for delta in deltas)
    assert await store.length(SCENE, "edits") == 1
    assert (await mapper.get_map(SCENE)).version == later.version


async def test_an_edit_id_names_one_edit_for_good(mapper: Mapper) -> None:
    await mapper.edit(SCENE, asked(Rename("o000001", "mug")))

    with pytest.raises(InvalidInput, match="edit_id 'e1': it already names another edit of scene kitchen"):
        await mapper.edit(SCENE, asked(Rename("o000001", "jug")))
    with pytest.raises(InvalidInput, match="already names another edit"):
        await mapper.edit(SCENE, dataclasses.replace(asked(Rename("o000001", "mug")), made_on_version=3))


@pytest.mark.parametrize("edit_id", ["", "a\nb", "x" * 201])
async def test_an_edit_id_that_cannot_name_an_edit_is_refused(mapper: Mapper, edit_id: str) -> None:
    with pytest.raises(InvalidInput, match="edit_id: expected 1 to 200 printable characters"):
        await mapper.edit(SCENE, asked(Rename("o000001", "mug"), edit_id))


async def test_an_edit_made_on_an_older_version_conflicts_once_and_for_all(
    store: Store, mapper: Mapper
) -> None:
    await mapper.edit(SCENE, asked(Rename("o000001", "mug")))
    before = await mapper.get_map(SCENE)

    for _ in range(2):
        with pytest.raises(Conflict, match="after version 7"):
            await mapper.edit(SCENE, asked(Rename("o000001", "jug"), "late", 7))
    with pytest.raises(Conflict, match="after version 7"):
        await a_mapper(store).edit(SCENE, asked(Rename("o000001", "jug"), "late", 7))

    assert (await mapper.get_map(SCENE)).state_hash == before.state_hash
    assert (await mapper.get_map(SCENE)).version == before.version


async def test_what_cannot_be_edited_is_refused_in_words_and_the_next_edit_goes_on(mapper: Mapper) -> None:
    with pytest.raises(NotFound, match="o000099"):
        await mapper.edit(SCENE, asked(Delete("o000099"), "wrong"))
    with pytest.raises(InvalidInput, match="made_on_version"):
        await mapper.edit(SCENE, asked(Delete("o000001"), "early", 1000))
    with pytest.raises(NotFound, match="there is no scene 'attic'"):
        await mapper.edit("attic", asked(Delete("o000001"), "nowhere"))

    await mapper.edit(SCENE, asked(Rename("o000001", "mug")))

    assert (await labels(mapper))["o000001"] == "mug"


async def test_a_replica_that_does_not_write_edits_as_well(store: Store, mapper: Mapper) -> None:
    reader = a_mapper(store)

    delta = await reader.edit(SCENE, asked(Rename("o000001", "mug")))

    assert (await reader.get_map(SCENE)).version == delta.version
    assert await labels(reader) == await labels(mapper)


async def test_an_edit_waits_in_the_log_where_nobody_writes_and_is_done_when_one_does(store: Store) -> None:
    newest = await write(store, SEEN)
    async with following(store) as mapper:
        await applied(mapper, newest)
    reader = a_mapper(store, answer_within_s=0.2)
    request = asked(Rename("o000001", "mug"))

    with pytest.raises(Unavailable, match="no mapper writes scene kitchen now; it stays queued"):
        await reader.edit(SCENE, request)
    assert (await labels(reader))["o000001"] == "cup"
    async with following(store):
        delta = await a_mapper(store).edit(SCENE, request)

    assert delta.updated == ("o000001",)
    assert (await labels(reader))["o000001"] == "mug"
    assert await store.length(SCENE, "edits") == 1


async def test_edits_come_between_frames_in_the_order_of_the_log(store: Store) -> None:
    """Whatever the order was, the log has it, and a replay has the same."""
    async with following(store) as mapper:
        newest = await write(store, SEEN[:3])
        await applied(mapper, newest)
        edits = [
            asyncio.create_task(mapper.edit(SCENE, asked(Rename("o000001", f"mug {n}"), f"e{n}", 5 + n)))
            for n in range(3)
        ]
        newest = await write(store, random_run(3, 12, dimension=8))
        await asyncio.wait(edits)
        live = await applied(mapper, newest)

    assert (await a_mapper(store).get_map(SCENE)).state_hash == live.state_hash
    assert (await mapper.verify(SCENE)).holds


async def test_an_entry_of_the_edits_log_that_asks_for_nothing_is_refused_and_passed(
    store: Store, mapper: Mapper
) -> None:
    for n, fields in enumerate(
        (
            {"kind": "dance"},
            {"kind": "edit", "request": b"\xff\xff"},
            {"kind": "join"},
            {"kind": "join", "world_from_other": "{}", "other_map": "x"},
        )
    ):
        await store.append_once(SCENE, "edits", f"odd{n}", {**fields, "edit_id": f"odd{n}"})

    await mapper.edit(SCENE, asked(Rename("o000001", "mug")))

    verdicts = await store.values(SCENE, "mapper", [f"verdict:odd{n}" for n in range(4)])
    assert [json.loads(verdict)["slug"] for verdict in verdicts.values()] == 4 * ["corrupt"]
    assert (await labels(mapper))["o000001"] == "mug"


async def test_an_edit_that_the_mapper_fails_at_stops_nothing(
    store: Store, mapper: Mapper, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half done, even: the map is read back from the log."""
    before = await mapper.get_map(SCENE)
    do = ObjectMap.edit

    def half_done(self: ObjectMap, request: EditRequest) -> MapDelta:
        do(self, request)
        raise IndexError("list index out of range")

    monkeypatch.setattr(ObjectMap, "edit", half_done)
    with pytest.raises(OvipError, match="the mapper failed at this edit: IndexError"):
        await mapper.edit(SCENE, asked(Delete("o000002"), "bad"))
    monkeypatch.undo()
    assert (await mapper.get_map(SCENE)).state_hash == before.state_hash

    await mapper.edit(SCENE, asked(Rename("o000001", "mug")))

    assert await labels(mapper) == {"o000001": "mug", "o000002": "bowl", "o000003": "shelf"}


async def test_an_edit_of_a_scene_without_frames_is_refused_in_words(store: Store) -> None:
    await store.add_scene(SCENE)
    async with following(store) as mapper:
        with pytest.raises(InvalidInput, match="made_on_version: expected a version of the map"):
            await mapper.edit(SCENE, asked(Rename("o000001", "mug"), made_on=0))
        with pytest.raises(NotFound, match="o000001"):
            await mapper.edit(SCENE, asked(Rename("o000001", "mug"), "e2", 1))


async def test_an_edit_larger_than_any_is_refused(store: Store, mapper: Mapper) -> None:
    many = tuple(f"o{n:06d}" for n in range(200_000))

    with pytest.raises(TooLarge, match="edit: expected at most 1000000 bytes"):
        await mapper.edit(SCENE, asked(Merge("o000001", many)))

    assert await store.length(SCENE, "edits") == 0


# Joining


def kept_up(made: ObjectMap) -> None:
    """As the writer does after any step."""
    if made.upkeep_due:
        made.upkeep()


async def test_another_scene_is_joined_as_it_stands_then(store: Store, mapper: Mapper) -> None:
    newest = await write(store, SEEN, OTHER)
    async with following(store, scenes=(OTHER,)) as there:
        await applied(there, newest, OTHER)
        delta, ids = await mapper.join(SCENE, OTHER, shifted(10.0), "j1")
        again, ids_again = await a_mapper(store).join(SCENE, OTHER, shifted(10.0), "j1")
        newest = await write(store, [batch(9, detection("lamp", (0, 5, 0), (0.2, 5.2, 1), axis(5)))], OTHER)
        await applied(there, newest, OTHER)
        much_later, _ = await mapper.join(SCENE, OTHER, shifted(10.0), "j1")
    made, here = expected(SEEN), expected(SEEN)
    here.join(made, shifted(10.0))
    kept_up(here)

    assert delta == again == much_later
    assert ids == ids_again
    assert ids == {"o000001": "o000004", "o000002": "o000005", "o000003": "o000006"}
    assert delta.kind is StepKind.JOIN
    assert (await mapper.get_map(SCENE)).state_hash == here.state_hash()
    assert (await a_mapper(store).get_map(SCENE)).state_hash == here.state_hash()
    assert (await mapper.verify(SCENE)).holds


async def test_a_scene_without_frames_can_be_joined_into(store: Store) -> None:
    newest = await write(store, SEEN, OTHER)
    await store.add_scene(SCENE)
    async with following(store, scenes=(SCENE, OTHER)) as mapper:
        await applied(mapper, newest, OTHER)
        delta, ids = await mapper.join(SCENE, OTHER, np.eye(4), "j1")
    made = ObjectMap()
    made.adopt(SETTINGS.map_params())
    made.join(expected(SEEN), np.eye(4))
    kept_up(made)

    assert delta.version == 2
    assert len(ids) == 3
    assert (await a_mapper(store).get_map(SCENE)).state_hash == made.state_hash()


async def test_a_join_that_cannot_be_is_refused_in_words(store: Store, mapper: Mapper) -> None:
    before = await mapper.get_map(SCENE)
    await write(store, [batch(1, detection("cup", feature=axis(0, 16)))], OTHER)
    newest = (await store.newest(OTHER, "detections"))[0].id
    async with following(store, scenes=(OTHER,)) as there:
        await applied(there, newest, OTHER)
    skewed = np.eye(4)
    skewed[0, 0] = 2.0

    with pytest.raises(InvalidInput, match="expected another scene than kitchen"):
        await mapper.join(SCENE, SCENE, np.eye(4), "j1")
    with pytest.raises(NotFound, match="there is no scene 'cellar'"):
        await mapper.join(SCENE, "cellar", np.eye(4), "j2")
    with pytest.raises(InvalidInput, match="expected a finite 4x4"):
        await mapper.join(SCENE, OTHER, np.full((4, 4), np.nan), "j3")
    with pytest.raises(InvalidInput, match="world_from_other"):
        await mapper.join(SCENE, OTHER, skewed, "j4")
    with pytest.raises(InvalidInput, match="expected features of 8 numbers like this map's, got 16"):
        await mapper.join(SCENE, OTHER, np.eye(4), "j5")
    with pytest.raises(InvalidInput, match="already names another edit"):
        await mapper.join(SCENE, OTHER, shifted(1.0), "j5")

    assert (await mapper.get_map(SCENE)).state_hash == before.state_hash


async def test_a_join_whose_map_is_lost_is_refused_and_what_was_joined_says_what_is_missing(
    store: Store,
) -> None:
    newest, there = await write(store, SEEN), await write(store, SEEN, OTHER)
    async with following(store, scenes=(SCENE, OTHER)) as mapper:
        await applied(mapper, newest)
        await applied(mapper, there, OTHER)
        await store.append_once(
            SCENE,
            "edits",
            "lost",
            {
                "kind": "join",
                "edit_id": "lost",
                "other": OTHER,
                "world_from_other": json.dumps(np.eye(4).ravel().tolist()),
                "other_map": "0" * 64,
            },
        )
        with pytest.raises(NotFound, match="blob 0000"):
            await mapper.join(SCENE, OTHER, np.eye(4), "lost")
        delta, _ = await mapper.join(SCENE, OTHER, np.eye(4), "j1")
    ref = (await store.read_entry(SCENE, "map", f"{delta.version}-0")).fields["other_map"].decode()  # type: ignore[union-attr]
    (store.blobs._root / ref[:2] / ref).unlink()  # type: ignore[attr-defined]
    await store._client.delete("{default/kitchen}:stream:snapshots")

    with pytest.raises(
        Corrupt, match=f"version {delta.version} of the map log, made by join, cannot be made"
    ):
        await History(store).at(SCENE, delta.version)


async def test_sizes_are_known_without_opening_maps(store: Store, mapper: Mapper) -> None:
    await mapper.edit(SCENE, asked(Delete("o000002")))
    for ref in {e.fields["batch"] for e in await store.read(SCENE, "detections")}:
        (store.blobs._root / ref.decode()[:2] / ref.decode()).unlink()  # type: ignore[attr-defined]

    (summary,) = await a_mapper(store).list_scenes()

    assert (summary.objects, summary.frames, summary.detections) == (2, 5, 15)
    assert summary.map_version == len(made_of(SEEN)[1]) + 1
