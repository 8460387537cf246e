"""What the api has to give, fetched, and files written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx

from ovip.client import Addresses
from ovip.errors import InvalidInput, Unavailable, from_status


def fetch(addresses: Addresses, scene: str, path: str, **params: Any) -> bytes:
    """The body of `/v1/scenes/SCENE/PATH`; what the api refuses is raised as the error that it stands for."""
    headers = {"authorization": f"Bearer {addresses.api_key}"} if addresses.api_key else {}
    url = f"http://{addresses.api}/v1/scenes/{quote(scene, safe='')}/{path}"
    given = {name: value for name, value in params.items() if value is not None}
    try:
        reply = httpx.get(url, params=given, headers=headers, timeout=120.0, trust_env=False)
    except httpx.HTTPError as error:
        raise Unavailable(f"the api at {addresses.api} cannot be reached: {error}") from error
    if reply.is_error:
        problem = reply.json() if "json" in reply.headers.get("content-type", "") else {}
        slug = str(problem.get("type", "")).rpartition(":")[2]
        raise from_status("UNKNOWN", str(problem.get("detail", reply.reason_phrase)), slug)
    return reply.content


def write_whole(option: str, file: Path, data: bytes) -> None:
    """Puts `data` where `file` is, at one stroke: a reader finds what was there before or all of it.

    InvalidInput names the option where it cannot be written.
    """
    try:
        descriptor, beside = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
        try:
            with os.fdopen(descriptor, "wb") as stream:
                stream.write(data)
            os.chmod(beside, 0o666 & ~_umask())
            os.replace(beside, file)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(beside)
            raise
    except OSError as error:
        raise InvalidInput(f"{option}: {file} cannot be written: {error.strerror}") from error


def write_all(option: str, folder: Path, files: dict[str, bytes]) -> None:
    """Files by name into a folder, which is made where it is missing."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidInput(f"{option}: {folder} cannot be made: {error.strerror}") from error
    for name, data in files.items():
        write_whole(option, folder / name, data)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
