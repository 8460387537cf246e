"""Grouping by a VLM: what is asked, and how a reply is read."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.errors import Exhausted, Unavailable
from services.regions.adapters.vlm_grouping import VlmGrouper, prompt_for, read_reply
from services.regions.domain.assembly import PlacedObjects
from tests.unit.services.regions.homes import ScriptedVlm

THINGS = PlacedObjects(("o7", "o9"), ("chair", "desk"), np.array([[1.04, -2.0, 0.4], [1.5, -2.5, 0.7]]))


def test_the_question_has_a_line_for_each_object_and_the_known_functions() -> None:
    prompt = prompt_for(THINGS)
    assert "1, chair, 1.0, -2.0\n2, desk, 1.5, -2.5" in prompt
    assert "kitchen" in prompt
    assert '"unknown"' in prompt


async def test_the_reply_gives_each_object_its_function_in_the_shared_form() -> None:
    vlm = ScriptedVlm(
        {"objects": [{"number": 2, "function": " Offices "}, {"number": 1, "function": "office"}]}
    )
    assert (await VlmGrouper(vlm, 5.0).group(THINGS)).functions == ("office", "office")


def test_objects_left_out_are_unknown_and_numbers_out_of_range_are_ignored() -> None:
    items = [{"number": 0, "function": "x"}, {"number": 3, "function": "y"}, {"number": 2, "function": "gym"}]
    assert read_reply({"objects": items}, 2) == ("unknown", "gym")


def test_the_first_mention_counts_and_nonsense_is_unknown() -> None:
    items = [
        {"number": 1, "function": "gym"},
        {"number": 1, "function": "garage"},
        {"number": 2, "function": "x" * 500},
        {"number": 3, "function": "  "},
    ]
    assert read_reply({"objects": items}, 3) == ("gym", "unknown", "unknown")


@pytest.mark.parametrize("value", [None, [], {"objects": [{"number": "first"}]}, {"things": []}])
def test_a_reply_of_another_shape_is_no_grouping(value: object) -> None:
    with pytest.raises(Unavailable, match="grouping"):
        read_reply(value, 1)


async def test_no_objects_need_no_question_and_errors_pass_through() -> None:
    vlm = ScriptedVlm(error=Exhausted("no money left today"))
    assert (await VlmGrouper(vlm, 5.0).group(PlacedObjects.none())).functions == ()
    with pytest.raises(Exhausted):
        await VlmGrouper(vlm, 5.0).group(THINGS)
