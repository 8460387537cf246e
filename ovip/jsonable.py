"""Values of the scene as plain JSON values."""

from __future__ import annotations

import dataclasses
import enum
from typing import Any

import numpy as np


def to_json(value: Any) -> Any:
    """Dataclasses, arrays, enums, tuples and paths as dicts, lists, numbers and strings; non-finite as None."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: to_json(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, np.ndarray):
        return to_json(value.tolist())
    if isinstance(value, np.generic):
        return to_json(value.item())
    if isinstance(value, float):
        return value if np.isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): to_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [to_json(item) for item in value]
    if isinstance(value, str | int | bool) or value is None:
        return value
    return str(value)
