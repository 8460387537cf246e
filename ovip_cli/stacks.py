"""Which stack a command speaks to: a running one, or one started for this command alone."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from ovip.client import Addresses
from ovip.config import KernelSettings
from ovip.errors import InvalidInput
from services.standalone.process import read_ready, start_stack, stop_stack

Json = Annotated[bool, typer.Option("--json", help="print JSON and nothing else")]
Standalone = Annotated[
    bool,
    typer.Option("--standalone", help="start a stack for this command alone; its state stays in --data-dir"),
]
DataDir = Annotated[
    Path | None,
    typer.Option("--data-dir", help="where the stack keeps its state (else OVIP_DATA_DIR)", file_okay=False),
]
Scene = Annotated[str, typer.Option("--scene", help="name of the scene")]
SceneName = Annotated[str, typer.Argument(help="name of the scene")]


@contextlib.contextmanager
def stack_for(standalone: bool, data_dir: Path | None) -> Iterator[Addresses]:
    """Addresses of the stack to use; a standalone one is stopped gently at the end."""
    if not standalone:
        settings = KernelSettings() if data_dir is None else KernelSettings(data_dir=data_dir)
        yield Addresses.discover(settings)
        return
    if data_dir is None:
        raise InvalidInput("--standalone: expected --data-dir DIR as well, where its state stays")
    process = start_stack(data_dir, free_ports=True)
    try:
        yield Addresses.of_stack(read_ready(process))
    finally:
        stop_stack(process)


def print_json(value: Any) -> None:
    """One JSON value on standard output."""
    print(json.dumps(value))
