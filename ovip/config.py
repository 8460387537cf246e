"""Settings that every service shares, read from the environment (`OVIP_...`) and `.env`."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field, ValidationError, field_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from ovip.errors import InvalidInput


class KernelSettings(BaseSettings):
    """Where the store, the blobs and the other services are, and how this process speaks."""

    model_config = SettingsConfigDict(env_prefix="OVIP_", env_file=".env", extra="ignore")

    redis_url: str | None = Field(
        None, description="Redis or Valkey to use; empty: supervise an embedded one"
    )
    data_dir: Path = Field(
        Path("~/.local/share/ovip").expanduser(), description="where the embedded store, blobs and key live"
    )
    blob_url: str | None = Field(None, description="s3://bucket/prefix for blobs; empty: data_dir/blobs")
    store_fsync: str = Field(
        "always", pattern="^(always|everysec)$", description="when the embedded store syncs its log"
    )
    api_key: str | None = Field(
        None, repr=False, description="key that every call must carry; required off loopback"
    )
    host: str = Field("127.0.0.1", description="address that services listen on")
    perception_address: str = Field("127.0.0.1:50051", description="where perception answers")
    mapper_address: str = Field("127.0.0.1:50052", description="where the mapper answers")
    regions_address: str = Field("127.0.0.1:50053", description="where regions answers")
    retrieval_address: str = Field("127.0.0.1:50054", description="where retrieval answers")
    vlm_gateway_address: str = Field("127.0.0.1:50055", description="where the VLM gateway answers")
    api_address: str = Field("127.0.0.1:8080", description="where the api answers, for the command line")
    log_level: str = Field("info", pattern="^(debug|info|warning|error)$", description="least level logged")
    log_json: bool = Field(False, description="log one JSON object a line")

    @field_validator("data_dir")
    @classmethod
    def _home(cls, path: Path) -> Path:
        return path.expanduser()


def explain(error: ValidationError) -> InvalidInput:
    """A settings error in words: which variable, what was wrong; never the value, which may be a secret."""
    lines = []
    for item in error.errors(include_input=False, include_url=False):
        name = "_".join(str(part) for part in item["loc"]).upper()
        lines.append(f"{name if name.startswith('OVIP_') else f'OVIP_{name}'}: {item['msg']}")
    return InvalidInput("wrong settings: " + "; ".join(lines))
