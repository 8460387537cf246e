"""Mapped objects there and back, and whole maps in parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip import codec
from ovip.errors import Corrupt
from ovip.scene.types import (
    Box2,
    MapObject,
    Move,
    Presence,
    Relation,
    RelationKind,
    SceneMap,
)
from tests.builders import same
from tests.unit.ovip.map_objects import scene_map

NUMBERS = st.floats(-1e6, 1e6)
COUNTS = st.integers(0, 2**32 - 1)
TIMES = st.integers(0, 2**64 - 1)
IDS = st.text(max_size=8)


def vectors(size: int) -> st.SearchStrategy[np.ndarray]:
    return hnp.arrays(np.float64, size, elements=NUMBERS)


OBJECTS = st.builds(
    MapObject,
    object_id=IDS,
    label=IDS,
    label_counts=st.dictionaries(IDS, COUNTS, max_size=3),
    centroid=vectors(3),
    box=vectors(6),
    feature=hnp.arrays(np.float32, st.integers(0, 8), elements=st.floats(-1, 1, width=32)),
    view_weight=NUMBERS,
    observations=COUNTS,
    frames=COUNTS,
    first_seen_ns=TIMES,
    last_seen_ns=TIMES,
    voxels=COUNTS,
    mean_color=vectors(3),
    best_frame_id=IDS,
    best_box2=st.builds(Box2, NUMBERS, NUMBERS, NUMBERS, NUMBERS),
    version=TIMES,
    revision=TIMES,
    presence=st.sampled_from(Presence),
    pinned=st.booleans(),
    label_given=st.booleans(),
    relations=st.lists(
        st.builds(Relation, st.sampled_from(RelationKind), IDS, st.dictionaries(IDS, NUMBERS, max_size=2)),
        max_size=2,
    ).map(tuple),
    moves=st.lists(st.builds(Move, TIMES, vectors(3)), max_size=2).map(tuple),
)
MAPS = st.builds(SceneMap, IDS, TIMES, st.lists(OBJECTS, max_size=5).map(tuple), IDS, TIMES, TIMES, IDS)


@given(MAPS, st.integers(1, 2000))
def test_a_map_comes_back_the_same_from_parts_of_any_size(scene_map: SceneMap, part_bytes: int) -> None:
    parts = list(codec.map_parts(scene_map, part_bytes))

    assert all(part.objects for part in parts) or len(parts) == 1
    assert same(codec.map_value(parts), scene_map)


def test_parts_of_a_large_map_are_of_about_a_megabyte_and_few() -> None:
    sizes = [part.ByteSize() for part in codec.map_parts(scene_map(500, 2048))]

    assert max(sizes) < 1_050_000
    assert len(sizes) == 5  # 500 objects of 2048 numbers of 4 bytes are 4.2 MB


def test_an_object_larger_than_a_part_travels_alone() -> None:
    parts = list(codec.map_parts(scene_map(3, 2048), part_bytes=100))

    assert [len(part.objects) for part in parts] == [1, 1, 1]


def test_parts_of_different_versions_make_no_map() -> None:
    one = scene_map(1, 4)
    parts = [*codec.map_parts(one), *codec.map_parts(replace(one, version=8, state_hash="cd"))]

    with pytest.raises(Corrupt, match=r"expected parts of one version, got parts of 2 maps \(version 7, 8\)"):
        codec.map_value(parts)


def test_no_parts_at_all_are_corrupt() -> None:
    with pytest.raises(Corrupt, match="ended before its first part"):
        codec.map_value([])
