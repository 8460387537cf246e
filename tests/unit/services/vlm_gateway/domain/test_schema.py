"""Structured output: schemas, replies, repairs."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from services.vlm_gateway.domain.schema import (
    MAX_VALUES,
    Schema,
    check_reply,
    instruction,
    quoted,
    repair_prompt,
)

WORDS = Schema.parse(
    json.dumps(
        {
            "type": "object",
            "properties": {"words": {"type": "array", "items": {"type": "string"}}},
            "required": ["words"],
            "additionalProperties": False,
        }
    )
)
GOOD = {"words": ["mug", "chair"]}


@pytest.mark.parametrize(
    "text",
    [
        '{"words": ["mug", "chair"]}',
        '  \n{"words": ["mug", "chair"]}\n',
        '```json\n{"words": ["mug", "chair"]}\n```',
        'Here you are:\n```\n{"words": ["mug", "chair"]}\n```\nEnjoy!',
        'I see: {"words": ["mug", "chair"]} and that is all',
        '<think>a {mug}?</think>\n{"words": ["mug", "chair"]}',
    ],
)
def test_json_is_found_in_what_models_put_around_it(text: str) -> None:
    assert check_reply(text, WORDS).value == GOOD


@pytest.mark.parametrize(
    "text",
    ["", "a mug and a chair", "{", "}{", '{"words": [}', "NaN", '{"words": NaN}', "[" * 100_000, "1" * 5000],
)
def test_what_is_not_json_is_said_to_be_so(text: str) -> None:
    assert check_reply(text, WORDS).violations == ("the reply is not JSON",)


def test_violations_name_the_place() -> None:
    assert check_reply('{"words": ["mug", 3]}', WORDS).violations == (
        "at $.words[1]: 3 is not of type 'string'",
    )
    assert check_reply("{}", WORDS).violations == ("at $: 'words' is a required property",)


def test_many_violations_are_cut_to_a_few() -> None:
    assert len(check_reply(json.dumps({"words": list(range(100))}), WORDS).violations) == 8


def test_reply_with_a_lone_surrogate_is_refused() -> None:
    assert "surrogate" in check_reply('{"words": ["\\ud800"]}', WORDS).violations[0]


def test_reply_with_too_many_values_is_refused_before_it_is_checked() -> None:
    assert "more than" in check_reply(json.dumps([0] * MAX_VALUES), Schema.parse("{}")).violations[0]


def test_reply_too_deep_for_a_recursive_schema_is_refused() -> None:
    nested = Schema.parse('{"type": "array", "items": {"$ref": "#"}}')
    assert check_reply("[" * 400 + "]" * 400, nested).violations


def test_number_beyond_floats_does_not_crash_the_check() -> None:
    tenth = Schema.parse('{"multipleOf": 0.5}')
    assert check_reply("1" + "0" * 400, tenth).violations


@given(st.text())
def test_no_reply_does_worse_than_be_refused(text: str) -> None:
    checked = check_reply(text, WORDS)
    assert checked.violations or set(checked.value) == {"words"}


def test_no_schema_takes_any_json() -> None:
    assert check_reply("3", Schema.parse("")).value == 3


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "not JSON"),
        ("[]", "expected a JSON object"),
        ('{"type": "thing"}', "json_schema: "),
        ('{"$ref": "http://127.0.0.1:9/x.json"}', "leaves the schema"),
        ('{"$ref": "file:///etc/passwd"}', "leaves the schema"),
        ('{"$ref": "#/$defs/absent"}', "points at nothing"),
        ('{"pattern": "("}', "not a 'regex'"),
        ("[" * 100_000, "not JSON"),
    ],
)
def test_bad_schema_is_refused_before_anything_is_asked(text: str, said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        Schema.parse(text)


def test_reference_into_the_schema_is_followed() -> None:
    schema = Schema.parse(
        '{"$defs": {"w": {"type": "string"}}, "type": "array", "items": {"$ref": "#/$defs/w"}}'
    )
    assert check_reply('["mug"]', schema).value == ["mug"]
    assert check_reply("[1]", schema).violations == ("at $[0]: 1 is not of type 'string'",)


def test_reference_that_fails_only_in_use_is_the_callers_fault() -> None:
    inner = {"$id": "urn:inner", "type": "array", "items": {"$ref": "#/$defs/w"}}
    schema = Schema.parse(
        json.dumps({"$defs": {"w": {"type": "string"}, "inner": inner}, "$ref": "#/$defs/inner"})
    )
    with pytest.raises(InvalidInput, match="cannot be applied"):
        check_reply('["mug"]', schema)


def test_repair_prompt_holds_the_faults_and_the_schema() -> None:
    prompt = repair_prompt(("at $.words[1]: 3 is not of type 'string'",), WORDS)
    assert "- at $.words[1]: 3 is not of type 'string'" in prompt
    assert WORDS.text in prompt and WORDS.text in instruction(WORDS)


def test_long_reply_is_quoted_in_part() -> None:
    assert quoted("short") == "short"
    assert len(quoted("x" * 100_000)) < 5000
