"""Settings of the api service."""

from __future__ import annotations

from pydantic import Field

from ovip.config import KernelSettings


class Settings(KernelSettings):
    """Where the api listens, and how long its event streams and checks wait."""

    api_port: int = Field(8080, ge=0, le=65535, description="port that the api listens on; 0: a free one")
    api_heartbeat_s: float = Field(
        15.0, gt=0, description="seconds of silence after which an event stream sends a comment to stay open"
    )
    api_ready_timeout_s: float = Field(
        2.0, gt=0, description="seconds within which every other service must be reached to be ready"
    )

    @property
    def port(self) -> int:
        """The port to listen on."""
        return self.api_port
