"""Where a stack answers."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from ovip.config import KernelSettings
from ovip.errors import Corrupt


@dataclass(frozen=True, slots=True)
class Addresses:
    """`host:port` of the services that a client speaks to, and the key of the stack."""

    perception: str = "127.0.0.1:50051"
    mapper: str = "127.0.0.1:50052"
    regions: str = "127.0.0.1:50053"
    retrieval: str = "127.0.0.1:50054"
    api: str = "127.0.0.1:8080"
    api_key: str | None = None

    @classmethod
    def discover(cls, settings: KernelSettings) -> Addresses:
        """The stack that runs over `data_dir`, where one does; else the addresses of the settings."""
        running = running_stack(settings.data_dir)
        if running:
            return cls.of_stack(running)
        return cls(
            settings.perception_address,
            settings.mapper_address,
            settings.regions_address,
            settings.retrieval_address,
            settings.api_address,
            settings.api_key,
        )

    @classmethod
    def of_stack(cls, stack: dict[str, object]) -> Addresses:
        """The addresses that a started stack printed or wrote to `stack.json`."""
        services, key = stack.get("addresses"), stack.get("api_key")
        if not isinstance(services, dict):
            raise Corrupt("stack.json: expected addresses of the services")
        return cls(
            services["perception"],
            services["mapper"],
            services["regions"],
            services["retrieval"],
            services["api"],
            str(key) if key else None,
        )


def running_stack(data_dir: Path) -> dict[str, object] | None:
    """What the stack over `data_dir` wrote about itself, if its process lives."""
    try:
        stack = json.loads((data_dir / "stack.json").read_text())
    except (OSError, ValueError):
        return None
    return stack if isinstance(stack, dict) and Path(f"/proc/{stack.get('pid')}").exists() else None
