"""One cache file: what is read is what was written, or an error that says why not."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lab.simulation.imperfect import (
    NOISY,
    CacheHeader,
    FeatureModel,
    SeenFrame,
    Thing,
    header_for,
    imperfect_batches,
    read_cache,
    write_cache,
)
from ovip.codec import encode_detection_batch
from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import DetectionBatch

HEADER = header_for("table", 7, NOISY, FeatureModel(("mug", "table")), 4)


@pytest.fixture(scope="module")
def batches(tabletop: list[SeenFrame], things: tuple[Thing, ...]) -> list[DetectionBatch]:
    return list(imperfect_batches(tabletop[:4], things, NOISY, 7))


@pytest.fixture(scope="module")
def written(batches: list[DetectionBatch], tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("cache") / "table.det"
    assert write_cache(path, HEADER, batches) == 4
    return path.read_bytes()


def read_all(path: Path) -> tuple[CacheHeader, list[bytes]]:
    header, batches = read_cache(path)
    return header, [encode_detection_batch(batch) for batch in batches]


def test_what_is_read_is_what_was_written(
    written: bytes, batches: list[DetectionBatch], tmp_path: Path
) -> None:
    path = tmp_path / "a.det"
    path.write_bytes(written)
    header, found = read_all(path)
    assert header == HEADER and header.params["swallows_carrier"] == NOISY.swallows_carrier
    assert found == [encode_detection_batch(batch) for batch in batches]


def test_the_same_batches_give_the_same_bytes(
    written: bytes, batches: list[DetectionBatch], tmp_path: Path
) -> None:
    write_cache(tmp_path / "again.det", HEADER, iter(batches))
    assert (tmp_path / "again.det").read_bytes() == written


def test_an_empty_cache_is_a_cache(tmp_path: Path) -> None:
    assert write_cache(tmp_path / "empty.det", HEADER, []) == 0
    assert read_all(tmp_path / "empty.det") == (HEADER, [])


def test_the_batches_may_be_read_twice_from_two_openings_at_once(written: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.det"
    path.write_bytes(written)
    (_, first), (_, second) = read_cache(path), read_cache(path)
    pairs = list(zip(first, second, strict=True))
    assert len(pairs) == 4 and all(a.frame_id == b.frame_id for a, b in pairs)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_cut_anywhere_is_known(written: bytes, tmp_path: Path, share: float) -> None:
    path = tmp_path / "cut.det"
    path.write_bytes(written[: int(share * len(written))])
    with pytest.raises((Corrupt, InvalidInput), match=r"cut\.det"):
        read_cache(path)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0, 1, exclude_max=True), flip=st.integers(1, 255))
def test_a_changed_byte_is_known_or_changes_nothing(
    written: bytes, batches: list[DetectionBatch], tmp_path: Path, share: float, flip: int
) -> None:
    at = int(share * len(written))
    path = tmp_path / "bad.det"
    path.write_bytes(written[:at] + bytes([written[at] ^ flip]) + written[at + 1 :])
    try:
        found = read_all(path)
    except (Corrupt, InvalidInput):
        return
    # the compressor's hints on how much memory to keep, and the like
    assert found == (HEADER, [encode_detection_batch(batch) for batch in batches])


def test_batches_before_the_damage_are_read_and_the_damaged_one_is_not(
    written: bytes, batches: list[DetectionBatch], tmp_path: Path
) -> None:
    path = tmp_path / "late.det"
    late = len(written) - 40
    path.write_bytes(written[:late] + bytes([written[late] ^ 1]) + written[late + 1 :])
    _, found = read_cache(path)
    whole = []
    with pytest.raises(Corrupt, match="damaged"):
        whole.extend(encode_detection_batch(batch) for batch in found)
    assert whole == [encode_detection_batch(batch) for batch in batches[: len(whole)]]


def test_what_is_no_cache_is_told_apart(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="expected a detection cache"):
        read_cache(tmp_path / "missing.det")
    (tmp_path / "text.det").write_text("not a cache at all")
    with pytest.raises(InvalidInput, match="another kind of file"):
        read_cache(tmp_path / "text.det")


def test_another_version_is_refused(tmp_path: Path) -> None:
    write_cache(tmp_path / "new.det", CacheHeader("x", 0, {}, "s", (), version=2), [])
    with pytest.raises(InvalidInput, match="version 1, got 2"):
        read_cache(tmp_path / "new.det")


def test_a_write_that_fails_leaves_the_old_cache(
    written: bytes, batches: list[DetectionBatch], tmp_path: Path
) -> None:
    path = tmp_path / "kept.det"
    path.write_bytes(written)

    def failing() -> Iterator[DetectionBatch]:
        yield batches[0]
        raise InvalidInput("no more")

    with pytest.raises(InvalidInput, match="no more"):
        write_cache(path, HEADER, failing())
    assert path.read_bytes() == written
    assert [p.name for p in tmp_path.iterdir()] == ["kept.det"]
