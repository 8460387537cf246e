"""Which models a stack gets by its settings, where packages are missing."""

from __future__ import annotations

import sys

import pytest

from ovip.errors import NotConfigured
from services.perception.adapters.full import open_second_encoder
from services.perception.config import Settings


def test_a_second_encoder_without_its_packages_is_refused_naming_the_setting_and_the_remedy(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delitem(sys.modules, "services.perception.adapters.full.dino", raising=False)
    monkeypatch.setitem(sys.modules, "torch", None)
    settings = Settings(_env_file=None).model_copy(update={"second_encoder": "facebook/dinov2-small"})

    with pytest.raises(NotConfigured, match=r"OVIP_SECOND_ENCODER: .*'torch'.*pip install 'ovip-sg\[full\]'"):
        open_second_encoder(settings)


def test_no_second_encoder_is_named_by_default() -> None:
    assert Settings.model_fields["second_encoder"].default == ""
