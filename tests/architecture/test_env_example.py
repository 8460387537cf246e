"""`.env.example` names every setting, and nothing else, with the defaults that the code has."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from dotenv import dotenv_values

from ovip.config import KernelSettings
from tests.architecture.env_example import COMPOSE_ONLY, own_fields, render, service_settings, variable

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / ".env.example"
SETTINGS: dict[str, type[KernelSettings]] = {"every service": KernelSettings, **service_settings()}


def lines() -> dict[str, str]:
    """Every setting in the file, commented or not, with its value."""
    found = re.findall(r"^(?:# )?([A-Z][A-Z0-9_]*)=(.*)$", EXAMPLE.read_text(), re.MULTILINE)
    names = [name for name, _ in found]
    assert len(set(names)) == len(names)
    return dict(found)


def test_example_is_what_the_settings_say() -> None:
    assert EXAMPLE.read_text() == render(), "run: python -m tests.architecture.env_example > .env.example"


def test_example_names_every_setting_and_nothing_else() -> None:
    known = {name for settings in SETTINGS.values() for name in own_fields(settings)}
    assert set(lines()) == known | {name for name, _, _ in COMPOSE_ONLY}


def test_every_variable_is_one_setting_of_one_service() -> None:
    names = [name for settings in SETTINGS.values() for name in own_fields(settings)]
    assert sorted(names) == sorted(set(names))


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS.keys())
def test_every_setting_is_described_in_a_line(settings: type[KernelSettings]) -> None:
    for name, field in own_fields(settings).items():
        assert field.description, name
        assert "\n" not in field.description, name
        assert name.startswith("OVIP_")


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS.keys())
def test_defaults_in_the_example_are_those_of_the_code(
    settings: type[KernelSettings], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in lines():
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)
    default = _values(settings())
    for name, value in lines().items():
        if value:
            monkeypatch.setenv(name, value)
    assert _values(settings()) == default


def test_example_copied_as_it_is_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    values = dotenv_values(EXAMPLE)
    assert values == {"OVIP_API_KEY": ""}
    for name in lines():
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)
    default = [_values(settings()) for settings in SETTINGS.values()]
    (tmp_path / ".env").write_text(EXAMPLE.read_text())
    copied = [_values(settings()) for settings in SETTINGS.values()]
    assert [{**each, "api_key": None} for each in copied] == default


def test_variable_of_a_field_is_its_alias_or_its_prefixed_name() -> None:
    assert variable(KernelSettings, "redis_url") == "OVIP_REDIS_URL"


def _values(settings: KernelSettings) -> dict[str, Any]:
    """Values by field; paths with the home directory spelled out, which a shell would have done."""
    return {
        name: value.expanduser() if isinstance(value, Path) else value
        for name, value in settings.model_dump().items()
    }
