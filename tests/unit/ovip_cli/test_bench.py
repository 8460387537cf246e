"""What `ovip bench` prints."""

from __future__ import annotations

import json

import pytest
import typer
from typer.testing import CliRunner

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


def test_an_unknown_bench_is_refused_with_those_that_there_are(command: typer.Typer) -> None:
    result = CliRunner().invoke(command, ["sleep"])
    assert result.exit_code == 2
    assert "tier1" in result.output
