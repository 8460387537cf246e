"""The gateway's settings, read from the environment without ever showing a key."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from ovip.errors import InvalidInput
from services.vlm_gateway.config import JsonMode, Settings, read_upstreams

KEY = "sk-very-secret"
ONE: dict[str, Any] = {
    "name": "kimi",
    "base_url": "https://host.example/v1/",
    "model": "kimi-k2.6",
    "api_key": KEY,
}


def test_no_upstream_is_the_default(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("OVIP_VLM_UPSTREAMS", raising=False)
    assert Settings().vlm_upstreams == ()
    monkeypatch.setenv("OVIP_VLM_UPSTREAMS", "  ")
    assert Settings().vlm_upstreams == ()


def test_upstreams_come_from_the_environment_in_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(
        "OVIP_VLM_UPSTREAMS", json.dumps([ONE, {**ONE, "name": "qwen", "json_mode": "prompt"}])
    )
    first, second = Settings().vlm_upstreams
    assert (first.name, second.name) == ("kimi", "qwen")
    assert first.base_url == "https://host.example/v1" and first.json_mode is JsonMode.SCHEMA
    assert first.api_key is not None and first.api_key.get_secret_value() == KEY


def test_key_is_read_from_the_variable_that_is_named() -> None:
    (upstream,) = read_upstreams(
        json.dumps([{**ONE, "api_key": None, "api_key_env": "KIMI_API_KEY"}]), {"KIMI_API_KEY": KEY}
    )
    assert upstream.api_key is not None and upstream.api_key.get_secret_value() == KEY


def test_key_may_stand_in_the_settings_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    upstreams = json.dumps([{**ONE, "api_key": None, "api_key_env": "KIMI_API_KEY"}])
    (tmp_path / ".env").write_text(f"KIMI_API_KEY={KEY}\nOVIP_VLM_UPSTREAMS='{upstreams}'\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("KIMI_API_KEY", raising=False)
    monkeypatch.delenv("OVIP_VLM_UPSTREAMS", raising=False)
    (upstream,) = Settings().vlm_upstreams
    assert upstream.api_key is not None and upstream.api_key.get_secret_value() == KEY


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"name": "kimi"}, "expected a JSON list"),
        ([7], r"\[0\]"),
        ([{**ONE, "base_url": "host.example/v1"}], "base_url"),
        ([{**ONE, "base_url": f"https://me:{KEY}@host.example/v1"}], "without a user"),
        ([{**ONE, "model": ""}], "model"),
        ([{**ONE, "json_mode": "xml"}], "json_mode"),
        ([{**ONE, "requests_per_minute": -1}], "requests_per_minute"),
        ([{**ONE, "image_max_side": 0}], "image_max_side"),
        ([{**ONE, "timeout_s": "NaN"}], "timeout_s"),
        ([{**ONE, "colour": "blue"}], "colour"),
        ([{**ONE, "name": "a b"}], "name"),
        ([{**ONE, "api_key": f"{KEY}\n"}], "api_key"),
        ([ONE, ONE], "names must differ"),
        ([{**ONE, "api_key": None, "api_key_env": "NOT_SET"}], "NOT_SET, which is not set"),
        ([{**ONE, "api_key_env": "KIMI_API_KEY"}], "one of api_key and api_key_env"),
    ],
)
def test_wrong_upstreams_are_named_without_their_keys(entries: object, said: str) -> None:
    with pytest.raises(InvalidInput, match=said) as caught:
        read_upstreams(json.dumps(entries), {"KIMI_API_KEY": KEY})
    assert "OVIP_VLM_UPSTREAMS" in str(caught.value) and KEY not in str(caught.value)


def test_text_that_is_not_json_is_shown_an_example_and_not_echoed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OVIP_VLM_UPSTREAMS", f"[{{api_key: {KEY}}}]")
    with pytest.raises(InvalidInput, match="expected a list such as") as caught:
        Settings()
    assert KEY not in str(caught.value)


def test_key_does_not_show_when_settings_are_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OVIP_VLM_UPSTREAMS", json.dumps([ONE]))
    settings = Settings()
    assert KEY not in repr(settings) and KEY not in settings.model_dump_json()
