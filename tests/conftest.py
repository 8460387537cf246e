"""Fixtures that every test may use: a real store, the recordings, the embedded models."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import pytest_asyncio
from hypothesis import HealthCheck, settings
from redis.asyncio.retry import Retry

from ovip.store import Store
from services.perception.adapters import model_cache
from services.perception.config import Settings
from tests.builders import kernel_settings

# timings on a shared machine say nothing about a property
settings.register_profile("ovip", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("ovip")

_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest_asyncio.fixture
async def store(tmp_path: Path) -> AsyncIterator[Store]:
    """A store on a server of its own in a temporary directory; closed at the end."""
    opened = await Store.connect(kernel_settings(tmp_path / "data"))
    try:
        yield opened
    finally:
        if opened._server:
            opened._server._process.kill()  # its data goes with the directory: a gentle stop takes longer
        await opened.close()


@pytest.fixture
def no_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """A store that is away is given up at once, not after seconds of trying again."""
    monkeypatch.setattr("ovip.store.store.Retry", lambda backoff, _: Retry(backoff, 1))


@pytest.fixture(scope="session")
def data_root() -> Path:
    """The folder of recordings beside the project."""
    if not _DATA.is_dir():
        pytest.skip(f"there are no recordings in {_DATA}")
    return _DATA


@pytest.fixture(scope="session")
def models_dir() -> Path:
    """The folder of the embedded models' files, complete."""
    folder = Settings(_env_file=None).models_dir
    absent = model_cache.missing(folder)
    if absent:
        names = ", ".join(file.name for file in absent)
        pytest.skip(f"the embedded models are not in {folder} ({names}): run `ovip models pull embedded`")
    return folder
