"""The `ovip` command: puts the subcommands together and turns known errors into one line and a status."""

from __future__ import annotations

import sys

import typer
from pydantic import ValidationError

from ovip.config import explain
from ovip.errors import OvipError
from ovip_cli import (
    bench,
    editing,
    evaluating,
    export,
    find,
    inspect,
    models,
    record,
    regions,
    replay,
    scenes,
    up,
)

app = typer.Typer(
    name="ovip",
    help="A memory of places for robot fleets: map recordings and live streams, ask where things are.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command("up")(up.up)
app.command("inspect")(inspect.inspect)
app.command("replay")(replay.replay)
app.command("record")(record.record)
app.command("find")(find.find)
app.command("regions")(regions.regions)
app.command("export")(export.export)
app.command("bench")(bench.bench)
app.command("eval")(evaluating.evaluate)
app.add_typer(scenes.app, name="scenes")
app.add_typer(editing.app, name="edit")
app.add_typer(models.app, name="models")


def main() -> None:
    """Exit status 0: done; 1: could not be done, one line says why; 2: wrong words; 130: interrupted."""
    try:
        app()
    except ValidationError as error:
        print(f"ovip: {explain(error)}", file=sys.stderr)
        raise SystemExit(1) from error
    except OvipError as error:
        print(f"ovip: {error}", file=sys.stderr)
        raise SystemExit(1) from error
    except KeyboardInterrupt:
        raise SystemExit(130) from None


if __name__ == "__main__":
    main()
