"""The regions experiment: what it averages, what it refuses, and one run over a furnished house."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from lab.evaluation.experiment import Options
from lab.evaluation.experiments.regions import RegionsResult, outcome_at, result_of
from lab.evaluation.regions.diagnosis import Verdict, diagnose
from lab.evaluation.regions.floors import FloorPlace, floor_place, place_specs
from lab.evaluation.regions.methods import METHODS
from lab.evaluation.regions.rows import Ground, score_regions
from lab.simulation.imperfect import halved, imperfect_batches, small_house_frames
from lab.simulation.small_house import load_small_house
from ovip.errors import InvalidInput
from services.regions.domain.survey import survey
from tests.unit.lab.evaluation.regions.two_room_homes import one_storey, two_storeys

HOUSE = Path(__file__).resolve().parents[6] / "shared" / "data" / "small_house"


def test_a_data_set_without_true_rooms_is_refused() -> None:
    with pytest.raises(InvalidInput, match="true rooms"):
        place_specs(Options(dataset="replica"))
    with pytest.raises(InvalidInput, match="small_house"):
        place_specs(Options(dataset="small_house"))


def test_simulated_homes_are_one_a_seed() -> None:
    assert [spec.seed for spec in place_specs(Options(homes=3, seed=7))] == [7, 8, 9]


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> RegionsResult:
    """Two homes, the second of which has two storeys and a room that the map calls by another use."""
    pytest.importorskip("matplotlib")
    lower = one_storey().place
    upper = two_storeys().place
    wrong = replace(
        upper.truth,
        name="renamed",
        areas=tuple(
            replace(area, function="gym") if area.area_id == 1 else area for area in upper.truth.areas
        ),
    )
    homes = [outcome_at(lower), outcome_at(replace(upper, truth=wrong))]
    return result_of(homes, tmp_path_factory.mktemp("figures"))


def test_a_result_is_json_and_has_every_method_and_each_home(result: RegionsResult) -> None:
    assert [row["config"] for row in result.rows] == list(METHODS)
    assert len(result.scenes) == 2 * len(METHODS)
    assert [each["scene"] for each in result.silhouettes] == ["two rooms", "renamed"]
    assert {each["kind"] for each in result.styles} == {"walled", "one floor", "more floors"}
    assert json.loads(json.dumps(result.worst)) == result.worst


def test_the_expectations_stand_in_the_notes_as_met_or_missed(result: RegionsResult) -> None:
    told = {row["expectation"]: row for row in result.expectations}
    acc = told["mean acc, ours less the best baseline's"]
    assert (acc["value"], acc["met"], acc["strict_met"]) == (0.0, True, True)
    area = told["area of the unit, HOV-SG's over ours"]
    assert area["met"] is False  # walls part these rooms: no method's are smaller
    notes = [note for note in result.notes if note.startswith("expected ")]
    assert len(notes) == sum(row["met"] is not None for row in result.expectations)
    assert sum("MISSED" in note for note in notes) == sum(row["met"] is False for row in result.expectations)


def test_the_worst_homes_say_what_went_wrong_with_each_area(result: RegionsResult) -> None:
    by_name = {home["scene"]: home for home in result.worst}
    assert set(by_name) == {"two rooms", "renamed"}
    areas = by_name["renamed"]["areas"]
    assert [each["verdict"] for each in areas] == ["found, function wrong", "found", "found", "found"]
    assert by_name["two rooms"]["why"] == []
    assert "renamed: bedroom: found, function wrong (bedroom)" in result.notes
    assert "renamed: found with their functions: kitchen, bedroom, kitchen" in result.notes
    assert {row["config"] for row in result.styles} == {"KGSW", "HOV-SG", "SysNav", "auto-K"}


def test_the_worst_homes_and_the_silhouettes_are_drawn(result: RegionsResult) -> None:
    assert [path.name for path in result.figures] == [
        "regions-worst-1.png",
        "regions-worst-2.png",
        "regions-worst-2-storey-1.png",
        "regions-silhouettes.png",
    ]
    assert all(path.read_bytes()[:4] == b"\x89PNG" for path in result.figures)


def test_no_homes_are_no_figures_and_nothing_expected() -> None:
    empty = result_of([])
    assert (empty.rows, empty.worst, empty.silhouettes) == ([], [], [])
    assert {row["met"] for row in empty.expectations} == {None}


@pytest.fixture(scope="module")
def house() -> FloorPlace:
    if not HOUSE.is_dir():
        pytest.skip(
            "../shared/data/small_house is not here: the regions of a furnished house were not scored"
        )
    home = load_small_house(HOUSE)
    return floor_place(home, imperfect_batches(halved(small_house_frames(HOUSE, 10)), home.objects))


@pytest.mark.recording
def test_walls_alone_leave_an_open_plan_whole_and_functions_cut_it(house: FloorPlace) -> None:
    surveyed = survey(house.evidence)
    ground = Ground.of(house, surveyed)
    compared = ("KGSW", "KGSW oracle functions", "HOV-SG", "SysNav")
    cuts = {name: METHODS[name](house, surveyed) for name in compared}
    rows = {name: score_regions(ground, cut, cuts["SysNav"]) for name, cut in cuts.items()}
    assert rows["HOV-SG"]["regions"] <= 2
    assert rows["SysNav"]["regions"] <= 2
    for ours in ("KGSW", "KGSW oracle functions"):
        for figures in (rows, {name: row["strict"] for name, row in rows.items()}):
            assert figures[ours]["acc"] > max(figures["HOV-SG"]["acc"], figures["SysNav"]["acc"])
        assert rows[ours]["area"] < 0.5 * rows["SysNav"]["area"]
        assert rows[ours]["containment"] > 0.7


@pytest.mark.recording
@pytest.mark.xfail(
    strict=True, reason="HydP .64 against SysNav's .68 where every tenth frame maps but 23 objects"
)
def test_on_a_sparse_map_of_an_open_plan_our_hydra_precision_is_the_best_too(house: FloorPlace) -> None:
    surveyed = survey(house.evidence)
    ground = Ground.of(house, surveyed)
    cuts = {name: METHODS[name](house, surveyed) for name in ("KGSW", "HOV-SG", "SysNav")}
    precision = {name: score_regions(ground, cut, cuts["SysNav"])["HydP"] for name, cut in cuts.items()}
    assert precision["KGSW"] > max(precision["HOV-SG"], precision["SysNav"])


@pytest.mark.recording
def test_of_every_area_of_the_furnished_house_it_is_said_what_became_of_it(house: FloorPlace) -> None:
    surveyed = survey(house.evidence)
    told = diagnose(Ground.of(house, surveyed), METHODS["KGSW"](house, surveyed))
    by_name = {area.name: area for area in told.areas}
    assert set(by_name) == {area.name for area in house.truth.areas}
    assert all(area.seen > 0.8 and area.function_found for area in told.areas)
    bedroom = by_name["bedroom"]
    assert (bedroom.verdict, bedroom.function_found) == (Verdict.FOUND, "bedroom")
