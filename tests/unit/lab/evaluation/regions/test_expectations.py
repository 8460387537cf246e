"""The paper's expectations, on mean rows whose figures are round numbers."""

from __future__ import annotations

from typing import Any

import pytest

from lab.evaluation.experiment import Row
from lab.evaluation.regions.expectations import expectations

NAMES = {
    "containment": "containment, ours less HOV-SG's",
    "area": "area of the unit, HOV-SG's over ours",
    "open_area": "the same in the open, SysNav's over ours",
    "open_area_hovsg": "the same in the open, HOV-SG's over ours",
    "acc": "mean acc, ours less the best baseline's",
    "acc_std": "acc_std, ours less the least baseline's",
    "floors": "HydP, one floor's less that of more",
}


def method(config: str, **figures: Any) -> Row:
    usual: Row = {
        "containment": 0.8,
        "area": 0.2,
        "open_area": 0.25,
        "acc": 0.6,
        "acc_std": 0.1,
        "HydP_one_floor": 0.9,
        "HydP_more_floors": 0.9,
    }
    return {"config": config, **usual, **figures, "strict": {**usual, **figures}}


def judged(*rows: Row) -> dict[str, Row]:
    by_name = {row["expectation"]: row for row in expectations(rows)}
    assert set(by_name) == set(NAMES.values())
    return {short: by_name[name] for short, name in NAMES.items()}


def table(ours: dict[str, Any] | None = None, **hovsg: Any) -> list[Row]:
    others = [method(name, acc=0.5, acc_std=0.2, open_area=0.75) for name in ("SysNav", "auto-K")]
    return [
        method("KGSW", **(ours or {})),
        method("HOV-SG", **{"area": 0.31, "acc": 0.5, "acc_std": 0.2, **hovsg}),
        *others,
    ]


def test_a_table_as_the_papers_meets_all() -> None:
    told = judged(*table())
    assert told["area"]["value"] == pytest.approx(1.55)
    assert told["open_area"]["value"] == pytest.approx(3.0)
    assert told["acc"]["value"] == pytest.approx(0.1)
    assert told["acc_std"]["value"] == pytest.approx(-0.1)
    assert all(row["met"] and row["strict_met"] for name, row in told.items() if name != "open_area_hovsg")


def test_what_is_reported_beside_another_has_no_bound_to_meet() -> None:
    row = judged(*table())["open_area_hovsg"]
    assert (row["bound"], row["met"], row["strict_met"]) == ("", None, None)
    assert row["value"] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("name", "ours"),
    [
        ("containment", {"containment": 0.76}),
        ("area", {"area": 0.22}),
        ("open_area", {"open_area": 0.26}),
        ("acc", {"acc": 0.49}),
        ("acc_std", {"acc_std": 0.21}),
        ("floors", {"HydP_more_floors": 0.86}),
    ],
)
def test_a_miss_is_a_miss_and_only_its_own(name: str, ours: dict[str, float]) -> None:
    told = judged(*table(ours))
    missed = [short for short, row in told.items() if row["met"] is False]
    assert missed == [name]


def test_containment_a_little_below_is_still_within_and_more_is_fine() -> None:
    for held in (0.78, 0.9):
        assert judged(*table({"containment": held}))["containment"]["met"]


def test_the_strict_figures_are_judged_by_themselves() -> None:
    rows = table()
    rows[0]["strict"] = {**rows[0]["strict"], "acc": 0.4}
    told = judged(*rows)["acc"]
    assert (told["met"], told["strict_met"]) == (True, False)


def test_a_figure_that_no_home_gives_is_neither_met_nor_missed() -> None:
    told = judged(*table({"HydP_more_floors": None, "open_area": None}))
    for name in ("floors", "open_area"):
        assert (told[name]["value"], told[name]["met"]) == (None, None)
    without_baselines = judged(method("KGSW"))
    assert {row["met"] for name, row in without_baselines.items() if name != "floors"} == {None}
