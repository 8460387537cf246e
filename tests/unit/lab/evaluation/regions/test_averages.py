"""Means over homes, and over the homes of each kind."""

from __future__ import annotations

import pytest

from lab.evaluation.experiment import Row
from lab.evaluation.regions.averages import kinds_of, mean_rows, style_rows


def row(config: str, scene: str, floors: int, style: str = "any", **figures: float | None) -> Row:
    return {
        "config": config,
        "scene": scene,
        "style": style,
        **figures,
        "strict": {"HydP": 0.5, "acc": 0.5},
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
    assert "scene" not in ours


def test_one_home_has_no_spread() -> None:
    (ours,) = mean_rows([row("KGSW", "a", 1, HydP=0.9, acc=0.6)])
    assert (ours["acc_std"], ours["strict"]["acc_std"]) == (None, None)


def test_the_strict_figures_have_their_own_spread() -> None:
    rows = [row("KGSW", "a", 1, HydP=0.9, acc=0.6), row("KGSW", "b", 1, HydP=0.9, acc=0.6)]
    rows[0]["strict"] = {"HydP": 0.8, "acc": 0.1}
    (ours,) = mean_rows(rows)
    assert ours["acc_std"] == 0.0
    assert ours["strict"] == {
        "HydP": pytest.approx(0.65),
        "acc": pytest.approx(0.3),
        "acc_std": pytest.approx(0.2),
        "HydP_one_floor": pytest.approx(0.65),
        "HydP_more_floors": None,
    }


@pytest.mark.parametrize(
    ("style", "floors", "kinds"),
    [
        ("walled-compact", 1, ("walled", "compact", "one floor")),
        ("open-elongated", 1, ("open", "elongated", "one floor")),
        ("two-floors-walled", 2, ("walled", "more floors")),
        ("", 3, ("more floors",)),
    ],
)
def test_a_homes_kinds_are_in_its_style_and_its_floors(
    style: str, floors: int, kinds: tuple[str, ...]
) -> None:
    assert kinds_of(row("KGSW", "a", floors, style)) == kinds


def test_each_kind_has_the_means_of_its_homes() -> None:
    rows = style_rows(
        [
            row("KGSW", "a", 1, "walled-compact", acc=1.0, HydP=1.0),
            row("KGSW", "b", 1, "open-compact", acc=0.5, HydP=0.8),
            row("KGSW", "c", 2, "two-floors-open", acc=0.0, HydP=0.6),
        ]
    )
    by_kind = {each["kind"]: each for each in rows}
    assert {kind: each["homes"] for kind, each in by_kind.items()} == {
        "walled": 1,
        "compact": 2,
        "one floor": 2,
        "open": 2,
        "more floors": 1,
    }
    assert by_kind["compact"]["acc"] == pytest.approx(0.75)
    assert by_kind["open"]["HydP"] == pytest.approx(0.7)
    assert by_kind["open"]["strict_acc"] == 0.5
    assert by_kind["open"]["containment"] is None
