"""The command line beside a mapper that answers with known values."""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from ovip_cli.app import app
from tests.unit.services.mapper.recorded import Recorded, mapper_port

Run = Callable[..., Awaitable[Result]]


@pytest.fixture
async def kitchen() -> Recorded:
    return Recorded()


@pytest.fixture
async def ovip(kitchen: Recorded, tmp_path: Path) -> AsyncIterator[Run]:
    """Runs `ovip WORDS --data-dir ...` over a stack whose mapper is `kitchen`."""
    async with mapper_port(kitchen) as port:
        address = f"127.0.0.1:{port}"
        names = ("perception", "mapper", "regions", "retrieval", "api")
        stack = {"pid": os.getpid(), "addresses": dict.fromkeys(names, address), "api_key": ""}
        (tmp_path / "stack.json").write_text(json.dumps(stack))

        async def run(*words: str) -> Result:
            command = [*words, "--data-dir", str(tmp_path)]
            return await asyncio.to_thread(CliRunner().invoke, app, command)

        yield run
