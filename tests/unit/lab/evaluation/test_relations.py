from __future__ import annotations

import numpy as np
import pytest

from lab.evaluation.experiment import Options
from lab.evaluation.experiments.relations import facts_of, row_of, run, tally_of, told_of
from lab.evaluation.scores.relations import Fact, KindCounts, holder_counts, kind_counts, loose_counts
from lab.evaluation.true_clouds import clouds_of_walk
from lab.simulation.camera import pose_looking
from lab.simulation.imperfect import rendered_frames
from lab.simulation.world import HOME_CAMERA
from ovip.errors import InvalidInput
from ovip.scene.types import RelationKind
from tests.unit.lab.simulation.box_homes import BED, MUG, TABLE, box_home

ON, IN, NEXT_TO, ATTACHED_TO = (
    RelationKind.ON,
    RelationKind.IN,
    RelationKind.NEXT_TO,
    RelationKind.ATTACHED_TO,
)
TRUE: frozenset[Fact] = frozenset({(1, ON, 9), (2, IN, 8), (3, IN, 8), (4, ATTACHED_TO, 7), (1, NEXT_TO, 2)})


def test_precision_counts_what_is_told_and_recall_what_is_true() -> None:
    told = {(1, ON, 9), (5, ON, 9), (2, IN, 8), (2, NEXT_TO, 1)}
    assert kind_counts(told, TRUE, ON) == KindCounts(told=2, right=1, true=1, found=1)
    assert kind_counts(told, TRUE, IN) == KindCounts(told=1, right=1, true=2, found=1)
    assert kind_counts(told, TRUE, IN).recall == 0.5
    assert kind_counts(told, TRUE, NEXT_TO).precision == 0.0
    assert kind_counts(told, TRUE, ATTACHED_TO) == KindCounts(told=0, right=0, true=1, found=0)
    assert kind_counts(told, TRUE, ATTACHED_TO).precision is None
    assert kind_counts(told, [], ON).recall is None


def test_what_is_in_a_thing_may_be_told_to_be_on_it_and_helps_no_recall() -> None:
    told = {(2, ON, 8), (2, IN, 8), (3, ON, 7)}
    assert kind_counts(told, TRUE, ON) == KindCounts(told=2, right=0, true=1, found=0)
    assert loose_counts(told, TRUE, ON) == KindCounts(told=2, right=1, true=1, found=0)
    assert loose_counts(told, TRUE, IN) == kind_counts(told, TRUE, IN)


def test_a_holder_is_right_whichever_way_it_holds_and_counts_once() -> None:
    told = {(2, ON, 8), (2, IN, 8), (4, ON, 7), (1, NEXT_TO, 9), (3, ON, 9)}
    assert holder_counts(told, TRUE) == KindCounts(told=3, right=2, true=4, found=2)


def test_a_row_holds_figures_and_the_same_to_the_letter() -> None:
    row = row_of(tally_of({(1, ON, 9), (2, ON, 8)}, TRUE))
    assert (row["on_P"], row["on_R"], row["on_n"]) == (1.0, 1.0, 1)
    assert row["strict"]["on_P"] == 0.5
    assert (row["in_P"], row["in_R"]) == (None, 0.0)
    assert (row["holder_P"], row["holder_R"], row["holder_n"]) == (1.0, 0.5, 4)


def test_a_data_set_without_relations_is_refused() -> None:
    with pytest.raises(InvalidInput, match="small_house"):
        run(Options(dataset="small_house"))


def test_the_walked_clouds_of_a_home_tell_its_mug_is_on_its_table_even_by_a_noisy_camera() -> None:
    pytest.importorskip("open3d")
    from lab.simulation.renderer import Renderer

    home = box_home()
    eyes = [(0.8, 1.2), (2.0, 0.9), (3.4, 1.4)]
    poses = [pose_looking(np.array([x, y, 1.5]), float(np.arctan2(2.35 - y, 2.0 - x)), -0.5) for x, y in eyes]
    clouds = clouds_of_walk(rendered_frames(Renderer(home, HOME_CAMERA), poses), seed=0)
    assert MUG in clouds.exact and TABLE in clouds.exact and BED not in clouds.exact
    assert facts_of(home) == {(MUG, ON, TABLE)}
    for seen in (clouds.exact, clouds.noisy):
        told = told_of({i: points for i, points in seen.items() if i in (MUG, TABLE)})
        assert told == {(MUG, ON, TABLE)}
