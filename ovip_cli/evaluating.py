"""`ovip eval`: runs one of the paper's protocols and prints its table."""

from __future__ import annotations

import importlib
import time
from dataclasses import fields
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from lab.evaluation.experiment import TEST_SEED, Experiment, Options, Result, Row
from ovip.errors import InvalidInput
from ovip.telemetry import configure_logging
from ovip_cli.stacks import Json, print_json


class Protocol(StrEnum):
    """Each is `lab/evaluation/experiments/NAME.py: run`."""

    SEMANTIC = "semantic"
    INSTANCE = "instance"
    ABLATION = "ablation"
    REGIONS = "regions"
    RETRIEVAL = "retrieval"
    NAVIGATION = "navigation"
    ABSENCE = "absence"
    VOCABULARY = "vocabulary"
    RELATIONS = "relations"
    CHANGE = "change"
    FLEET = "fleet"
    SCALING = "scaling"
    CALIBRATE = "calibrate"


class Dataset(StrEnum):
    REPLICA = "replica"
    SMALL_HOUSE = "small_house"
    EXAMPLES = "examples"


def evaluate(
    name: Annotated[Protocol, typer.Argument(help="which protocol")],
    homes: Annotated[int, typer.Option(min=1, help="simulated homes to run on")] = 3,
    seed: Annotated[
        int, typer.Option(min=0, help="seed of the first home; the next ones count up")
    ] = TEST_SEED,
    dataset: Annotated[
        Dataset | None, typer.Option(help="a data set instead of simulated homes, in folder --root")
    ] = None,
    root: Annotated[Path | None, typer.Option(help="folder of the data set", file_okay=False)] = None,
    figures: Annotated[
        Path | None, typer.Option(help="folder to draw pictures into", file_okay=False)
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="processes to use")] = 2,
    queries: Annotated[int, typer.Option(min=0, help="most questions a scene; 0: the protocol's own")] = 0,
    json: Json = False,
) -> None:
    """Run a protocol on simulated homes with exact truth, or on a data set, and score it."""
    configure_logging("warning", as_json=False)
    if root is not None and dataset is None:
        raise InvalidInput("--root: expected --dataset as well, to say what lies there")
    options = Options(homes, seed, dataset.value if dataset else None, root, figures, workers, queries)
    began = time.perf_counter()
    result = _experiment(name)(options)
    seconds = round(time.perf_counter() - began, 1)
    if json:
        print_json(_plain(result, seconds))
    else:
        _say(name.value, result, seconds)


def _experiment(name: Protocol) -> Experiment:
    """Brought when it is run: an experiment needs the services, and some of them the lab's packages."""
    module = importlib.import_module(f"lab.evaluation.experiments.{name.value}")
    run: Experiment = module.run
    return run


def _plain(result: Result, seconds: float) -> dict[str, Any]:
    """Every field of the result, those that only its protocol gives among them."""
    told = {field.name: getattr(result, field.name) for field in fields(result)}
    return {**told, "figures": [str(path) for path in result.figures], "seconds": seconds}


def _say(name: str, result: Result, seconds: float) -> None:
    _print_table(f"{name}, compat", [_flat(row) for row in result.rows])
    strict = [{"config": row["config"], **row["strict"]} for row in result.rows if "strict" in row]
    if strict:
        _print_table(f"{name}, strict", strict)
    for table, rows in _own_tables(result):
        _print_table(f"{name}, {table}", [_flat(row) for row in rows])
    for note in result.notes:
        print(f"note: {note}")
    for path in result.figures:
        print(f"figure: {path}")
    print(f"{seconds:.1f} s")


def _own_tables(result: Result) -> list[tuple[str, list[Row]]]:
    """The tables that only the result's protocol gives, by name."""
    shared = {field.name for field in fields(Result)}
    own = [(field.name, getattr(result, field.name)) for field in fields(result) if field.name not in shared]
    return [(name, rows) for name, rows in own if rows]


def _flat(row: Row) -> Row:
    """The columns that a table can show."""
    return {column: value for column, value in row.items() if not isinstance(value, (dict, list))}


def _print_table(title: str, rows: list[Row]) -> None:
    columns = list(dict.fromkeys(column for row in rows for column in row))
    cells = [[_shown(row.get(column)) for column in columns] for row in rows]
    widths = [max(len(column), *(len(line[i]) for line in cells)) for i, column in enumerate(columns)]
    print(f"\n{title}")
    for line in [columns, *cells]:
        first, rest = line[0].ljust(widths[0]), zip(line[1:], widths[1:], strict=True)
        print("  ".join([first, *(cell.rjust(width) for cell, width in rest)]))


def _shown(value: object) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if isinstance(value, float) else str(value)
