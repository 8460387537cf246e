"""Points of objects in parts, an object going on from one to the next."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip import codec
from ovip.codec import Clouds
from ovip.errors import Corrupt
from ovip.v1 import mapper_pb2
from tests.builders import same


def clouds_of(*sizes: int) -> Clouds:
    rng = np.random.default_rng(5)
    return {
        f"o{i:06d}": (
            rng.normal(size=(size, 3)).astype(np.float32),
            rng.integers(0, 256, (size, 3), dtype=np.uint8),
        )
        for i, size in enumerate(sizes)
    }


@given(st.lists(st.integers(0, 40), max_size=5), st.integers(1, 400))
def test_clouds_come_back_the_same_from_parts_of_any_size(sizes: list[int], part_bytes: int) -> None:
    clouds = clouds_of(*sizes)

    version, again = codec.points_value(codec.points_parts(9, clouds, part_bytes))

    assert version == 9
    assert list(again) == list(clouds)
    assert all(same(again[object_id], clouds[object_id]) for object_id in clouds)


def test_a_cloud_of_many_parts_is_cut_into_messages_of_about_a_megabyte() -> None:
    sizes = [part.ByteSize() for part in codec.points_parts(1, clouds_of(1_000_000))]

    assert len(sizes) == 15 + 1  # a million points of 15 bytes, and what the last part could not hold
    assert max(sizes) < 1_050_000


def test_parts_of_different_versions_are_corrupt() -> None:
    parts = [*codec.points_parts(1, clouds_of(2)), *codec.points_parts(2, clouds_of(2))]

    with pytest.raises(Corrupt, match=r"expected parts of one version, got \[1, 2\]"):
        codec.points_value(parts)
    with pytest.raises(Corrupt, match="ended before its first part"):
        codec.points_value([])


def test_points_without_their_colours_are_corrupt() -> None:
    (part,) = codec.points_parts(1, clouds_of(2))
    part.objects[0].colors = b"\0" * 3

    with pytest.raises(Corrupt, match="object o000000: 24 bytes of points, 3 of colours"):
        codec.points_value([mapper_pb2.GetObjectPointsResponse.FromString(part.SerializeToString())])
