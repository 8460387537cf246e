"""`ovip eval` as a shell: every protocol it lists exists, tables print, wrong words are told so."""

from __future__ import annotations

import json
from dataclasses import dataclass, field

import pytest
from typer.testing import CliRunner

from lab.evaluation.experiment import Options, Result, Row
from ovip.errors import InvalidInput
from ovip_cli import evaluating
from ovip_cli.app import app

RESULT = Result(
    rows=[
        {"config": "overlap", "PQ": 0.25, "strict": {"PQ": 0.125}},
        {"config": "ours", "PQ": 0.5, "objects": 7, "strict": {"PQ": 0.375}},
    ],
    scenes=[{"scene": "home-1000", "config": "ours", "PQ": 0.5}],
    notes=("on one home",),
)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Options]:
    """The options that an experiment was run with; the experiment itself is not what is tested here."""
    seen: list[Options] = []

    def run(options: Options) -> Result:
        seen.append(options)
        return RESULT

    monkeypatch.setattr(evaluating, "_experiment", lambda name: run)
    return seen


@pytest.mark.parametrize("name", evaluating.Protocol)
def test_every_protocol_on_the_list_can_be_run(name: evaluating.Protocol) -> None:
    assert callable(evaluating._experiment(name))


def test_json_is_one_value_with_rows_scenes_and_seconds(asked: list[Options]) -> None:
    done = CliRunner().invoke(app, ["eval", "ablation", "--homes", "6", "--seed", "40", "--json"])

    answer = json.loads(done.stdout)
    assert answer["rows"] == RESULT.rows
    assert answer["scenes"] == RESULT.scenes
    assert answer["seconds"] >= 0
    assert (asked[0].homes, asked[0].seed, asked[0].dataset) == (6, 40, None)


def test_a_person_sees_the_compat_table_and_the_strict_one(asked: list[Options]) -> None:
    printed = CliRunner().invoke(app, ["eval", "instance"]).stdout

    compat, strict = printed.split("instance, strict")
    assert "0.500" in compat and "0.375" not in compat
    assert "0.375" in strict and "note: on one home" in strict
    assert [line.split() for line in compat.splitlines()[2:5]] == [
        ["config", "PQ", "objects"],
        ["overlap", "0.250", "-"],
        ["ours", "0.500", "7"],
    ]


@dataclass(frozen=True, slots=True)
class MoreToSay(Result):
    """What a protocol adds to every result's fields."""

    worst: list[Row] = field(default_factory=list)
    nothing: list[Row] = field(default_factory=list)


def test_what_only_one_protocol_tells_is_in_its_json_and_has_a_table(monkeypatch: pytest.MonkeyPatch) -> None:
    result = MoreToSay(RESULT.rows, RESULT.scenes, worst=[{"scene": "home-1000", "acc": 0.5, "areas": [{}]}])
    monkeypatch.setattr(evaluating, "_experiment", lambda name: lambda options: result)

    answer = json.loads(CliRunner().invoke(app, ["eval", "regions", "--json"]).stdout)
    assert (answer["worst"], answer["nothing"]) == (result.worst, [])
    assert answer["rows"] == RESULT.rows

    printed = CliRunner().invoke(app, ["eval", "regions"]).stdout
    table = printed.split("regions, worst\n")[1].splitlines()
    assert [line.split() for line in table[:2]] == [["scene", "acc"], ["home-1000", "0.500"]]
    assert "nothing" not in printed


def test_a_root_without_a_data_set_is_refused() -> None:
    done = CliRunner().invoke(app, ["eval", "ablation", "--root", "here"])

    assert isinstance(done.exception, InvalidInput)
    assert "--dataset" in str(done.exception)
