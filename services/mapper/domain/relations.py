"""How objects stand to one another: on, in, next to, attached to, from their clouds alone, with what was measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ovip.scene.types import F64, Relation, RelationKind
from services.mapper.domain.contacts import plan_gap
from services.mapper.domain.holding import Hold, holds
from services.mapper.domain.shapes import LOOSE, Body, RelationParams, is_structure

__all__ = ["Body", "RelationParams", "reach", "relations_of"]


def reach(params: RelationParams | None = None) -> float:
    """Metres from a body's box, along each axis, beyond which nothing matters to its relations."""
    params = params or RelationParams()
    return max(params.beside, _contact(params))


def relations_of(
    body: Body, others: Sequence[Body], params: RelationParams | None = None
) -> tuple[Relation, ...]:
    """The relations that `body` has to others: on, in, attached to, next to, each by id. Others out of `reach` do not
    matter, nor does their order.

    Being next to is mutual, being on or in something never is. Nothing is said of bodies without points, nor of
    floors, walls and ceilings but that they hold things.
    """
    params = params or RelationParams()
    near = _within(body, others, reach(params))
    if not len(body.points) or not near or is_structure(body, params):
        return ()
    held = {other.object_id: holds(body, other, params) for other in _within(body, near, _contact(params))}
    holders = [other for other in near if held.get(other.object_id)]
    free = [other for other in near if not held.get(other.object_id)]
    found = [hold for some in held.values() for hold in some]
    return (*_chosen(found, params), *_next_to(body, free, holders, params))


def _contact(params: RelationParams) -> float:
    """Metres from a body's box beyond which nothing can hold it."""
    return max(params.gap, params.rim)


def _within(body: Body, others: Sequence[Body], distance: float) -> list[Body]:
    """Others with points whose box is at most `distance` from the body's along each axis, by id."""
    found = [other for other in others if len(other.points) and other.object_id != body.object_id]
    if not found:
        return []
    boxes = np.stack([other.box for other in found])
    near = (boxes[:, :3] <= body.box[3:] + distance) & (boxes[:, 3:] >= body.box[:3] - distance)
    return sorted((found[i] for i in np.flatnonzero(near.all(axis=1))), key=lambda other: other.object_id)


def _chosen(found: Sequence[Hold], params: RelationParams) -> tuple[Relation, ...]:
    """What holds a thing after all: what bears it; the smallest around it; what backs it best where nothing does
    either."""
    ranked = sorted(found, key=lambda hold: (-hold.rank, hold.relation.other_id))
    on, around, backing = (
        [hold for hold in ranked if hold.relation.kind is kind]
        for kind in (RelationKind.ON, RelationKind.IN, RelationKind.ATTACHED_TO)
    )
    chosen = (*_supports(on, params), *around[:1]) or tuple(backing[:1])
    return tuple(hold.relation for hold in chosen)


def _supports(found: Sequence[Hold], params: RelationParams) -> list[Hold]:
    """Of what may bear a thing, highest first: the highest that bears at least half as much as any; and what is as
    high and bears mostly other parts of it."""
    if not found:
        return []
    most = max(hold.relation.evidence["support"] for hold in found)
    best = next(hold for hold in found if 2 * hold.relation.evidence["support"] >= most)
    kept, borne = [best], best.borne
    assert borne is not None
    for hold in found:
        if hold is best or hold.borne is None or abs(hold.rank - best.rank) > LOOSE:
            continue
        more = hold.borne & ~borne
        if more.mean() >= params.support and 2 * more.sum() >= hold.borne.sum():
            kept.append(hold)
            borne = borne | hold.borne
    return sorted(kept, key=lambda hold: hold.relation.other_id)


def _next_to(
    body: Body, others: Sequence[Body], holders: Sequence[Body], params: RelationParams
) -> list[Relation]:
    """Which of the others that do not hold a thing are beside it: close in plan, at heights that meet, and either as
    high up, or mostly at one height and held by what may hold both."""
    found = []
    for other in others:
        overlap = min(body.top, other.top) - max(body.bottom, other.bottom)
        if overlap < -LOOSE or (gap := _gap(body, other)) > params.beside:
            continue
        if is_structure(other, params) or holds(other, body, params):
            continue
        alike = abs(body.bottom - other.bottom) <= params.level
        abreast = 2 * overlap >= min(body.top - body.bottom, other.top - other.bottom)
        if alike or (abreast and any(holds(other, holder, params) for holder in holders)):
            evidence = {"gap": gap, "overlap": overlap}
            found.append(Relation(RelationKind.NEXT_TO, other.object_id, evidence))
    return found


def _gap(one: Body, other: Body) -> float:
    """Metres between two things in plan: between their boxes or their outlines, whichever says more."""
    return max(_box_gap(one.box, other.box), plan_gap(one.extents, other.extents))


def _box_gap(a: F64, b: F64) -> float:
    return float(np.hypot(*np.maximum(np.maximum(a[:2] - b[3:5], b[:2] - a[3:5]), 0.0)))
