"""The ablation's rows differ from one another in the one thing that their name says."""

from __future__ import annotations

from dataclasses import replace

from services.mapper.domain.association import AssociationParams
from services.mapper.domain.fusion import FusionParams, Weighting
from services.mapper.domain.params import MapParams
from services.mapper.domain.presets import PRESETS
from services.mapper.domain.spatial import Spatial


def test_the_rows_come_in_the_paper_s_order() -> None:
    assert list(PRESETS) == ["overlap", "+IPSM", "+LAMP", "+AWF", "ours"]


def test_the_first_row_is_conceptgraphs() -> None:
    first = PRESETS["overlap"]

    assert first.association == AssociationParams(0.0, 0.0, 1.2, Spatial.OVERLAP)
    assert first.fusion.weighting is Weighting.COUNT
    assert (first.upkeep.merge_overlap, first.upkeep.merge_similarity) == (0.7, 0.7)


def test_each_row_adds_one_thing() -> None:
    overlap, ipsm, lamp, awf, ours = PRESETS.values()
    paper = AssociationParams()

    assert ipsm == replace(
        overlap, association=replace(overlap.association, spatial=Spatial.IOU, tau=paper.tau)
    )
    assert lamp == replace(ipsm, association=paper)
    assert awf == replace(lamp, fusion=FusionParams())
    assert ours == MapParams()
