"""What `ovip bench` prints."""

from __future__ import annotations

import json

import pytest
import typer
from typer.testing import CliRunner

from lab.bench.rows import Row
from ovip_cli import bench


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> typer.Typer:
    """The command, with a start that takes no time."""
    monkeypatch.setitem(bench.MEASURES, bench.Bench.START, lambda _: [{"data": "new", "ready_s": 1.5}])
    app = typer.Typer()
    app.command()(bench.bench)
    return app


def test_json_holds_rows_with_the_name_of_their_bench_and_nothing_else(command: typer.Typer) -> None:
    printed = json.loads(CliRunner().invoke(command, ["start", "--json"]).stdout)
    assert printed["rows"] == [{"bench": "start", "data": "new", "ready_s": 1.5}]
    assert printed["seconds"] >= 0


def test_without_json_a_table_lines_up_names_and_values(command: typer.Typer) -> None:
    lines = CliRunner().invoke(command, ["start"]).stdout.splitlines()
    assert lines[1:] == ["start", "data  ready_s", " new      1.5"]


def test_a_row_of_very_many_columns_is_printed_as_a_column_of_its_own(
    command: typer.Typer, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows: list[Row] = [{f"c{k}": k * m2 for k in range(40)} for m2 in (1, 20)]
    monkeypatch.setitem(bench.MEASURES, bench.Bench.REGIONS, lambda _: rows)
    lines = CliRunner().invoke(command, ["regions"]).stdout.splitlines()
    assert len(lines) == 2 + 40
    assert [line.split() for line in (lines[2], lines[-1])] == [["c0", "0", "0"], ["c39", "39", "780"]]
    assert len({len(line) for line in lines[2:]}) == 1


def test_an_unknown_bench_is_refused_with_those_that_there_are(command: typer.Typer) -> None:
    result = CliRunner().invoke(command, ["sleep"])
    assert result.exit_code == 2
    assert "tier1" in result.output


def test_sizes_are_given_as_numbers_with_commas(
    command: typer.Typer, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[bench.Options] = []

    def measure(options: bench.Options) -> list[Row]:
        given.append(options)
        return [{"objects": 1}]

    monkeypatch.setitem(bench.MEASURES, bench.Bench.MAPPER, measure)
    words = ["mapper", "--objects", "100,1000", "--dim", "512", "--frames", "7"]
    assert CliRunner().invoke(command, words).exit_code == 0
    assert (given[0].objects, given[0].dim, given[0].detections, given[0].frames) == (
        [100, 1000],
        [512],
        None,
        7,
    )


def test_floors_are_given_in_square_metres(command: typer.Typer, monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[bench.Options] = []

    def measure(options: bench.Options) -> list[Row]:
        given.append(options)
        return [{"m2": 200}]

    monkeypatch.setitem(bench.MEASURES, bench.Bench.REGIONS, measure)
    assert CliRunner().invoke(command, ["regions", "--areas", "200,10000"]).exit_code == 0
    assert given[0].areas == [200, 10_000]


@pytest.mark.parametrize("words", ["", "a", "100,", "0", "-5", "1.5", "²"])
def test_what_is_no_list_of_sizes_is_refused_with_what_was_expected(command: typer.Typer, words: str) -> None:
    result = CliRunner().invoke(command, ["mapper", "--objects", words])
    assert result.exit_code == 2
    assert "expected whole numbers above 0" in result.output
