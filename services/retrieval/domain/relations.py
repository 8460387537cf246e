"""Relations judged from boxes alone: on, in, next to, under, above (SPEC 2.9, 4); the rest depends on where
one stands.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64
from services.retrieval.domain.judgement import Judgement, Verdict
from services.retrieval.domain.query import Relation, RelationKind


@dataclass(frozen=True, slots=True)
class RelationParams:
    """Metres and shares. Boxes of a robot's map are loose by about a decimetre."""

    rests_within: float = 0.15
    over_share: float = 0.5
    inside_share: float = 0.6
    beside: float = 0.6


def judge_relation(
    relation: Relation, box: F64, anchors: F64, params: RelationParams | None = None
) -> Judgement:
    """A box `(6,)` against the best of the anchor's boxes `(N, 6)`; unsettled without one or a rule."""
    params = params or RelationParams()
    said = f"{relation.words} the {relation.anchor}"
    rule = _RULES.get(relation.kind)
    if rule is None:
        return Judgement(Verdict.UNSURE, 0.5, f"{said!r} cannot be judged from boxes", (said,))
    if not len(anchors):
        return Judgement(
            Verdict.UNSURE, 0.5, f"no {relation.anchor!r} in the map to judge {said!r} by", (said,)
        )
    score = float(max(rule(box, anchor, params) for anchor in anchors))
    if score >= 0.5:
        return Judgement(Verdict.ACCEPT, score, said)
    return Judgement(Verdict.REJECT, score, f"not {said}")


def _on(box: F64, anchor: F64, params: RelationParams) -> float:
    """Bottom between the anchor's middle height and a little above its top (a seat lies below the back of a
    chair).
    """
    middle = anchor[2] + 0.35 * (anchor[5] - anchor[2])
    rests = middle <= box[2] <= anchor[5] + params.rests_within and box[5] > middle
    return _over_share(box, anchor) / (2.0 * params.over_share) if rests else 0.0


def _in(box: F64, anchor: F64, params: RelationParams) -> float:
    """Share of the box's volume that lies in the anchor's."""
    shared = np.prod(np.maximum(np.minimum(box[3:], anchor[3:]) - np.maximum(box[:3], anchor[:3]), 0.0))
    volume = np.prod(np.maximum(box[3:] - box[:3], 1e-3))
    return float(np.clip(shared / volume / (2.0 * params.inside_share), 0.0, 1.0))


def _next_to(box: F64, anchor: F64, params: RelationParams) -> float:
    """Footprints apart by no more than `beside`, heights less than that apart; 1 where they touch."""
    gap = np.maximum(np.maximum(anchor[:3] - box[3:], box[:3] - anchor[3:]), 0.0)
    apart = float(np.hypot(gap[0], gap[1]))
    if gap[2] > params.beside or _over_share(box, anchor) > params.over_share:
        return 0.0
    return float(np.clip(1.0 - 0.5 * apart / params.beside, 0.0, 1.0))


def _under(box: F64, anchor: F64, params: RelationParams) -> float:
    """Its top below the anchor's, its middle below the anchor's middle, its footprint under the anchor's."""
    below = box[5] <= anchor[5] and box[2] + box[5] < anchor[2] + anchor[5]
    return _over_share(box, anchor) / (2.0 * params.over_share) if below else 0.0


def _above(box: F64, anchor: F64, params: RelationParams) -> float:
    """Its bottom at or over the anchor's top, its footprint over the anchor's."""
    over = box[2] >= anchor[5] - params.rests_within
    return _over_share(box, anchor) / (2.0 * params.over_share) if over else 0.0


def _over_share(box: F64, anchor: F64) -> float:
    """Share of the box's footprint that lies over the anchor's."""
    shared = np.prod(np.maximum(np.minimum(box[3:5], anchor[3:5]) - np.maximum(box[:2], anchor[:2]), 0.0))
    return float(shared / np.prod(np.maximum(box[3:5] - box[:2], 1e-3)))


_RULES = {
    RelationKind.ON: _on,
    RelationKind.IN: _in,
    RelationKind.NEXT_TO: _next_to,
    RelationKind.UNDER: _under,
    RelationKind.ABOVE: _above,
}
