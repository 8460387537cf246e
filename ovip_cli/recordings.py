"""The options by which a command names a recording on disk."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ovip.recordings import LAYOUTS

Place = Annotated[Path, typer.Argument(help="the recording: a folder, or a bag file")]
AnyLayout = Annotated[
    str | None,
    typer.Option("--layout", help=f"how it is laid out (found by its files): {', '.join(LAYOUTS)}"),
]
UpWord = Annotated[str | None, typer.Option("--up", help="up in the recording's own frame: x,y,z or auto")]
OptionWords = Annotated[
    list[str] | None, typer.Option("--option", help="key=value for the layout, as often as needed")
]
Stride = Annotated[int, typer.Option(help="take every n-th frame")]
