"""A body as relations see it: its cloud and its box, and what is measured of them, each once: bottom, foot, outline."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ovip.scene.types import F32, F64
from services.mapper.domain.contacts import plan_extents, plan_thickness

LOOSE = 0.03
"""Metres that boxes of clouds are off."""

_STRAYS, _MOST_STRAYS = 0.02, 8  # of a cloud's points that may lie below its bottom, and above its top
_FOOT = 0.15  # of a thing's height that is its foot
_PANEL_HEIGHT, _PANEL_WIDTH = 0.5, 0.15  # metres


@dataclass(frozen=True, slots=True)
class RelationParams:
    """Metres and shares, chosen by `ovip eval relations` on simulated homes.

    gap: most air between a thing and what bears or backs it; sink: how deep it may lie in that. rim: how far around
    it that is looked for. support, facing: least share of its footprint that is borne, of its face that is backed.
    over: least share of its footprint within the box of what bears it. inside: least share of its box in the other's;
    closed: least share of a side that counts as closed. beside: most metres between neighbours in plan; level: most
    between their bottoms, unless one thing holds both. structure: from so many square metres on, what is at most
    `flat` metres thick is floor, wall or ceiling.
    """

    gap: float = 0.08
    sink: float = 0.05
    rim: float = 0.06
    support: float = 0.2
    facing: float = 0.25
    over: float = 0.4
    inside: float = 0.6
    closed: float = 0.2
    beside: float = 0.3
    level: float = 0.08
    structure: float = 5.0
    flat: float = 0.25


@dataclass(frozen=True, eq=False)
class Body:
    """An object as far as relations need it. box: `(6,)`; points: `(P, 3)`, the means of its voxels; world metres.

    What else is known of it is measured once, when it is first asked for; so keep a body for all it is compared with.
    """

    object_id: str
    label: str
    box: F64
    points: F32

    @cached_property
    def known(self) -> WeakKeyDictionary[Body, Any]:
        """What was measured of it with others, for as long as they are as they were."""
        return WeakKeyDictionary()

    @cached_property
    def bottom(self) -> float:
        """But for strays."""
        return self._heights[0]

    @cached_property
    def top(self) -> float:
        """But for strays."""
        return self._heights[1]

    @cached_property
    def foot(self) -> F64:
        """The box `(4,)` in plan of its lower part."""
        return _plan(self.points[self.points[:, 2] <= self.bottom + self._part])

    @cached_property
    def head(self) -> F64:
        """The box `(4,)` in plan of its upper part."""
        return _plan(self.points[self.points[:, 2] >= self.top - self._part])

    @cached_property
    def extents(self) -> F64:
        """How far it goes in plan, `(2, 36)` as in `plan_extents`."""
        return plan_extents(self.points)

    @cached_property
    def length(self) -> float:
        """Metres in plan where it is longest."""
        return float((self.extents[1] - self.extents[0]).max())

    @cached_property
    def thickness(self) -> float:
        """Metres in plan where it is thinnest, but for strays."""
        return plan_thickness(self.points)

    @cached_property
    def height(self) -> float:
        """Metres from bottom to top, but for a share of strays: what is thin in a large noisy cloud."""
        low, high = _without(self.points[:, 2], int(_STRAYS * len(self.points)))
        return high - low

    @cached_property
    def volume(self) -> float:
        """Of its box, never 0."""
        x, y, z = (self.box[3:] - self.box[:3] + LOOSE).tolist()
        return float(x * y * z)

    @cached_property
    def longest(self) -> float:
        """Metres through its box."""
        return float(np.linalg.norm(self.box[3:] - self.box[:3]))

    @cached_property
    def _heights(self) -> tuple[float, float]:
        return _without(self.points[:, 2], min(int(_STRAYS * len(self.points)), _MOST_STRAYS))

    @property
    def _part(self) -> float:
        return max(LOOSE, _FOOT * (self.top - self.bottom))


def lies_flat(body: Body, params: RelationParams) -> bool:
    """Whether it lies and is large and flat: a floor, a ceiling."""
    x, y, _ = (body.box[3:] - body.box[:3]).tolist()
    return bool(x * y >= params.structure and body.height <= params.flat)


def stands_flat(body: Body, params: RelationParams) -> bool:
    """Whether it stands and is large and flat: a wall."""
    return body.length * (body.top - body.bottom) >= params.structure and body.thickness <= params.flat


def is_structure(body: Body, params: RelationParams) -> bool:
    """Whether it is a floor, a wall or a ceiling."""
    return lies_flat(body, params) or stands_flat(body, params)


def is_panel(body: Body, params: RelationParams) -> bool:
    """Whether it is upright, and too thin to stand on or to be in: a wall, a door."""
    if body.top - body.bottom >= _PANEL_HEIGHT and body.thickness <= _PANEL_WIDTH:
        return True
    return stands_flat(body, params)


def _without(along: F32, strays: int) -> tuple[float, float]:
    """Least and most of `(P,)`, but for so many at either end."""
    last = len(along) - 1 - strays
    ordered = np.partition(along, (strays, last))
    return float(ordered[strays]), float(ordered[last])


def _plan(points: F32) -> F64:
    x, y = points[:, 0], points[:, 1]
    return np.array([x.min(), y.min(), x.max(), y.max()], np.float64)
