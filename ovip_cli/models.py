"""`ovip models`: the weight files of the embedded models."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from ovip_cli.stacks import Json, print_json
from services.perception.adapters import model_cache
from services.perception.config import Settings

app = typer.Typer(help="The models that perception runs.", no_args_is_help=True)


class ModelSet(StrEnum):
    EMBEDDED = "embedded"


@app.command("pull")
def pull(
    name: Annotated[ModelSet, typer.Argument(help="which set")] = ModelSet.EMBEDDED, json: Json = False
) -> None:
    """Bring the weight files of a set into the model cache, by hash."""
    folder = Settings().models_dir
    brought = model_cache.pull(folder)
    if json:
        print_json({"set": name.value, "folder": str(folder), "brought": brought})
    else:
        print(f"{folder}: {', '.join(brought) if brought else 'complete already'}")


@app.command("list")
def list_models(json: Json = False) -> None:
    """Show the files of the embedded set, their licences, and whether they are here."""
    folder = Settings().models_dir
    absent = {file.name for file in model_cache.missing(folder)}
    rows = [
        {"file": file.name, "from": file.wheel, "licence": file.licence, "here": file.name not in absent}
        for file in model_cache.EMBEDDED
    ]
    if json:
        print_json({"folder": str(folder), "files": rows})
        return
    for row in rows:
        print(f"{'here   ' if row['here'] else 'missing'} {row['file']:28} {row['from']:32} {row['licence']}")
