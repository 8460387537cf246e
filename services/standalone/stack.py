"""A running stack: where its services answer, written down for the command line to find."""

from __future__ import annotations

import contextlib
import json
import os
import secrets
from collections.abc import AsyncIterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ovip.config import KernelSettings
from ovip.errors import InvalidInput
from ovip.serving import Serve
from ovip.store import Store
from services.api.__main__ import serve as serve_api
from services.api.config import Settings as ApiSettings
from services.mapper.__main__ import serve as serve_mapper
from services.mapper.config import Settings as MapperSettings
from services.perception.__main__ import serve as serve_perception
from services.perception.config import Settings as PerceptionSettings
from services.regions.__main__ import serve as serve_regions
from services.regions.config import Settings as RegionsSettings
from services.retrieval.__main__ import serve as serve_retrieval
from services.retrieval.config import Settings as RetrievalSettings
from services.standalone.config import Settings
from services.vlm_gateway.__main__ import serve as serve_gateway
from services.vlm_gateway.config import Settings as GatewaySettings

# from the one that asks nobody to the one that asks everybody
_ORDER: tuple[tuple[str, type[KernelSettings], Serve], ...] = (
    ("vlm_gateway", GatewaySettings, serve_gateway),
    ("mapper", MapperSettings, serve_mapper),
    ("perception", PerceptionSettings, serve_perception),
    ("regions", RegionsSettings, serve_regions),
    ("retrieval", RetrievalSettings, serve_retrieval),
    ("api", ApiSettings, serve_api),
)


@dataclass(frozen=True, slots=True)
class Stack:
    """Addresses `host:port` by service, and the key that calls must carry."""

    pid: int
    addresses: dict[str, str]
    api_key: str

    @property
    def dashboard(self) -> str:
        """The page, with the key in its link."""
        return f"http://{self.addresses['api']}/?key={self.api_key}"


@contextlib.asynccontextmanager
async def running_stack(settings: Settings) -> AsyncIterator[Stack]:
    """All services over one store, left to right; yields where they are, and stops them right to left."""
    key = settings.api_key or generated_key(settings.data_dir)
    async with contextlib.AsyncExitStack() as exits:
        store = await Store.connect(settings)
        exits.push_async_callback(store.close)
        addresses: dict[str, str] = {}
        for name, kind, serve in _ORDER:
            own = kind().model_copy(update=_overrides(name, settings, key, addresses))
            port = await exits.enter_async_context(serve(own, store))
            addresses[name] = f"{_reachable(settings.host)}:{port}"
        stack = Stack(os.getpid(), addresses, key)
        written = _write(settings.data_dir / "stack.json", asdict(stack))
        exits.callback(written.unlink, missing_ok=True)
        yield stack


def generated_key(data_dir: Path) -> str:
    """The key in `data_dir/api.key`, made on first use, readable by its owner only."""
    path = data_dir / "api.key"
    try:
        data_dir.mkdir(parents=True, exist_ok=True)
        if not path.exists():
            _write(path, secrets.token_urlsafe(24))
        return path.read_text().strip()
    except OSError as error:
        raise InvalidInput(
            f"OVIP_DATA_DIR: expected a writable directory, {data_dir}: {error.strerror}"
        ) from error


def _overrides(name: str, settings: Settings, key: str, addresses: dict[str, str]) -> dict[str, Any]:
    """What a service gets from the stack: its store and key, a free port if asked, and who is already up."""
    fields = ("redis_url", "data_dir", "blob_url", "host", "log_level", "log_json")
    shared = {field: getattr(settings, field) for field in fields}
    up = {f"{other}_address": address for other, address in addresses.items()}
    port = {f"{name}_port": 0} if settings.free_ports else {}
    return {**shared, "api_key": key, **port, **up}


def _reachable(host: str) -> str:
    return "127.0.0.1" if host in {"0.0.0.0", "::", "[::]"} else host


def _write(path: Path, value: Any) -> Path:
    text = value if isinstance(value, str) else json.dumps(value)
    aside = path.with_name(f".{path.name}.{os.getpid()}")
    handle = os.open(aside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(handle, "w") as file:
        file.write(text)
    aside.rename(path)
    return path
