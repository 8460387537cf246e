"""Builders: two storeys and the stairs between them. Treads are 0.25 m deep and 0.9 m wide, 0.2 m apart."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32
from services.regions.domain.evidence import FloorEvidence
from tests.unit.services.regions.rooms import Span, plane, seen, without

UPSTAIRS, GOING, RISE, WIDTH = 2.8, 0.25, 0.2, 0.9
NOTHING = np.zeros((0, 3), np.float32)
Rect = tuple[Span, Span]
Place = tuple[float, float, float]


def flight(start: tuple[float, float], way: tuple[int, int], count: int = 13, low: float = 0.0) -> F32:
    """Treads and risers, from the middle of the first riser's foot along `way`, the first tread a rise over `low`."""
    along, across = np.array(way, float), np.array([-way[1], way[0]], float)
    depth, side = np.arange(0.02, GOING, 0.04), np.arange(-WIDTH / 2 + 0.02, WIDTH / 2, 0.04)
    parts = []
    for number in range(count):
        z = low + RISE * (number + 1)
        u, v, h = (axis.ravel() for axis in np.meshgrid(depth, side, [z]))
        r, s, k = (axis.ravel() for axis in np.meshgrid([0.0], side, np.arange(z - RISE + 0.02, z, 0.04)))
        for a, b, heights in ((u, v, h), (r, s, k)):
            xy = np.array(start) + (GOING * number + a)[:, None] * along + b[:, None] * across
            parts.append(np.column_stack([xy, heights]))
    return np.concatenate(parts).astype(np.float32)


def spiral(middle: tuple[float, float], turn: float, count: int = 13) -> F32:
    """Treads from 0.15 to 1.0 m around a pole, the first from angle 0."""
    angle, radius = np.meshgrid(np.arange(0, turn, 0.02), np.arange(0.15, 1.0, 0.03))
    step = np.floor(angle / turn * count) + 1
    x, y = middle[0] + radius * np.cos(angle), middle[1] + radius * np.sin(angle)
    return np.column_stack([x.ravel(), y.ravel(), RISE * step.ravel()]).astype(np.float32)


def home(
    stairs: F32, hole: Rect, *climbing: Place, floors: tuple[float, float] = (0.0, UPSTAIRS)
) -> FloorEvidence:
    """Two storeys of 8 x 6 m, the upper one open over `hole`, seen from a corner of each; stairs seen from both."""
    x, y = (0.0, 8.0), (0.0, 6.0)
    low, high = floors
    ceiling = without(plane(x, y, (high - 0.3, high - 0.3)), *hole, (-9, 9))
    upper = without(plane(x, y, (high, high)), *hole, (-9, 9))
    return seen(
        (np.concatenate([plane(x, y, (low, low)), ceiling, stairs]), (7.0, 5.0, low + 1.3)),
        (np.concatenate([upper, stairs]), (7.0, 5.0, high + 1.3)),
        *((NOTHING, place) for place in climbing),
    )


STRAIGHT = flight((2.0, 3.0), (1, 0))
HOLE: Rect = ((2.0, 5.25), (2.55, 3.45))
