"""What may hold a thing, pair by pair: bear it from below, surround it, back it, carry it from above."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, F64, I64, Bools, Relation, RelationKind
from services.mapper.domain.contacts import Face, closed_sides, vertical_plane
from services.mapper.domain.shapes import LOOSE, Body, RelationParams, is_panel, lies_flat

_UNDER = 0.2  # metres below a hanging thing where what it hangs on should show


@dataclass(frozen=True, slots=True, eq=False)
class Hold:
    """That something holds a thing. rank: the larger, the likelier among its kind.

    borne: `(U, V)` which cells of the thing's footprint it bears; only where the thing is on it.
    """

    relation: Relation
    rank: float
    borne: Bools | None = None


def holds(thing: Body, other: Body, params: RelationParams) -> tuple[Hold, ...]:
    """All that an other may be to a thing, whatever else there is; measured once while both are as they are."""
    known: tuple[RelationParams, tuple[Hold, ...]] | None = thing.known.get(other)
    if known is None or known[0] != params:
        known = thing.known[other] = (params, _measured(thing, other, params))
    return known[1]


def _measured(thing: Body, other: Body, params: RelationParams) -> tuple[Hold, ...]:
    """Boxes tell first what cannot be."""
    bears, backs, carries = (
        _may_bear(thing, other, params),
        _may_back(thing, other, params),
        lies_flat(other, params),
    )
    near = _points_around(thing, other, params) if bears or backs or carries else np.zeros((0, 3), np.float32)
    found = (
        _surrounding(thing, other, params),
        _bearing(thing, other, near, params) if bears and len(near) else None,
        _backing(thing, other, near, params) if backs and len(near) else None,
        _carrying(thing, other, near, params) if carries and len(near) else None,
    )
    return tuple(hold for hold in found if hold is not None)


def _may_bear(thing: Body, other: Body, params: RelationParams) -> bool:
    """Whether the thing is over the other, and the upper one of them."""
    low = thing.bottom - params.gap
    return bool(
        other.box[5] >= low
        and other.box[2] <= thing.bottom + params.sink
        and _rests_on(thing, other)
        and _share_over(thing.foot, other.box) >= params.over
    )


def _may_back(thing: Body, other: Body, params: RelationParams) -> bool:
    """Whether the other is the larger one, and reaches under the thing's bottom and above it."""
    low, high = other.box[2], other.box[5]
    under = bool(low < thing.bottom - params.sink and high >= thing.bottom + LOOSE)
    return under and other.longest > thing.longest


def _points_around(thing: Body, other: Body, params: RelationParams) -> F32:
    """The other's points around a thing `(K, 3)`."""
    around = max(params.gap, params.rim)
    points, box = other.points, thing.box
    for axis, below in ((0, around), (1, around), (2, max(around, _UNDER))):
        along = points[:, axis]
        points = points[(along >= box[axis] - below) & (along <= box[axis + 3] + around)]
    return points


def _bearing(thing: Body, other: Body, near: F32, params: RelationParams) -> Hold | None:
    """On: the other's points lie just under the thing's bottom, in its footprint or around it.

    Where the other goes on upwards beside the thing, it does not bear it.
    """
    face, over = Face.of(thing.foot, params.rim), thing.bottom + params.sink
    on, cell = face.cells_of(near[:, :2])
    z = near[on, 2]
    under = (z >= thing.bottom - params.gap) & (z <= over)
    beside = (z > over) & (z <= max(thing.top, over + params.sink))
    cells = face.marked(cell[under]) & ~face.marked(cell[beside])
    share = _share_backed(face, cells)
    if share < params.support or is_panel(other, params) or _enclosed(other, thing, params):
        return None
    level = _level(cells, cell[under], z[under])
    evidence = {"gap": thing.bottom - level, "support": share}
    return Hold(Relation(RelationKind.ON, other.object_id, evidence), level, face.backed(cells))


def _share_backed(face: Face, grid: Bools) -> float:
    """Share of a face that is backed; of its edges, where that is more."""
    return float(max(face.backed(grid).mean(), np.concatenate(face.edges(grid)).mean()))


def _share_over(plan: F64, box: F64) -> float:
    """Share of a box in plan `(4,)` that lies over a box `(6,)`."""
    return _share_within(plan[[0, 2]], box[[0, 3]]) * _share_within(plan[[1, 3]], box[[1, 4]])


def _rests_on(thing: Body, other: Body) -> bool:
    """Whether the thing is the upper one: by its bottom; by its middle, where the bottoms hardly differ."""
    step = float(thing.box[2] - other.box[2])
    if abs(step) > LOOSE:
        return step > 0
    return bool(thing.box[2] + thing.box[5] > other.box[2] + other.box[5])


def _level(cells: Bools, cell: I64, z: F32) -> float:
    """The height of what bears: the middle one of the cells' highest points."""
    highest = np.full(cells.size, -np.inf)
    np.maximum.at(highest, cell, z)
    return float(np.median(highest[cells.ravel()]))


