"""The regions experiment: what it averages, what it refuses, and one run over a furnished house."""

from __future__ import annotations

from pathlib import Path

import pytest

from lab.evaluation.experiment import Options, Row
from lab.evaluation.experiments.regions import mean_rows
from lab.evaluation.regions.floors import FloorPlace, floor_place, place_specs
from lab.evaluation.regions.methods import METHODS
from lab.evaluation.regions.rows import Ground, score_regions
from lab.simulation.imperfect import halved, imperfect_batches, small_house_frames
from lab.simulation.small_house import load_small_house
from ovip.errors import InvalidInput
from services.regions.domain.survey import survey

HOUSE = Path(__file__).resolve().parents[5] / "shared" / "data" / "small_house"


def row(config: str, scene: str, floors: int, **figures: float | None) -> Row:
    return {
        "config": config,
        "scene": scene,
        "style": "any",
        **figures,
        "strict": {"acc": 0.5},
        "floors": {"true": floors},
    }


def test_means_are_over_homes_and_the_spread_of_accuracy_with_them() -> None:
    rows = mean_rows(
        [
            row("KGSW", "a", 1, HydP=0.9, acc=0.6, open_area=None),
            row("auto-K", "a", 1, HydP=0.5, acc=0.2, open_area=0.3),
            row("KGSW", "b", 2, HydP=0.7, acc=0.8, open_area=0.4),
        ]
    )
    assert [each["config"] for each in rows] == ["KGSW", "auto-K"]
    ours, clusters = rows
    assert ours["HydP"] == pytest.approx(0.8)
    assert ours["acc_std"] == pytest.approx(0.1)
    assert ours["open_area"] == 0.4
    assert (ours["HydP_one_floor"], ours["HydP_more_floors"]) == (0.9, 0.7)
    assert clusters["HydP_more_floors"] is None
    assert ours["strict"] == {"acc": 0.5}
    assert "scene" not in ours


def test_a_data_set_without_true_rooms_is_refused() -> None:
    with pytest.raises(InvalidInput, match="true rooms"):
        place_specs(Options(dataset="replica"))
    with pytest.raises(InvalidInput, match="small_house"):
        place_specs(Options(dataset="small_house"))


def test_simulated_homes_are_one_a_seed() -> None:
    assert [spec.seed for spec in place_specs(Options(homes=3, seed=7))] == [7, 8, 9]


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
    cuts = {name: method(house, surveyed) for name, method in METHODS.items()}
    rows = {name: score_regions(ground, cut, cuts["SysNav"]) for name, cut in cuts.items()}
    assert rows["HOV-SG"]["regions"] <= 2
    assert rows["SysNav"]["regions"] <= 2
    for ours in ("KGSW", "KGSW oracle functions"):
        assert rows[ours]["acc"] > max(rows["HOV-SG"]["acc"], rows["SysNav"]["acc"])
        assert rows[ours]["HydP"] > max(rows["HOV-SG"]["HydP"], rows["SysNav"]["HydP"])
        assert rows[ours]["area"] < 0.5 * rows["SysNav"]["area"]
        assert rows[ours]["containment"] > 0.7
