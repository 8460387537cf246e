"""What differs between a map at two of its versions, object by object."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ovip.scene.types import MapObject
from ovip.scene.versions import ObjectChange

_NOT_TOLD = {"object_id", "version"}
_FIELDS = [f.name for f in dataclasses.fields(MapObject) if f.name not in _NOT_TOLD]


def changes_between(
    before: Sequence[MapObject], after: Sequence[MapObject], resolve: Callable[[str], str]
) -> tuple[ObjectChange, ...]:
    """The objects that differ, by id. resolve: what an id stands for in the later map, itself where it is no alias."""
    earlier = {o.object_id: o for o in before}
    later = {o.object_id: o for o in after}
    changes = (
        _change(object_id, earlier.get(object_id), later.get(object_id), resolve)
        for object_id in sorted(earlier.keys() | later.keys())
    )
    return tuple(c for c in changes if c.fields or c.before is None or c.after is None)


def differing_fields(before: MapObject | None, after: MapObject | None) -> tuple[str, ...]:
    """Names of what differs of one object; none where it is not on both sides."""
    if before is None or after is None:
        return ()
    return tuple(name for name in _FIELDS if not _same(getattr(before, name), getattr(after, name)))


def _change(
    object_id: str, before: MapObject | None, after: MapObject | None, resolve: Callable[[str], str]
) -> ObjectChange:
    survivor = resolve(object_id)
    merged_into = survivor if survivor != object_id else ""
    return ObjectChange(object_id, before, after, differing_fields(before, after), merged_into)


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return np.array_equal(a, b)
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(_same, a, b))
    if dataclasses.is_dataclass(a) and not isinstance(a, type) and type(a) is type(b):
        return all(_same(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a))
    return bool(a == b)
