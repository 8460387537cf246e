"""The gateway's settings: its upstreams in fallback order, and how long it waits, retries and remembers."""

from __future__ import annotations

import json
import os
import re
from enum import StrEnum
from typing import Annotated, Any
from urllib.parse import urlsplit

from dotenv import dotenv_values
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SecretStr,
    ValidationError,
    field_validator,
    model_validator,
)
from pydantic_settings import NoDecode

from ovip.config import KernelSettings
from ovip.errors import InvalidInput

_HEADER_WORD = re.compile(r"[!-~]+")
_EXAMPLE = (
    '[{"name": "kimi", "base_url": "https://HOST/v1", "model": "kimi-k2.6", "api_key_env": "KIMI_API_KEY"}]'
)


class JsonMode(StrEnum):
    """How an upstream is told to answer in JSON: by schema, by a bare "object" flag, or by words alone."""

    SCHEMA = "schema"
    OBJECT = "object"
    PROMPT = "prompt"


class UpstreamSettings(BaseModel):
    """One OpenAI-compatible endpoint; a limit of 0 means none."""

    model_config = ConfigDict(extra="forbid", frozen=True, hide_input_in_errors=True)

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$")
    base_url: str
    model: str = Field(min_length=1)
    api_key: SecretStr | None = None
    api_key_env: str | None = None
    requests_per_minute: int = Field(0, ge=0)
    tokens_per_minute: int = Field(0, ge=0)
    max_concurrent: int = Field(8, ge=1)
    image_max_side: int = Field(1024, ge=64, le=8192)
    timeout_s: float = Field(60.0, gt=0, allow_inf_nan=False)
    json_mode: JsonMode = JsonMode.SCHEMA
    max_tokens_field: str = Field("max_tokens", pattern="^(max_tokens|max_completion_tokens)$")
    extra_body: dict[str, Any] = Field(default_factory=dict)

    @field_validator("base_url")
    @classmethod
    def _web_address(cls, value: str) -> str:
        parts = urlsplit(value)
        if parts.scheme not in ("http", "https") or not parts.hostname or parts.username or parts.query:
            raise ValueError("expected http(s)://host[:port]/path, without a user, a password or a query")
        return value.rstrip("/")

    @field_validator("api_key")
    @classmethod
    def _fits_a_header(cls, value: SecretStr | None) -> SecretStr | None:
        if value is not None and not _HEADER_WORD.fullmatch(value.get_secret_value()):
            raise ValueError("expected printable ASCII without spaces")
        return value

    @model_validator(mode="after")
    def _one_key(self) -> UpstreamSettings:
        if self.api_key is not None and self.api_key_env is not None:
            raise ValueError("expected at most one of api_key and api_key_env")
        return self


class Settings(KernelSettings):
    """What the gateway reads from the environment."""

    vlm_gateway_port: int = Field(
        50055, ge=0, le=65535, description="port the gateway listens on; 0: any free one"
    )
    vlm_upstreams: Annotated[tuple[UpstreamSettings, ...], NoDecode] = Field(
        (),
        description="JSON list of OpenAI-compatible VLM endpoints in fallback order; empty: no VLM",
        examples=[_EXAMPLE],
    )
    vlm_deadline_s: float = Field(
        60.0, gt=0, le=600, description="seconds a question may take when its caller names none"
    )
    vlm_max_output_tokens: int = Field(
        1024, ge=1, description="longest reply when the caller names no length"
    )
    vlm_cache_ttl_s: float = Field(
        7 * 86400.0, ge=0, description="seconds a reply is kept by content; 0: not kept"
    )
    vlm_attempts: int = Field(
        4, ge=1, le=10, description="calls to one upstream for one question, retries included"
    )
    vlm_jitter_seed: int | None = Field(
        None, description="seed of the retry jitter; empty: differs by process"
    )

    @property
    def port(self) -> int:
        """The port to listen on."""
        return self.vlm_gateway_port

    # InvalidInput passes through pydantic, whose own errors would carry the input and so the keys in it.
    @field_validator("vlm_upstreams", mode="before")
    @classmethod
    def _read_upstreams(cls, value: object) -> object:
        if not isinstance(value, str):
            return value
        return read_upstreams(value, _environment(cls.model_config.get("env_file")))


def read_upstreams(text: str, environment: dict[str, str]) -> tuple[UpstreamSettings, ...]:
    """Upstreams from their JSON list, each key named by `api_key_env` taken from `environment`.

    Raises InvalidInput that names the fault and never a value, because keys are among them.
    """
    if not text.strip():
        return ()
    try:
        entries = json.loads(text)
    except (ValueError, RecursionError):
        raise InvalidInput(f"OVIP_VLM_UPSTREAMS: not JSON; expected a list such as {_EXAMPLE}") from None
    if not isinstance(entries, list):
        raise InvalidInput(f"OVIP_VLM_UPSTREAMS: expected a JSON list such as {_EXAMPLE}")
    upstreams = tuple(_read_one(entry, number, environment) for number, entry in enumerate(entries))
    names = [upstream.name for upstream in upstreams]
    if len(set(names)) < len(names):
        raise InvalidInput(f"OVIP_VLM_UPSTREAMS: names must differ, got {', '.join(names)}")
    return upstreams


def _read_one(entry: object, number: int, environment: dict[str, str]) -> UpstreamSettings:
    try:
        upstream = UpstreamSettings.model_validate(entry)
    except ValidationError as error:
        faults = "; ".join(
            f"{'.'.join(str(part) for part in item['loc']) or 'entry'}: {item['msg']}"
            for item in error.errors()
        )
        raise InvalidInput(f"OVIP_VLM_UPSTREAMS[{number}]: {faults}") from None
    if upstream.api_key_env is None:
        return upstream
    key = environment.get(upstream.api_key_env, "")
    if not key:
        raise InvalidInput(
            f"OVIP_VLM_UPSTREAMS[{number}]: its key should be in {upstream.api_key_env}, which is not set"
        )
    if not _HEADER_WORD.fullmatch(key):
        raise InvalidInput(f"{upstream.api_key_env}: expected printable ASCII without spaces")
    return upstream.model_copy(update={"api_key": SecretStr(key), "api_key_env": None})


def _environment(env_file: Any) -> dict[str, str]:
    """The process's environment over the settings file's lines."""
    lines = dotenv_values(env_file) if env_file else {}
    return {**{name: value for name, value in lines.items() if value is not None}, **os.environ}
