"""The regions protocol on two rooms with a door, twice over: what each method's figures must be there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lab.evaluation.regions.diagnosis import diagnose
from lab.evaluation.regions.expectations import BASELINES, OURS
from lab.evaluation.regions.floors import FloorPlace, rooms_of
from lab.evaluation.regions.methods import METHODS, assembled, ours_but, service_params, true_functions
from lab.evaluation.regions.plans import storey_plans
from lab.evaluation.regions.rows import Ground, holders, predicted_rooms, score_regions, seen_share, units_of
from services.regions.config import Settings
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.partition import PartitionParams
from services.regions.domain.survey import survey
from tests.unit.lab.evaluation.regions.two_room_homes import (
    FUNCTIONS_OF_THINGS,
    area,
    ground,
    one_storey,
    placed,
    truth,
    two_storeys,
)
from tests.unit.services.regions.rooms import two_rooms

COMPARED = (OURS, "KGSW oracle functions", "KGSW to the letter", *BASELINES)


@pytest.mark.parametrize("name", COMPARED)
def test_every_method_finds_two_walled_rooms(name: str) -> None:
    here = one_storey()
    cut = METHODS[name](here.place, here.surveyed)
    row = score_regions(here, cut, cut)
    assert (row["regions"], row["gt_regions"]) == (2, 2)
    assert row["HydP"] > 0.95
    assert row["HydR"] > 0.9
    assert row["acc"] == row["strict"]["acc"] == row["rooms"]["acc"] == 1.0
    assert row["AP"] == pytest.approx(1.0)
    assert row["containment"] == 1.0
    assert row["area"] == pytest.approx(0.5, abs=0.03)
    assert row["objects"] == 0.5
    assert row["viewpoints"] == pytest.approx(0.5, abs=0.2)


@pytest.mark.parametrize("name", COMPARED)
def test_two_storeys_are_each_compared_with_their_own(name: str) -> None:
    here = two_storeys()
    cut = METHODS[name](here.place, here.surveyed)
    assert here.floors == (0, 1)
    assert [r.floor for r in predicted_rooms(here, cut)] == [0, 0, 1, 1]
    row = score_regions(here, cut, cut)
    assert row["acc"] == 1.0
    assert row["HydP"] > 0.95
    assert row["area"] == pytest.approx(0.5, abs=0.03)  # of its own floor


def test_an_area_of_another_storey_is_no_match() -> None:
    here = one_storey()
    cut = METHODS["KGSW"](here.place, here.surveyed)
    upstairs = truth((-3.0, 0.0))
    below = Ground(
        FloorPlace(upstairs, here.place.evidence, here.place.objects), here.surveyed, (0,), here.waypoints, ()
    )
    assert score_regions(below, cut, cut)["HydR"] == pytest.approx(0.5, abs=0.05)


def test_routes_go_by_label_and_by_function() -> None:
    here = one_storey()
    row = score_regions(here, *[METHODS["KGSW"](here.place, here.surveyed)] * 2)
    assert row["routing_success"] == 1.0
    assert row["routing_cost"] == pytest.approx(0.5, abs=0.2)
    assert row["by_function"]["routing_success"] == 1.0
    assert "by_function" not in score_regions(here, *[METHODS["HOV-SG"](here.place, here.surveyed)] * 2)


def test_a_target_is_held_by_the_region_under_its_centre_on_its_own_storey() -> None:
    here = two_storeys()
    cut = METHODS["KGSW"](here.place, here.surveyed)
    holder = holders(here, cut)
    assert len(set(holder.tolist())) == 4
    assert holder[0] == holder[1] != holder[2] == holder[3]
    assert units_of(here, cut).floor.tolist() == [0, 0, 1, 1]


def test_true_functions_are_those_of_the_areas_and_near_a_wall_of_the_nearest() -> None:
    here = one_storey()
    assert true_functions(here.place, here.surveyed) == FUNCTIONS_OF_THINGS
    assert here.place.truth.function_at(0, np.array([4.16, 2.0])) == "kitchen"
    assert here.place.truth.function_at(0, np.array([-3.0, 2.0])) == "bedroom"
    assert here.place.truth.function_at(5, np.array([1.0, 2.0])) == ""


def test_queries_are_spread_over_the_things() -> None:
    assert [t.label for t in ground(two_rooms(), truth(), 2).targets] == ["bed", "fridge"]
    assert len(ground(two_rooms(), truth(), 99).targets) == 4


def test_a_home_without_objects_or_frames_scores_nothing_and_does_not_break() -> None:
    told = truth()
    bare = Ground.of(FloorPlace(told, two_rooms(), PlacedObjects.none()), survey(two_rooms()))
    for method in METHODS.values():
        cut = method(bare.place, bare.surveyed)
        assert score_regions(bare, cut, cut)["routing_success"] == 0.0
    unseen = Ground.of(FloorPlace(told, FloorEvidence(), placed(told)), ())
    for method in METHODS.values():
        cut = method(unseen.place, unseen.surveyed)
        row = score_regions(unseen, cut, cut)
        assert (row["regions"], row["HydP"], row["containment"], row["area"]) == (0, 0.0, 0.0, None)


def test_how_much_of_the_floor_was_seen() -> None:
    assert seen_share(one_storey()) == pytest.approx(0.96, abs=0.04)
    upstairs = truth((-3.0, 0.0))  # of which only the upper storey was walked through
    assert seen_share(ground(two_rooms(), upstairs)) == pytest.approx(0.48, abs=0.02)
    assert seen_share(Ground.of(FloorPlace(truth(), FloorEvidence(), PlacedObjects.none()), ())) == 0.0


def test_areas_become_cells_of_the_worlds_lattice() -> None:
    (cells,) = rooms_of([area(1, 0, "bedroom", 1.0, 1.2), area(2, 0, "nook", 3.01, 3.02)])
    assert len(cells.points) == 4 * 81
    assert cells.points[0] == pytest.approx((1.025, 0.025))


def test_kgsw_runs_with_the_services_own_numbers() -> None:
    assert service_params() == Settings.model_construct().partition
    assert service_params() != PartitionParams()


def test_the_papers_own_settings_leave_out_what_ours_adds() -> None:
    here = one_storey()
    letter = METHODS["KGSW to the letter"](here.place, here.surveyed)
    (own,) = assembled(here.place, here.surveyed, FUNCTIONS_OF_THINGS, PartitionParams())
    assert np.array_equal(letter[0].labels, own.labels)
    assert letter[0].functions == own.functions == ("bedroom", "kitchen")


def test_ours_with_one_number_of_the_papers_differs_in_that_alone() -> None:
    here = one_storey()
    (plain,) = METHODS["KGSW"](here.place, here.surveyed)
    (same,) = ours_but(eps=service_params().eps)(here.place, here.surveyed)
    assert np.array_equal(plain.labels, same.labels)
    (lone,) = ours_but(votes=9)(here.place, here.surveyed)
    (directly,) = assembled(
        here.place, here.surveyed, FUNCTIONS_OF_THINGS, replace(service_params(), votes=9)
    )
    assert np.array_equal(lone.labels, directly.labels)


def test_plans_show_the_truth_and_the_methods_of_each_storey() -> None:
    here = two_storeys()
    cuts = {name: method(here.place, here.surveyed) for name, method in METHODS.items()}
    rows = {name: score_regions(here, cut, cuts["SysNav"]) for name, cut in cuts.items()}
    lower, upper = storey_plans(here, cuts, rows, diagnose(here, cuts["KGSW"]))
    assert upper.title == "two rooms (walled), storey 1"
    assert [plan.title for plan in lower.plans] == [
        "truth",
        "KGSW",
        "KGSW to the letter",
        "HOV-SG",
        "SysNav",
        "auto-K",
    ]
    assert lower.plans[0].names == ("bedroom", "kitchen")
    assert lower.plans[0].under == ("found", "found")
    assert len(lower.backdrop.dots) == 4
