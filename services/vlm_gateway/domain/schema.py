"""Structured output: the JSON Schema a reply must satisfy, what it breaks, and how to ask for a repair."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

from jsonschema import Draft202012Validator
from jsonschema.exceptions import SchemaError, ValidationError
from referencing import Registry
from referencing.exceptions import Unresolvable
from referencing.jsonschema import DRAFT202012

from ovip.errors import InvalidInput

MAX_VIOLATIONS = 8
MAX_QUOTED = 4000
MAX_VALUES = 50_000
_FENCE = re.compile(r"```[a-zA-Z0-9]*\s*\n(.*?)```", re.DOTALL)
_THOUGHT = re.compile(r"\A\s*<think>.*?</think>", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Schema:
    """A checked JSON Schema (draft 2020-12). text: its canonical JSON; document: the same, parsed."""

    text: str
    document: dict[str, Any]

    @classmethod
    def parse(cls, text: str) -> Schema:
        """Checks a schema's text; empty text means any JSON. Raises InvalidInput saying what is wrong."""
        document = _loads(text) if text.strip() else {}
        if not isinstance(document, dict):
            raise InvalidInput("json_schema: expected a JSON object holding a JSON Schema")
        _check(document)
        return cls(json.dumps(document, sort_keys=True, separators=(",", ":")), document)

    def violations(self, value: object) -> tuple[str, ...]:
        """What `value` breaks: at most `MAX_VIOLATIONS` sentences, each naming its place; none where it fits.

        Raises InvalidInput where only the value brought out that the schema itself cannot be used.
        """
        # The empty registry keeps `$ref` from fetching anything.
        validator = Draft202012Validator(self.document, registry=Registry())
        try:
            return tuple(_sentence(error) for error in islice(validator.iter_errors(value), MAX_VIOLATIONS))
        except (RecursionError, OverflowError):
            return ("the reply is nested too deeply, or holds a number too large, to be checked",)
        except Unresolvable as error:
            raise InvalidInput(f"json_schema: cannot be applied: {error}") from None


@dataclass(frozen=True, slots=True)
class Checked:
    """A reply read as JSON: its value, or the violations that make it useless."""

    value: Any = None
    violations: tuple[str, ...] = ()


def check_reply(text: str, schema: Schema) -> Checked:
    """Reads a model's reply as JSON and holds it against the schema.

    A leading `<think>` block and a Markdown fence are set aside, as is prose around one JSON value.
    """
    try:
        value = _first_json(text)
    except (ValueError, RecursionError):
        return Checked(violations=("the reply is not JSON",))
    if _count(value) > MAX_VALUES:
        return Checked(violations=(f"the reply holds more than {MAX_VALUES} values",))
    if any(not _encodable(part) for part in _strings(value)):
        return Checked(violations=("the reply holds text that is not Unicode (a lone surrogate)",))
    violations = schema.violations(value)
    return Checked(violations=violations) if violations else Checked(value)


def instruction(schema: Schema) -> str:
    """The words that ask for JSON of this schema, for upstreams that take no schema of their own."""
    return (
        "Answer with one JSON value and nothing else: no explanation, no Markdown. "
        f"It must satisfy this JSON Schema:\n{schema.text}"
    )


def repair_prompt(violations: tuple[str, ...], schema: Schema) -> str:
    """Asks for the same answer again with its violations mended."""
    faults = "\n".join(f"- {violation}" for violation in violations)
    return (
        "That reply cannot be used:\n"
        f"{faults}\n"
        "Send the whole answer again with these mended, keeping what was right. "
        f"{instruction(schema)}"
    )


def quoted(text: str) -> str:
    """A reply as it is quoted back to the model, cut to `MAX_QUOTED` characters."""
    return text if len(text) <= MAX_QUOTED else text[:MAX_QUOTED] + " ..."


def _check(document: dict[str, Any]) -> None:
    try:
        Draft202012Validator.check_schema(document)
    except SchemaError as error:
        raise InvalidInput(f"json_schema: {error.message[:300]}") from None
    except RecursionError:
        raise InvalidInput("json_schema: nested too deeply") from None
    resolver = Registry().with_resource("", DRAFT202012.create_resource(document)).resolver()
    for reference in _references(document):
        if not reference.startswith("#"):
            raise InvalidInput(
                f"json_schema: $ref {reference!r} leaves the schema; expected one into its $defs"
            )
        try:
            resolver.lookup(reference)
        except Unresolvable:
            raise InvalidInput(f"json_schema: $ref {reference!r} points at nothing") from None


def _loads(text: str) -> object:
    try:
        return _strict_json(text)
    except (ValueError, RecursionError):
        raise InvalidInput("json_schema: not JSON; expected a JSON object holding a JSON Schema") from None


def _first_json(text: str) -> Any:
    """The reply's JSON value; raises ValueError where there is none."""
    body = _THOUGHT.sub("", text).strip()
    fenced = _FENCE.search(body)
    for candidate in (body, fenced.group(1) if fenced else "", _between_braces(body)):
        try:
            return _strict_json(candidate)
        except ValueError:
            continue
    raise ValueError("no JSON value")


def _between_braces(text: str) -> str:
    starts = [at for at in (text.find("{"), text.find("[")) if at >= 0]
    end = max(text.rfind("}"), text.rfind("]"))
    return text[min(starts) : end + 1] if starts and end >= 0 else ""


def _strict_json(text: str) -> Any:
    return json.loads(text, parse_constant=_no_constant)


def _no_constant(name: str) -> Any:
    raise ValueError(f"{name} is not JSON")


def _sentence(error: ValidationError) -> str:
    return f"at {error.json_path}: {error.message[:200]}"


def _walk(value: object) -> Iterator[object]:
    pending = [value]
    while pending:
        part = pending.pop()
        yield part
        if isinstance(part, dict):
            pending.extend(part.keys())
            pending.extend(part.values())
        elif isinstance(part, list):
            pending.extend(part)


def _count(value: object) -> int:
    return sum(1 for _ in islice(_walk(value), MAX_VALUES + 1))


def _strings(value: object) -> Iterator[str]:
    return (part for part in _walk(value) if isinstance(part, str))


def _encodable(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _references(document: dict[str, Any]) -> Iterator[str]:
    for part in _walk(document):
        reference = part.get("$ref") if isinstance(part, dict) else None
        if isinstance(reference, str):
            yield reference
