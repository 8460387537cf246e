"""Grouping by a VLM: one question a floor, object numbers in and out (KGSW, Algorithm 1 line 5)."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ValidationError

from ovip.errors import Unavailable
from ovip.scene.words import normalize_word
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.functions import FUNCTIONS
from services.regions.domain.partition import UNKNOWN_FUNCTION
from services.regions.ports import Grouping, Vlm

_LONGEST_FUNCTION = 40
_SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {
        "objects": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {"number": {"type": "integer"}, "function": {"type": "string"}},
                "required": ["number", "function"],
                "additionalProperties": False,
            },
        }
    },
    "required": ["objects"],
    "additionalProperties": False,
}
_PROMPT = """These are the objects on one floor of a building, with their positions seen from above, in metres.
Group them by what the area they stand in is used for, and give each object the function of its area.
Decide from what stands near each other, not from the object alone: a chair at a desk belongs to the office,
and the same chair at a dining table to the dining area. Use few functions and the same word for the same
function, for example: {functions}.
Use "{unknown}" for an object that could stand in any area.
Reply with every object's number.

number, label, x, y
{rows}"""


class VlmGrouper:
    """Asks the gateway; raises what the gateway raises, and Unavailable for a reply that says nothing."""

    def __init__(self, vlm: Vlm, deadline_s: float) -> None:
        self._vlm = vlm
        self._deadline_s = deadline_s

    async def group(self, objects: PlacedObjects) -> Grouping:
        if not objects.ids:
            return Grouping(())
        reply = await self._vlm.ask("group", prompt_for(objects), schema=_SCHEMA, deadline_s=self._deadline_s)
        return Grouping(read_reply(reply.value, len(objects.ids)))


def prompt_for(objects: PlacedObjects) -> str:
    """The question about a floor's objects, numbered from 1."""
    rows = "\n".join(
        f"{number}, {label}, {x:.1f}, {y:.1f}"
        for number, (label, (x, y)) in enumerate(
            zip(objects.labels, objects.centres[:, :2].tolist(), strict=True), start=1
        )
    )
    return _PROMPT.format(functions=", ".join(FUNCTIONS), unknown=UNKNOWN_FUNCTION, rows=rows)


def read_reply(value: object, count: int) -> tuple[str, ...]:
    """A function for each of `count` objects; "unknown" for one left out. The first mention counts."""
    try:
        reply = _Reply.model_validate(value)
    except ValidationError as error:
        raise Unavailable(f"the VLM's grouping cannot be read: {error.error_count()} faults") from error
    functions = [UNKNOWN_FUNCTION] * count
    for item in reversed(reply.objects):
        if 1 <= item.number <= count:
            functions[item.number - 1] = _function(item.function)
    return tuple(functions)


class _Item(BaseModel):
    number: int
    function: str


class _Reply(BaseModel):
    objects: list[_Item]


def _function(text: str) -> str:
    word = normalize_word(text)
    return word if word and len(word) <= _LONGEST_FUNCTION else UNKNOWN_FUNCTION
