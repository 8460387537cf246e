"""Blobs in a directory: content-addressed, all or nothing, damage is seen."""

from __future__ import annotations

import asyncio
import hashlib
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import ClassVar

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ovip.errors import Corrupt, InvalidInput, NotConfigured, NotFound, Unavailable
from ovip.store.blobs import DirectoryBlobs, open_blobs


def _files(root: Path) -> list[Path]:
    return sorted(path for path in root.rglob("*") if path.is_file())


@given(st.binary(max_size=1000))
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_bytes_come_back_by_their_hash(tmp_path: Path, data: bytes) -> None:
    async def put_and_get() -> None:
        blobs = DirectoryBlobs(tmp_path)
        ref = await blobs.put(data)

        assert ref == hashlib.sha256(data).hexdigest()
        assert await blobs.get(ref) == data

    asyncio.run(put_and_get())


async def test_the_same_bytes_are_kept_once(tmp_path: Path) -> None:
    blobs = DirectoryBlobs(tmp_path)

    refs = await asyncio.gather(*(blobs.put(b"same") for _ in range(8)))

    assert len(set(refs)) == 1
    assert len(_files(tmp_path)) == 1


async def test_a_finished_put_leaves_no_half_written_file(tmp_path: Path) -> None:
    blobs = DirectoryBlobs(tmp_path)

    refs = await asyncio.gather(*(blobs.put(bytes([n]) * 100_000) for n in range(10)))

    assert {path.name for path in _files(tmp_path)} == set(refs)


async def test_a_put_that_cannot_be_written_leaves_nothing_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blobs = DirectoryBlobs(tmp_path)

    def full_disk(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(Unavailable, match=r"blob of 5 bytes could not be stored.*No space left"):
        await blobs.put(b"bytes")

    assert _files(tmp_path) == []


@pytest.mark.parametrize("damage", [b"other bytes", b"", b"byte"])
async def test_a_damaged_file_is_corrupt(tmp_path: Path, damage: bytes) -> None:
    blobs = DirectoryBlobs(tmp_path)
    ref = await blobs.put(b"bytes")
    _files(tmp_path)[0].write_bytes(damage)

    with pytest.raises(Corrupt, match=f"blob {ref} does not hash to its name"):
        await blobs.get(ref)


async def test_an_absent_blob_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFound, match="is not in the blob store"):
        await DirectoryBlobs(tmp_path).get("ab" * 32)


async def test_a_blob_that_cannot_be_read_is_unavailable(tmp_path: Path) -> None:
    ref = "ab" * 32
    (tmp_path / "ab" / ref).mkdir(parents=True)

    with pytest.raises(Unavailable, match="could not be read"):
        await DirectoryBlobs(tmp_path).get(ref)


@pytest.mark.parametrize(
    "ref", ["", "short", "../../etc/passwd", "AB" * 32, "ab" * 31 + "/x", "ab" * 33, "é" * 64]
)
async def test_a_reference_that_is_none_never_touches_the_disk(tmp_path: Path, ref: str) -> None:
    with pytest.raises(InvalidInput, match="blob reference: expected 64 hex digits"):
        await DirectoryBlobs(tmp_path).get(ref)


def test_the_settings_choose_the_blob_store(tmp_path: Path) -> None:
    open_blobs(None, tmp_path)
    assert (tmp_path / "blobs").is_dir()

    open_blobs(f"file://{tmp_path}/elsewhere", tmp_path)
    assert (tmp_path / "elsewhere").is_dir()


@pytest.mark.parametrize("url", ["http://x/y", "s3:///prefix", "file:", "bucket"])
def test_a_blob_url_that_is_none_is_refused_in_words(url: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="OVIP_BLOB_URL: expected s3://bucket/prefix or file:///directory"):
        open_blobs(url, tmp_path)


def test_a_bucket_without_its_package_says_which_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "boto3", None)

    with pytest.raises(NotConfigured, match=r"ovip-sg\[s3\]"):
        open_blobs("s3://bucket/prefix", tmp_path)


def test_a_folder_that_cannot_be_made_is_refused_in_words(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")

    with pytest.raises(InvalidInput, match="OVIP_DATA_DIR: expected a writable directory"):
        open_blobs(None, tmp_path / "file")


# A bucket, spoken to by the real client over HTTP


class _Bucket(BaseHTTPRequestHandler):
    """As much of S3 as putting and getting objects takes."""

    objects: ClassVar[dict[str, bytes]] = {}

    def do_PUT(self) -> None:
        self.objects[self.path.partition("?")[0]] = self.rfile.read(int(self.headers["Content-Length"]))
        self._answer(200, b"")

    def do_GET(self) -> None:
        data = self.objects.get(self.path.partition("?")[0])
        if data is None:
            self._answer(404, b"<Error><Code>NoSuchKey</Code><Message>no</Message></Error>")
        else:
            self._answer(200, data)

    def log_message(self, *args: object) -> None:
        pass

    def _answer(self, status: int, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


@pytest.fixture
def bucket(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, bytes]]:
    pytest.importorskip("boto3", reason="the extra ovip-sg[s3] is not installed")
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Bucket)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    for name, value in {
        "AWS_ENDPOINT_URL": f"http://127.0.0.1:{server.server_port}",
        "AWS_ACCESS_KEY_ID": "key",
        "AWS_SECRET_ACCESS_KEY": "secret",
        "AWS_DEFAULT_REGION": "us-east-1",
        "AWS_REQUEST_CHECKSUM_CALCULATION": "when_required",
        "AWS_MAX_ATTEMPTS": "1",
        "NO_PROXY": "127.0.0.1",
    }.items():
        monkeypatch.setenv(name, value)
    _Bucket.objects.clear()
    yield _Bucket.objects
    server.shutdown()
    server.server_close()


async def test_a_bucket_keeps_blobs_under_its_prefix(bucket: dict[str, bytes], tmp_path: Path) -> None:
    blobs = open_blobs("s3://homes/blobs", tmp_path)

    ref = await blobs.put(b"bytes")

    assert list(bucket) == [f"/homes/blobs/{ref}"]
    assert await blobs.get(ref) == b"bytes"


async def test_a_bucket_says_what_is_absent_damaged_or_out_of_reach(
    bucket: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blobs = open_blobs("s3://homes", tmp_path)
    ref = await blobs.put(b"bytes")

    with pytest.raises(NotFound, match="is not in bucket homes"):
        await blobs.get("ab" * 32)
    bucket[f"/homes/{ref}"] = b"other"
    with pytest.raises(Corrupt, match=f"blob {ref} does not hash to its name"):
        await blobs.get(ref)
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:1")
    with pytest.raises(Unavailable, match="bucket homes"):
        await open_blobs("s3://homes", tmp_path).get(ref)


async def test_a_bucket_refuses_a_reference_that_is_none(bucket: dict[str, bytes], tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="blob reference: expected 64 hex digits"):
        await open_blobs("s3://homes", tmp_path).get("../secrets")
