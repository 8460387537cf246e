"""The settings of a map as text, there and back."""

from __future__ import annotations

import pytest

from ovip.errors import Corrupt
from services.mapper.domain.params import MapParams, params_json, params_of
from services.mapper.domain.presets import PRESETS


@pytest.mark.parametrize("name", PRESETS)
def test_settings_survive_being_written_down(name: str) -> None:
    """Infinite thresholds and names of variants too."""
    assert params_of(params_json(PRESETS[name])) == PRESETS[name]


def test_the_same_settings_are_the_same_text() -> None:
    assert params_json(MapParams()) == params_json(params_of(params_json(MapParams())))


@pytest.mark.parametrize(
    "text", ["", "[]", "7", '{"voxel": 0.02, "unheard_of": 1}', '{"association": {"spatial": "nearest"}}']
)
def test_what_are_no_settings_is_corrupt(text: str) -> None:
    with pytest.raises(Corrupt, match="map settings"):
        params_of(text)
