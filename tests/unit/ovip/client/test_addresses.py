"""Finding a stack: the one that runs over the data directory, else the settings."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from ovip.client import Addresses
from ovip.client.addresses import running_stack
from ovip.errors import Corrupt
from tests.builders import kernel_settings

SERVICES = {
    name: f"127.0.0.1:{n}"
    for n, name in enumerate(("perception", "mapper", "regions", "retrieval", "api"), 1)
}


def _written(folder: Path, **changes: object) -> Path:
    stack = {"pid": os.getpid(), "addresses": SERVICES, "api_key": "key", **changes}
    (folder / "stack.json").write_text(json.dumps(stack))
    return folder


def _dead_pid() -> int:
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def test_a_running_stack_is_found_with_its_key(tmp_path: Path) -> None:
    found = Addresses.discover(kernel_settings(_written(tmp_path), api_key="another"))

    assert (found.perception, found.api, found.api_key) == ("127.0.0.1:1", "127.0.0.1:5", "key")


def test_without_a_stack_the_settings_say_where(tmp_path: Path) -> None:
    found = Addresses.discover(kernel_settings(tmp_path, mapper_address="mapper:7", api_key="theirs"))

    assert (found.mapper, found.api_key) == ("mapper:7", "theirs")


def test_a_stack_whose_process_is_gone_is_not_found(tmp_path: Path) -> None:
    assert running_stack(_written(tmp_path, pid=_dead_pid())) is None


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '"x"', "{}"])
def test_a_broken_note_is_no_stack(text: str, tmp_path: Path) -> None:
    (tmp_path / "stack.json").write_text(text)

    assert running_stack(tmp_path) is None


def test_a_note_without_addresses_is_corrupt_in_words() -> None:
    with pytest.raises(Corrupt, match=r"stack\.json: expected addresses"):
        Addresses.of_stack({"pid": 1})
