"""Settings of the stack in one process."""

from __future__ import annotations

from pydantic import Field

from ovip.config import KernelSettings


class Settings(KernelSettings):
    """What the whole stack needs besides each service's own settings."""

    free_ports: bool = Field(
        False, description="listen on any free ports instead of the fixed ones (`ovip up`)"
    )
