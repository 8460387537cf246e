"""The ablation's configurations of the mapper, from ConceptGraphs' overlap map to ours (SPEC 2.5, 7)."""

from __future__ import annotations

from dataclasses import replace

from services.mapper.domain.association import AssociationParams
from services.mapper.domain.fusion import FusionParams, Weighting
from services.mapper.domain.params import MapParams
from services.mapper.domain.presence import PresenceParams
from services.mapper.domain.spatial import Spatial
from services.mapper.domain.upkeep import UpkeepParams

_CONCEPTGRAPHS = MapParams(
    association=AssociationParams(label_penalty=0.0, tau=1.2, spatial=Spatial.OVERLAP),
    fusion=FusionParams(weighting=Weighting.COUNT),
    upkeep=UpkeepParams(
        every=20,
        eager=False,
        same_label=False,
        merge_overlap=0.7,
        merge_inside=float("inf"),
        merge_similarity=0.7,
        merge_mutual=float("inf"),
        reach=0.025,
        confirm_frames=3,
        cluster_radius=0.1,
        cluster_share=1.0,
    ),
    presence=PresenceParams(departed_share=float("inf"), small_share=float("inf")),
)
_IPSM = replace(
    _CONCEPTGRAPHS,
    association=replace(_CONCEPTGRAPHS.association, spatial=Spatial.IOU, tau=AssociationParams().tau),
)
_LAMP = replace(
    _IPSM, association=replace(_IPSM.association, label_penalty=AssociationParams().label_penalty)
)
_AWF = replace(_LAMP, fusion=FusionParams())

PRESETS: dict[str, MapParams] = {
    "overlap": _CONCEPTGRAPHS,
    "+IPSM": _IPSM,
    "+LAMP": _LAMP,
    "+AWF": _AWF,
    "ours": MapParams(),
}
"""Each row changes one thing, as in the paper: ConceptGraphs' own association, fusion and upkeep; the symmetric IoU
(with the tau that goes with it); the label penalty; the view-area weights. The last one is what the mapper runs: the
same association and fusion, and our upkeep."""
