"""The regions protocol on two rooms with a door, twice over: what each method's figures must be there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lab.evaluation.regions.floors import FloorPlace, RegionTruth, Target, rooms_of
from lab.evaluation.regions.methods import METHODS, service_params, true_functions
from lab.evaluation.regions.plans import storey_plans
from lab.evaluation.regions.rows import Ground, holders, predicted_rooms, score_regions, seen_share, units_of
from lab.simulation.home import Area, Storey
from ovip.scene.types import F32, F64
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.partition import Relief
from services.regions.domain.survey import survey
from tests.unit.services.regions.rooms import plane, room, seen, two_rooms, without

THINGS = (("bed", 1.0, 3.0), ("nightstand", 2.5, 3.5), ("stove", 7.5, 3.5), ("fridge", 7.5, 1.9))


def square(x0: float, x1: float) -> F64:
    return np.array([[x0, 0.0], [x1, 0.0], [x1, 4.05], [x0, 4.05]])


def area(number: int, floor: int, function: str, x0: float, x1: float) -> Area:
    return Area(number, floor, function, function, square(x0, x1), number)


def truth(storeys: tuple[float, ...] = (0.0,)) -> RegionTruth:
    areas = tuple(
        area(10 * floor + k, floor, function, *x)
        for floor in range(len(storeys))
        for k, (function, x) in enumerate((("bedroom", (0.0, 4.05)), ("kitchen", (4.2, 8.25))), start=1)
    )
    targets = tuple(
        Target(label, np.array([x, y, z + 0.5]), floor, "bedroom" if x < 4 else "kitchen")
        for floor, z in enumerate(storeys)
        for label, x, y in THINGS
    )
    floors = tuple(Storey(k, z, z + 2.5) for k, z in enumerate(storeys))
    return RegionTruth("two rooms", "walled", floors, areas, areas, targets, np.zeros((0, 6)))


def placed(told: RegionTruth) -> PlacedObjects:
    return PlacedObjects(
        tuple(f"o{k}" for k in range(len(told.targets))),
        tuple(target.label for target in told.targets),
        np.array([target.centre for target in told.targets]).reshape(-1, 3),
    )


def ground(evidence: FloorEvidence, told: RegionTruth, queries: int = 0) -> Ground:
    place = FloorPlace(told, evidence, placed(told))
    return Ground.of(place, survey(evidence), queries)


def one_storey() -> Ground:
    return ground(two_rooms(), truth())


def two_storeys() -> Ground:
    evidence = seen(
        *[
            (cloud + np.array([0, 0, z], np.float32), (x, 2.0, z + 1.2))
            for z in (0.0, 3.0)
            for cloud, x in _views()
        ]
    )
    return ground(evidence, truth((0.0, 3.0)))


def _views() -> list[tuple[F32, float]]:
    sill = plane((4.025, 4.225), (1.6, 2.5), (0.0, 0.0))
    left = without(room((0.025, 4.025), (0.025, 4.025)), (4.0, 4.1), (1.6, 2.5), (-0.1, 2.0))
    right = without(room((4.225, 8.225), (0.025, 4.025)), (4.2, 4.3), (1.6, 2.5), (-0.1, 2.0))
    return [(np.concatenate([left, sill]), 2.0), (np.concatenate([right, sill]), 6.0)]


@pytest.mark.parametrize("name", list(METHODS))
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


@pytest.mark.parametrize("name", list(METHODS))
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
    assert true_functions(here.place, here.surveyed) == ("bedroom", "bedroom", "kitchen", "kitchen")
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
    params = service_params()
    assert (params.dilation, params.marker_radius, params.eps) == (6, 0.30, 2.0)
    assert params.relief is Relief.ARRIVAL


def test_plans_show_the_truth_and_the_methods_of_each_storey(tmp_path: Path) -> None:
    here = two_storeys()
    cuts = {name: method(here.place, here.surveyed) for name, method in METHODS.items()}
    rows = {name: score_regions(here, cut, cuts["SysNav"]) for name, cut in cuts.items()}
    lower, upper = storey_plans(here, cuts, rows)
    assert upper.title == "two rooms (walled), storey 1"
    assert [plan.title for plan in lower.plans] == [
        "truth",
        "KGSW",
        "KGSW -D relief",
        "HOV-SG",
        "SysNav",
        "auto-K",
    ]
    assert lower.plans[0].names == ("bedroom", "kitchen")
    assert len(lower.backdrop.dots) == 4
    pytest.importorskip("matplotlib")
    assert lower.draw(tmp_path / "plan.png").read_bytes()[:4] == b"\x89PNG"
