"""What one check found, in words and in numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

Level = Literal["ok", "warning", "wrong"]
Figures = Mapping[str, float | int | str | list[float]]
_LEVELS: tuple[Level, ...] = ("ok", "warning", "wrong")


@dataclass(frozen=True, slots=True)
class Finding:
    """check: what was looked at; says: the answer in words; figures: what it rests on."""

    check: str
    level: Level
    says: str
    figures: Figures = field(default_factory=dict)


def worst(findings: Iterable[Finding]) -> Level:
    """The gravest level among `findings`; "ok" where there are none."""
    return max((finding.level for finding in findings), key=_LEVELS.index, default="ok")
