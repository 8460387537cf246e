"""A map's past: as it was read then, what differs since, and the proof that the log makes what is in use."""

from __future__ import annotations

import asyncio
import dataclasses
from pathlib import Path

import numpy as np
import pytest

from ovip.codec import decode_detection_batch, encode_detection_batch
from ovip.errors import Corrupt, InvalidInput, NotConfigured, NotFound
from ovip.scene.edits import Delete, EditRequest, Merge, Rename
from ovip.scene.types import F32, F64
from ovip.scene.versions import Alignment
from ovip.store import Store
from services.mapper.service import Mapper
from tests.builders import axis, batch, block, detection
from tests.integration.mappers import (
    OTHER,
    RUN,
    SCENE,
    SETTINGS,
    a_life,
    a_mapper,
    applied,
    following,
    write,
)

CUP = detection("cup", (0, 0, 0), (0.2, 0.2, 0.2), axis(0))
BOWL = detection("bowl", (1, 0, 0), (1.3, 0.3, 0.1), axis(1))
LAMP = detection("lamp", (3, 0, 0), (3.2, 0.3, 1.0), axis(2))


def file_of(store: Store, ref: bytes | str) -> Path:
    root: Path = store.blobs._root  # type: ignore[attr-defined]
    name = ref if isinstance(ref, str) else ref.decode()
    return root / name[:2] / name


# As of a version


async def test_a_version_reads_later_as_it_was_read_then(store: Store) -> None:
    then = {}
    async with following(store) as mapper:
        for one in RUN:
            seen = await applied(mapper, await write(store, [one]))
            then[seen.version] = (seen.state_hash, seen.applied_log_id, len(seen.objects))
        reader = a_mapper(store)
        for version, (state_hash, log_id, objects) in then.items():
            now = await reader.get_map(
                SCENE, include_unconfirmed=True, at_version=version, include_departed=True
            )
            assert (now.version, now.state_hash) == (version, state_hash)
            assert (now.applied_log_id, len(now.objects)) == (log_id, objects)

    assert len(then) == len(RUN)


async def test_a_version_that_is_not_made_yet_is_refused_naming_the_newest(store: Store) -> None:
    newest = await write(store, RUN[:5])
    async with following(store) as mapper:
        version = (await applied(mapper, newest)).version
        for wrong in (version + 1, 10**15, -1):
            with pytest.raises(InvalidInput, match=f"expected 0 to {version}, the newest of scene kitchen"):
                await mapper.get_map(SCENE, at_version=wrong)
        with pytest.raises(NotFound, match="no scene"):
            await mapper.get_map("attic", at_version=1)
        assert (await mapper.get_map(SCENE, at_version=version)).version == version
        assert (await mapper.get_map(SCENE, at_version=1)).objects == ()


# What differs


async def test_a_diff_names_what_came_what_went_and_what_changed(store: Store) -> None:
    newest = await write(store, [batch(n, CUP, BOWL) for n in range(1, 4)])
    async with following(store) as mapper:
        first = (await applied(mapper, newest)).version
        newest = await write(store, [batch(n, BOWL, LAMP) for n in (4, 5)])
        await applied(mapper, newest)
        await mapper.edit(SCENE, EditRequest("e1", first, "test", Delete("o000001")))
        second = (
            await mapper.edit(SCENE, EditRequest("e2", first, "test", Rename("o000002", "dish")))
        ).version
        diff = await mapper.diff(SCENE, first, second)
        to_now = await mapper.diff(SCENE, first)
        nothing = await mapper.diff(SCENE, second, second)
    by_id = {change.object_id: change for change in diff.changes}

    assert (diff.from_version, diff.to_version) == (first, second)
    assert to_now.to_version == second
    assert [c.object_id for c in to_now.changes] == [c.object_id for c in diff.changes]
    assert list(by_id) == ["o000001", "o000002", "o000003"]
    cup, bowl, lamp = by_id.values()
    assert cup.before is not None
    assert (cup.after, cup.merged_into, cup.fields) == (None, "", ())
    assert bowl.before is not None
    assert bowl.after is not None
    assert (bowl.before.label, bowl.after.label) == ("bowl", "dish")
    assert {"label", "label_given", "observations", "frames", "last_seen_ns"} <= set(bowl.fields)
    assert "box" not in bowl.fields
    assert lamp.before is None
    assert lamp.after is not None
    assert lamp.after.label == "lamp"
    assert nothing.changes == ()


async def test_a_diff_follows_what_was_merged_to_its_survivor(store: Store) -> None:
    newest = await write(store, [batch(n, CUP, BOWL, LAMP) for n in range(1, 4)])
    async with following(store) as mapper:
        first = (await applied(mapper, newest)).version
        await mapper.edit(SCENE, EditRequest("e1", first, "test", Merge("o000002", ("o000001",))))
        await mapper.edit(SCENE, EditRequest("e2", first + 1, "test", Merge("o000003", ("o000002",))))
        diff = await mapper.diff(SCENE, first)
    gone = {c.object_id: c.merged_into for c in diff.changes if c.after is None}

    assert gone == {"o000001": "o000003", "o000002": "o000003"}
    assert [c.object_id for c in diff.changes if c.after] == ["o000003"]


async def test_a_diff_goes_forward_only(store: Store) -> None:
    newest = await write(store, RUN[:5])
    async with following(store) as mapper:
        version = (await applied(mapper, newest)).version
        with pytest.raises(InvalidInput, match="from_version: expected 0 to 2, the later version, got 3"):
            await mapper.diff(SCENE, 3, 2)
        with pytest.raises(InvalidInput, match=f"expected 0 to {version}, the newest"):
            await mapper.diff(SCENE, 1, version + 1)
        everything = await mapper.diff(SCENE, 0)

    assert [c.object_id for c in everything.changes] == [
        o.object_id for o in (await mapper.get_map(SCENE, include_departed=True)).objects
    ]