def _surrounding(thing: Body, other: Body, params: RelationParams) -> Hold | None:
    """In: most of the thing's box lies in the other's, which closes it off."""
    found = _enclosed(thing, other, params)
    if found is None:
        return None
    inside, sides = found
    evidence = {"inside": inside, "sides": float(sides)}
    return Hold(Relation(RelationKind.IN, other.object_id, evidence), -other.volume)


def _enclosed(thing: Body, other: Body, params: RelationParams) -> tuple[float, int] | None:
    """How much of a thing lies in the outline and between the bottom and the top of the other, and how many of its
    six sides that closes; None where it is not in it.

    A bowl closes all sides but the upper; a shelf is closed below, above and on two sides more. A table has no
    sides, a sofa no front and no top.
    """
    if other.volume <= thing.volume:
        return None
    box = np.concatenate([thing.box[:2], [thing.bottom], thing.box[3:5], [thing.top]])
    if _share_within(box[[0, 3]], other.box[[0, 3]]) < params.inside:
        return None
    inside = _share_within(box[[2, 5]], other.box[[2, 5]]) * _share_within(thing.extents, other.extents)
    if inside < params.inside or is_panel(other, params):
        return None
    closed = closed_sides(_outside(other.points, box), box, params.rim) >= params.closed
    around, below, above = int(closed[:4].sum()), bool(closed[4]), bool(closed[5])
    if below and (around == 4 or (above and around >= 2)):
        return inside, int(closed.sum())
    return None


def _outside(points: F32, box: F64) -> F32:
    """Points that are not of the thing in a box: a map's furniture often holds some of what stands on it."""
    inside = (points >= box[:3] - LOOSE) & (points <= box[3:] + LOOSE)
    return points[~inside.all(axis=1)]


def _share_within(own: F64, others: F64) -> float:
    """The least share of what a thing spans, `(2,)` or `(2, D)` from and to, that lies in what the other does."""
    low, high = own[0] - LOOSE / 2, own[1] + LOOSE / 2
    shared = np.minimum(high, others[1] + LOOSE) - np.maximum(low, others[0] - LOOSE)
    return float(np.clip(shared / (high - low), 0, 1).min())


def _backing(thing: Body, other: Body, near: F32, params: RelationParams) -> Hold | None:
    """Attached to something upright: its plane lies behind the thing, shows below it, and goes up beside it."""
    if (plane := vertical_plane(near)) is None:
        return None
    normal, offset, flat = plane
    wall, points = near[flat], thing.points
    if wall[:, 2].max() < thing.bottom + LOOSE:
        return None
    gap = _distance(points[:, :2] @ normal - offset)
    if not -params.sink <= gap <= params.gap:
        return None
    tangent = np.array([-normal[1], normal[0]])
    across, along = points[:, :2] @ tangent, wall[:, :2] @ tangent
    face = Face.of(np.array([across.min(), thing.bottom, across.max(), thing.top]), params.rim)
    _, cell = face.cells_of(np.stack([along, wall[:, 2]], axis=1))
    share = _share_faced(face, face.marked(cell))
    if is_panel(other, params):  # it goes on behind the thing, wherever it shows
        share = max(share, _share_backed(face, face.marked(cell)))
    below = along[wall[:, 2] < thing.bottom - params.sink]
    if share < params.facing or _share_along(below, across) < params.facing:
        return None
    evidence = {"gap": gap, "facing": share}
    return Hold(Relation(RelationKind.ATTACHED_TO, other.object_id, evidence), share - abs(gap) / params.gap)


def _distance(away: F64) -> float:
    """Metres between a plane and the near end, but for strays, of points so far from it `(P,)` to either side."""
    away = away if away.mean() >= 0 else -away
    stray = len(away) // 20
    return float(np.partition(away, stray)[stray])


def _share_faced(face: Face, grid: Bools) -> float:
    """Share of an upright face that is backed; of its edges but the lower one, where that is more."""
    left, right, _, over = face.edges(grid)
    return float(max(face.backed(grid).mean(), np.concatenate([left, right, over]).mean()))


def _share_along(places: F64, across: F64) -> float:
    """In how many quarters of the way across a thing there are places."""
    low, width = across.min(), max(float(np.ptp(across)), 1e-3)
    quarter = np.floor((places - low) * (4 / width)).astype(np.int64)
    return sum(bool((quarter == i).any()) for i in range(4)) / 4


def _carrying(thing: Body, other: Body, near: F32, params: RelationParams) -> Hold | None:
    """Attached to a ceiling: its points lie just over the thing's top."""
    if near[:, 2].min() < thing.bottom:
        return None
    face = Face.of(thing.head, params.rim)
    on, cell = face.cells_of(near[:, :2])
    z = near[on, 2]
    over = (z >= thing.top - params.sink) & (z <= thing.top + params.gap)
    cells = face.marked(cell[over])
    share = _share_backed(face, cells)
    if share < params.facing:
        return None
    gap = float(np.median(z[over])) - thing.top
    evidence = {"gap": gap, "facing": share}
    return Hold(Relation(RelationKind.ATTACHED_TO, other.object_id, evidence), share - abs(gap) / params.gap)
