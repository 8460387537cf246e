"""Names of functions: one for each, whatever a VLM calls it."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.regions.domain.function_names import LONGEST_NAME, function_name
from services.regions.domain.functions import FUNCTIONS


@pytest.mark.parametrize(
    ("called", "name"),
    [
        ("lounge", "living room"),
        ("Living_Area", "living room"),
        ("TV corner", "living room"),
        ("home office", "office"),
        ("Study", "office"),
        ("work-space", "office"),
        ("work area", "office"),
        ("WC", "bathroom"),
        ("Toilets", "bathroom"),
        ("gym corner", "gym"),
        ("exercise area", "gym"),
        ("entryway", "hallway"),
        ("Corridor", "hallway"),
        ("Dining Room", "dining area"),
        ("dining", "dining area"),
        ("kids' room", "playroom"),
        ("master bedroom", "bedroom"),
        ("laundry room", "laundry"),
        ("walk-in closet", "storage"),
        ("Conference Room", "meeting room"),
        ("terrace", "balcony"),
    ],
)
def test_what_people_call_a_room_meets_our_name_for_it(called: str, name: str) -> None:
    assert function_name(called) == name


@pytest.mark.parametrize("name", ["wine cellar", "workshop", "chapel", "music room", "sunroom"])
def test_an_unusual_but_sensible_function_is_kept(name: str) -> None:
    assert function_name(f" {name.title()} ") == name


@pytest.mark.parametrize(
    "text", ["", "  ", "?!", "unknown", "None", "N/A", "other", "x" * (LONGEST_NAME + 1)]
)
def test_what_names_nothing_is_unknown(text: str) -> None:
    assert function_name(text) == "unknown"


def test_our_own_names_stay_themselves() -> None:
    assert tuple(function_name(name) for name in FUNCTIONS) == FUNCTIONS


@given(st.text(max_size=60))
def test_a_name_is_its_own_name(text: str) -> None:
    assert function_name(function_name(text)) == function_name(text)