# The proof


async def test_a_map_of_steps_of_every_kind_is_proven(store: Store) -> None:
    live = await a_life(store)

    proof = await a_mapper(store).verify(SCENE)

    assert proof.holds
    assert (proof.version, proof.steps) == (live.version, live.version)
    assert proof.state_hash == proof.rebuilt_hash == live.state_hash
    assert proof.snapshots == await store.length(SCENE, "snapshots") > 0


async def test_an_empty_map_is_proven(store: Store) -> None:
    await store.add_scene(SCENE)

    proof = await a_mapper(store).verify(SCENE)

    assert proof.holds
    assert (proof.version, proof.steps, proof.snapshots) == (0, 0, 0)


async def test_a_map_whose_log_was_changed_is_not_proven(store: Store) -> None:
    """An entry names another batch than the one that made the map: it parses, and tells a lie."""
    newest = await write(store, RUN)
    async with following(store) as mapper:
        live = await applied(mapper, newest)
        entries = await store.read(SCENE, "map", count=1000)
        key = "{default/kitchen}:stream:map"
        await store._client.delete(key)
        refs = [e.fields["batch"] for e in entries if "batch" in e.fields]
        for entry in entries:
            lie = {"batch": refs[0]} if entry.id == "8-0" else {}
            await store._client.xadd(key, {**entry.fields, **lie}, entry.id)

        proof = await mapper.verify(SCENE)

    assert not proof.holds
    assert proof.state_hash == live.state_hash != proof.rebuilt_hash
    assert min(proof.differing_versions) == 8


async def test_a_map_in_use_that_is_not_the_log_s_is_not_proven(store: Store) -> None:
    newest = await write(store, RUN)
    async with following(store) as mapper:
        await applied(mapper, newest)
        mapper._maps._open[SCENE].objects.detections += 1

        proof = await mapper.verify(SCENE)

    assert not proof.holds
    assert proof.differing_versions == ()


async def test_a_changed_batch_is_found(store: Store) -> None:
    newest = await write(store, RUN)
    async with following(store) as mapper:
        await applied(mapper, newest)
        entry = (await store.read(SCENE, "detections"))[6]
        file = file_of(store, entry.fields["batch"])
        file.write_bytes(encode_detection_batch(decode_detection_batch(file.read_bytes())) + b"\0")

        with pytest.raises(
            Corrupt, match="of the map log, made by frame, cannot be made again: blob .* hash"
        ):
            await mapper.verify(SCENE)


async def test_a_snapshot_that_would_not_open_is_found_before_it_is_needed(store: Store) -> None:
    newest = await write(store, RUN)
    async with following(store) as mapper:
        await applied(mapper, newest)
        record = mapper._maps._open[SCENE].base
        assert record is not None
        file_of(store, record.segments[-1]).unlink()

        proof = await mapper.verify(SCENE)

    assert not proof.holds
    assert proof.differing_versions == (record.version,)
    assert proof.state_hash == proof.rebuilt_hash


async def test_frames_and_reads_go_on_while_a_map_is_proven(store: Store) -> None:
    newest = await write(store, 4 * RUN)
    async with following(store) as mapper:
        version = (await applied(mapper, newest)).version
        proving = asyncio.create_task(mapper.verify(SCENE))
        reads = 0
        newest = await write(store, RUN)
        while not proving.done():
            await mapper.get_map(SCENE)
            reads += 1
            await asyncio.sleep(0.005)
        later = await applied(mapper, newest)

    assert (await proving).holds
    assert reads > 3
    assert later.version > version


# Aligning


class _Noting:
    """Says that nothing moved, and notes what it was given."""

    def align(self, cloud: F32, other: F32, guess: F64 | None) -> Alignment:
        self.given = (cloud, other, guess)
        return Alignment(np.eye(4), 1.0, 0.0)


async def test_scenes_are_aligned_by_the_surface_of_all_their_frames(store: Store) -> None:
    floor, wall = block((0, 0, 0), (2, 2, 0.01), 0.02), block((0, 0, 0), (0.01, 2, 2), 0.02)
    await write(store, [dataclasses.replace(batch(n), surface=s) for n, s in enumerate((floor, wall), 1)])
    await write(store, [dataclasses.replace(batch(1), surface=floor)], OTHER)
    noting = _Noting()
    mapper = Mapper(store, SETTINGS.map_params(), aligner=noting)

    found = await mapper.align(SCENE, OTHER, np.eye(4))
    cloud, other, guess = noting.given

    assert found.overlap == 1.0
    assert np.array_equal(guess, np.eye(4))
    assert cloud.max(axis=0)[2] > 1.9
    assert other.max(axis=0)[2] < 0.06
    assert 1500 < len(other) < 1800  # 41 x 41 cells of 5 cm
    assert len(cloud) > len(other) + 1400


async def test_without_an_aligner_or_a_scene_to_align_with_it_is_said(store: Store) -> None:
    await store.add_scene(SCENE)
    await store.add_scene(OTHER)
    with pytest.raises(NotConfigured, match="nothing to align scenes with"):
        await a_mapper(store).align(SCENE, OTHER)
    with pytest.raises(NotFound, match="no scene 'cellar'"):
        await a_mapper(store).align(SCENE, "cellar")
