"""What operators ask of a map: queued in the edits log, done by whoever writes the map, found by the edit's id.

A verdict is put with the step that it tells of, in one commit, so an edit is done once or refused once.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping

import numpy as np

from ovip.codec import encode_edit_request
from ovip.errors import Corrupt, InvalidInput, OvipError, TooLarge, Unavailable, from_status
from ovip.scene.edits import EditRequest
from ovip.scene.types import F64
from ovip.store import Entry, Store
from services.mapper.history import STAGE
from services.mapper.journal import EditInput, JoinInput, matrix_of, matrix_text

EDITS = "edits"
_LONGEST_ID = 200
_LARGEST_REQUEST = 1_000_000
_FIRST_LOOK_S, _LAST_LOOK_S = 0.01, 0.2


class OperatorRequests:
    """The edits log of every scene, and the verdicts on what is in it."""

    def __init__(self, store: Store, answer_within_s: float) -> None:
        self._store = store
        self._answer_within_s = answer_within_s

    async def known(self, scene: str, edit_id: str) -> bool:
        """Whether an edit of that id was ever asked for."""
        return await self._store.entry_of(scene, EDITS, checked_id(edit_id)) is not None

    async def submit_edit(self, scene: str, request: EditRequest) -> None:
        """Queues an edit; again changes nothing. InvalidInput where its id already names another."""
        encoded = encode_edit_request(request)
        if len(encoded) > _LARGEST_REQUEST:
            raise TooLarge(f"edit: expected at most {_LARGEST_REQUEST} bytes, got {len(encoded)}")
        fields = {"kind": b"edit", "edit_id": request.edit_id.encode(), "request": encoded}
        await self._submit(scene, request.edit_id, fields, fields)

    async def submit_join(
        self, scene: str, edit_id: str, other: str, world_from_other: F64, other_map: str
    ) -> None:
        """Queues a join of the map in the blob `other_map`; again, even of a newer map, changes nothing."""
        asked = {
            "kind": b"join",
            "edit_id": edit_id.encode(),
            "other": other.encode(),
            "world_from_other": matrix_text(world_from_other).encode(),
        }
        await self._submit(scene, edit_id, asked, {**asked, "other_map": other_map.encode()})

    async def verdict(self, scene: str, edit_id: str) -> int:
        """The version that an edit made, waited for; raises the refusal, or Unavailable where nobody decides."""
        name, pause, waited = verdict_name(edit_id), _FIRST_LOOK_S, 0.0
        while True:
            found = await self._store.values(scene, STAGE, [name])
            if name in found:
                return _version_in(found[name])
            if waited >= self._answer_within_s:
                raise Unavailable(
                    f"edit {edit_id[:80]}: no mapper writes scene {scene} now; it stays queued and is done when one "
                    "does: ask again with the same edit_id"
                )
            await asyncio.sleep(pause)
            waited, pause = waited + pause, min(2 * pause, _LAST_LOOK_S)

    async def _submit(
        self, scene: str, edit_id: str, asked: Mapping[str, bytes], fields: Mapping[str, bytes]
    ) -> None:
        if not (await self._store.append_once(scene, EDITS, checked_id(edit_id), fields)).duplicate:
            return
        entry = await self._store.entry_of(scene, EDITS, edit_id)
        if entry is None or any(entry.fields.get(name) != value for name, value in asked.items()):
            raise InvalidInput(f"edit_id {edit_id[:80]!r}: it already names another edit of scene {scene}")


def checked_id(edit_id: str) -> str:
    """`edit_id` itself; InvalidInput where it cannot name an edit."""
    if not edit_id.isprintable() or not 1 <= len(edit_id) <= _LONGEST_ID:
        raise InvalidInput(
            f"edit_id: expected 1 to {_LONGEST_ID} printable characters of the caller's choice, got {edit_id[:80]!r}"
        )
    return edit_id


def checked_transform(matrix: F64) -> F64:
    """A float64 `(4, 4)`; InvalidInput where it is none, or not finite."""
    found = np.asarray(matrix, np.float64)
    if found.shape != (4, 4) or not np.isfinite(found).all():
        raise InvalidInput(f"world_from_other: expected a finite 4x4, got {found.tolist()}"[:300])
    return found


def input_of(entry: Entry) -> EditInput | JoinInput:
    """What an entry of the edits log asks for; Corrupt where it asks for nothing."""
    try:
        match entry.fields["kind"]:
            case b"edit":
                return EditInput(entry.id, entry.fields["request"])
            case b"join":
                transform = matrix_of(entry.fields["world_from_other"])
                return JoinInput(entry.id, entry.fields["other_map"].decode(), transform)
            case other:
                raise ValueError(f"its kind is {other[:20]!r}")
    except (KeyError, ValueError) as error:
        raise Corrupt(f"edits log: entry {entry.id} is no edit ({error})") from error


def verdict_name(edit_id: str) -> str:
    """Under which name an edit's verdict lies among the mapper's small values."""
    return f"verdict:{edit_id}"


def done_at(version: int) -> str:
    """The verdict on an edit that was done."""
    return json.dumps({"version": version})


def refused_for(error: OvipError) -> str:
    """The verdict on an edit that was refused."""
    return json.dumps({"code": error.code, "slug": error.slug, "why": str(error)})


def _version_in(verdict: bytes) -> int:
    try:
        found = json.loads(verdict)
        if "version" in found:
            return int(found["version"])
        refusal = from_status(found["code"], found["why"], found["slug"])
    except (ValueError, KeyError, TypeError) as error:
        raise Corrupt(f"verdict on an edit: expected a version or a refusal, got {verdict[:80]!r}") from error
    raise refusal
