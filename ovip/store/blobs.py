"""Blobs: bulk bytes by content hash, in a local directory or an S3-compatible bucket; the store keeps the reference."""

from __future__ import annotations

import asyncio
import hashlib
import os
import tempfile
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import urlparse

from ovip.errors import Corrupt, InvalidInput, NotConfigured, NotFound, Unavailable


class BlobStore(Protocol):
    """Content-addressed bytes: `put` returns once they are durable."""

    async def put(self, data: bytes) -> str: ...

    async def get(self, ref: str) -> bytes: ...


def open_blobs(url: str | None, data_dir: Path) -> BlobStore:
    """The blob store at `url` (`s3://bucket/prefix`, `file:///dir`), else `data_dir/blobs`."""
    if not url:
        return DirectoryBlobs(data_dir / "blobs")
    parsed = urlparse(url)
    if parsed.scheme == "file" and parsed.path:
        return DirectoryBlobs(Path(parsed.path))
    if parsed.scheme == "s3" and parsed.netloc:
        return S3Blobs(parsed.netloc, parsed.path.strip("/"))
    raise InvalidInput(f"OVIP_BLOB_URL: expected s3://bucket/prefix or file:///directory, got {url!r}")


class DirectoryBlobs:
    """One file a blob, written aside, synced, then renamed: a reader sees all of it or nothing."""

    def __init__(self, root: Path) -> None:
        self._root = root
        try:
            root.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InvalidInput(
                f"OVIP_DATA_DIR: expected a writable directory, {root}: {error.strerror}"
            ) from error

    async def put(self, data: bytes) -> str:
        return await asyncio.to_thread(self._write, data)

    async def get(self, ref: str) -> bytes:
        return await asyncio.to_thread(self._read, ref)

    def _write(self, data: bytes) -> str:
        ref = hashlib.sha256(data).hexdigest()
        target = self._path(ref)
        if target.exists():
            return ref
        try:
            if not target.parent.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                _sync_directory(self._root)
            handle, aside = tempfile.mkstemp(dir=target.parent)
            try:
                with os.fdopen(handle, "wb") as file:
                    file.write(data)
                    file.flush()
                    os.fsync(file.fileno())
                os.rename(aside, target)
            except OSError:
                Path(aside).unlink(missing_ok=True)
                raise
            _sync_directory(target.parent)
        except OSError as error:
            raise Unavailable(
                f"blob of {len(data)} bytes could not be stored in {self._root}: {error.strerror}"
            ) from error
        return ref

    def _read(self, ref: str) -> bytes:
        try:
            data = self._path(ref).read_bytes()
        except FileNotFoundError as error:
            raise NotFound(f"blob {ref} is not in the blob store") from error
        except OSError as error:
            raise Unavailable(f"blob {ref} could not be read from {self._root}: {error.strerror}") from error
        if hashlib.sha256(data).hexdigest() != ref:
            raise Corrupt(f"blob {ref} does not hash to its name: the file was changed or damaged")
        return data

    def _path(self, ref: str) -> Path:
        return self._root / ref[:2] / _checked(ref)


class S3Blobs:
    """Objects named by their hash in a bucket; credentials and endpoint by the standard AWS_ variables."""

    def __init__(self, bucket: str, prefix: str) -> None:
        try:
            import boto3
        except ImportError as error:
            raise NotConfigured(
                "OVIP_BLOB_URL names an S3 bucket: install the extra, pip install 'ovip-sg[s3]'"
            ) from error
        self._client: Any = boto3.client("s3")
        self._bucket, self._prefix = bucket, prefix

    async def put(self, data: bytes) -> str:
        ref = hashlib.sha256(data).hexdigest()
        await asyncio.to_thread(self._call, "put_object", Key=self._key(ref), Body=data)
        return ref

    async def get(self, ref: str) -> bytes:
        reply = await asyncio.to_thread(self._call, "get_object", Key=self._key(_checked(ref)))
        data: bytes = await asyncio.to_thread(reply["Body"].read)
        if hashlib.sha256(data).hexdigest() != ref:
            raise Corrupt(f"blob {ref} does not hash to its name: the object was changed or damaged")
        return data

    def _call(self, operation: str, **arguments: Any) -> Any:
        from botocore.exceptions import BotoCoreError, ClientError

        try:
            return getattr(self._client, operation)(Bucket=self._bucket, **arguments)
        except ClientError as error:
            if error.response.get("Error", {}).get("Code") in {"NoSuchKey", "404"}:
                raise NotFound(f"blob {arguments['Key']} is not in bucket {self._bucket}") from error
            raise Unavailable(f"bucket {self._bucket}: {error}") from error
        except BotoCoreError as error:
            raise Unavailable(f"bucket {self._bucket}: {error}") from error

    def _key(self, ref: str) -> str:
        return f"{self._prefix}/{ref}" if self._prefix else ref


def _checked(ref: str) -> str:
    if len(ref) != 64 or not all(letter in "0123456789abcdef" for letter in ref):
        raise InvalidInput(f"blob reference: expected 64 hex digits, got {ref[:80]!r}")
    return ref


def _sync_directory(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
