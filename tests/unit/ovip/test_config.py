"""Settings: read from the environment, wrong ones explained without their values."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from ovip.config import KernelSettings, explain


def test_settings_come_from_variables_with_the_prefix(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OVIP_DATA_DIR", "/data")
    monkeypatch.setenv("OVIP_MAPPER_ADDRESS", "mapper:1")
    monkeypatch.setenv("MAPPER_ADDRESS", "ignored:1")

    settings = KernelSettings(_env_file=None)

    assert settings.data_dir == Path("/data")
    assert settings.mapper_address == "mapper:1"


def test_a_tilde_is_the_home_directory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/robot")

    assert KernelSettings(_env_file=None, data_dir="~/ovip").data_dir == Path("/home/robot/ovip")


def test_nothing_listens_beyond_this_machine_unless_told() -> None:
    assert KernelSettings.model_fields["host"].default == "127.0.0.1"


def test_a_wrong_setting_is_explained_by_its_variable_and_never_by_its_value() -> None:
    with pytest.raises(ValidationError) as wrong:
        KernelSettings(_env_file=None, log_level="s3cret", store_fsync="never")

    text = str(explain(wrong.value))

    assert text.startswith("wrong settings: ")
    assert "OVIP_LOG_LEVEL: String should match pattern" in text
    assert "OVIP_STORE_FSYNC" in text
    assert "s3cret" not in text


def test_the_key_is_not_shown_where_settings_are_printed() -> None:
    assert "s3cret" not in repr(KernelSettings(_env_file=None, api_key="s3cret"))
