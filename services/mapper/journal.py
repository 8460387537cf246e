"""The map log as a journal: each entry is a step, from what it was made and what it changed (DESIGN 3).

The entry of version 12 has the id 12-0, so a version is found, and a log is read from one, without a search.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ovip.codec import decode_delta, encode_delta
from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import F64, MapDelta, StepKind
from ovip.store import Entry

Fields = dict[str, bytes | str | int]


@dataclass(frozen=True, slots=True)
class FrameInput:
    """One entry of the detections log. batch: its blob. refused: why its detections were left out; else empty."""

    log_id: str
    batch: str
    refused: str = ""


@dataclass(frozen=True, slots=True)
class UpkeepInput:
    """Upkeep takes nothing but the map."""


@dataclass(frozen=True, slots=True)
class EditInput:
    """One entry of the edits log. request: the encoded `EditRequest`."""

    log_id: str
    request: bytes


@dataclass(frozen=True, slots=True, eq=False)
class JoinInput:
    """One entry of the edits log. other_map: blob of the whole other map. world_from_other: `(4, 4)`."""

    log_id: str
    other_map: str
    world_from_other: F64


@dataclass(frozen=True, slots=True)
class SettingsInput:
    """params: the settings that hold from here on, as text."""

    params: str


StepInput = FrameInput | UpkeepInput | EditInput | JoinInput | SettingsInput


@dataclass(frozen=True, slots=True)
class Step:
    """One version of a map. ids: of a join, the other map's object ids -> ids here."""

    input: StepInput
    delta: MapDelta
    ids: Mapping[str, str] = field(default_factory=dict)

    def fields(self) -> Fields:
        """The step as a log entry's fields."""
        return {
            "version": self.delta.version,
            "kind": self.delta.kind,
            "frame_id": self.delta.frame_id,
            "delta": encode_delta(self.delta),
            **({"ids": json.dumps(dict(self.ids))} if self.ids else {}),
            **_input_fields(self.input),
        }


def entry_id(version: int) -> str:
    """Where the step that made a version stands in the journal."""
    return f"{version}-0"


def step_of(entry: Entry) -> Step:
    """The step in an entry of the map log.

    InvalidInput where an older mapper wrote it, whose log was no journal; Corrupt where it cannot be a step.
    """
    if "delta" in entry.fields and "kind" not in entry.fields:
        raise InvalidInput(
            f"map log: entry {entry.id} was written by an older version of the mapper, whose maps cannot be read "
            "back: send the recording again into a new scene"
        )
    try:
        delta = decode_delta(entry.fields["delta"])
        kind = StepKind(entry.fields["kind"].decode())
        if entry.id != entry_id(delta.version) or kind is not delta.kind:
            raise ValueError(f"it tells of version {delta.version}, made by {delta.kind}")
        ids = json.loads(entry.fields.get("ids", b"{}"))
        return Step(_input_of(kind, entry.fields), delta, ids)
    except (KeyError, ValueError, Corrupt) as error:
        raise Corrupt(f"map log: entry {entry.id} is no step of a map ({error})") from error


def matrix_text(matrix: F64) -> str:
    """A `(4, 4)` as JSON, every bit of it."""
    numbers: list[float] = np.asarray(matrix, np.float64).ravel().tolist()
    return json.dumps(numbers)


def matrix_of(text: bytes | str) -> F64:
    """The `(4, 4)` that `matrix_text` wrote; ValueError where it is none."""
    try:
        return np.array(json.loads(text), np.float64).reshape(4, 4)
    except TypeError as error:
        raise ValueError(str(error)) from error


def _input_fields(source: StepInput) -> Fields:
    match source:
        case FrameInput():
            refused: Fields = {"refused": source.refused} if source.refused else {}
            return {"log_id": source.log_id, "batch": source.batch, **refused}
        case EditInput():
            return {"log_id": source.log_id, "request": source.request}
        case JoinInput():
            return {
                "log_id": source.log_id,
                "other_map": source.other_map,
                "world_from_other": matrix_text(source.world_from_other),
            }
        case SettingsInput():
            return {"params": source.params}
        case UpkeepInput():
            return {}


def _input_of(kind: StepKind, fields: Mapping[str, bytes]) -> StepInput:
    match kind:
        case StepKind.FRAME:
            refused = fields.get("refused", b"").decode()
            return FrameInput(fields["log_id"].decode(), fields["batch"].decode(), refused)
        case StepKind.EDIT:
            return EditInput(fields["log_id"].decode(), fields["request"])
        case StepKind.JOIN:
            transform = matrix_of(fields["world_from_other"])
            return JoinInput(fields["log_id"].decode(), fields["other_map"].decode(), transform)
        case StepKind.SETTINGS:
            return SettingsInput(fields["params"].decode())
        case StepKind.UPKEEP:
            return UpkeepInput()
