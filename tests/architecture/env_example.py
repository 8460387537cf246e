"""`.env.example` as the settings say it: `python -m tests.architecture.env_example > .env.example`."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import sys
from pathlib import Path
from typing import Any

from pydantic.fields import FieldInfo

import services
from ovip.config import KernelSettings

# What docker-compose.yml reads and no settings class does: name, value there, what it is for.
COMPOSE_ONLY = (
    ("OVIP_PUBLISH_ADDRESS", "127.0.0.1", "host address that the published ports are bound to"),
    ("OVIP_PUBLISH_API_PORT", "8080", "host port of the api and its dashboard"),
    ("OVIP_PUBLISH_PERCEPTION_PORT", "50051", "host port that robots stream frames to"),
    ("OVIP_PUBLISH_RETRIEVAL_PORT", "50054", "host port that searches are run over"),
    ("OVIP_PERCEPTION_REPLICAS", "1", "containers of the CPU perception; 0 with COMPOSE_PROFILES=gpu"),
    ("COMPOSE_PROFILES", "", "gpu: perception on an NVIDIA GPU"),
)
_HEADER = """\
# Settings of OVIP-SG. Copy to .env and change what should differ; a commented line shows the default.
# Every service reads .env from its working directory, the environment first; docker-compose.yml passes it on.
"""


def render() -> str:
    """The whole file."""
    sections = [("every service", own_fields(KernelSettings))]
    sections += [(name, own_fields(settings)) for name, settings in service_settings().items()]
    blocks = [_HEADER]
    for title, fields in sections:
        lines = [_lines(name, _text(field.default), *_comments(field)) for name, field in fields.items()]
        blocks.append("\n".join([f"# ---- {title} ----", *lines]) + "\n")
    compose = [_lines(name, value, purpose) for name, value, purpose in COMPOSE_ONLY]
    blocks.append("\n".join(["# ---- docker-compose.yml ----", *compose]) + "\n")
    return "\n".join(blocks)


def service_settings() -> dict[str, type[KernelSettings]]:
    """The settings class of every service that has one, by the service's name."""
    found: dict[str, type[KernelSettings]] = {}
    for module in sorted(pkgutil.iter_modules(services.__path__), key=lambda module: module.name):
        name = f"services.{module.name}.config"
        if importlib.util.find_spec(name) is not None:
            found[module.name] = importlib.import_module(name).Settings
    return found


def own_fields(settings: type[KernelSettings]) -> dict[str, FieldInfo]:
    """The fields that a class adds to those every service shares, by environment variable."""
    shared = set() if settings is KernelSettings else set(KernelSettings.model_fields)
    return {
        variable(settings, name): field for name, field in settings.model_fields.items() if name not in shared
    }


def variable(settings: type[KernelSettings], field: str) -> str:
    """The environment variable that a field is read from."""
    alias = settings.model_fields[field].validation_alias
    prefix = settings.model_config.get("env_prefix", "")
    return alias if isinstance(alias, str) else f"{prefix}{field}".upper()


def _comments(field: FieldInfo) -> list[str]:
    """What a field is, and what a value of it looks like where that is hard to guess."""
    return [field.description or "", *(f"for example '{example}'" for example in field.examples or ())]


def _lines(name: str, value: str, *comments: str) -> str:
    # The key is the one line without a comment sign: there is no default for it, and compose demands it.
    sign = "" if name == "OVIP_API_KEY" else "# "
    return "\n".join([*(f"# {comment}" for comment in comments), f"{sign}{name}={value}"])


def _text(default: Any) -> str:
    if default is None or default == ():
        return ""
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, Path):
        home = Path.home()
        return f"~/{default.relative_to(home)}" if default.is_relative_to(home) else str(default)
    return str(default)


if __name__ == "__main__":
    sys.stdout.write(render())
