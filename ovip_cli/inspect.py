"""`ovip inspect`: whether a recording is what it says it is, before anything is mapped."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import cv2
import typer

from ovip.errors import InvalidInput
from ovip.jsonable import to_json
from ovip.recordings import Recording, find_layout, open_recording, parse_options, parse_up
from ovip.recordings.inspection import Finding, draw_sheet, inspect_recording, worst
from ovip_cli.recordings import AnyLayout, OptionWords, Place, Stride, UpWord
from ovip_cli.stacks import Json, print_json

_AS_IT_IS = (0.0, 0.0, 1.0)


def inspect(
    path: Place,
    layout: AnyLayout = None,
    up: UpWord = None,
    option: OptionWords = None,
    stride: Stride = 1,
    sheet: Annotated[
        Path | None, typer.Option(help="draw a contact sheet into this file (.png or .jpg)", dir_okay=False)
    ] = None,
    json: Json = False,
) -> None:
    """Check a recording: depth, poses, camera, up, colour and depth in step. Exit status 1: something is wrong."""
    found = layout or find_layout(path)
    recording, trouble = _opened(path, found, up, option or [], stride)
    findings = (*inspect_recording(recording), *trouble)
    if sheet is not None:
        _draw(recording, sheet)
    if json:
        print_json(_plain(recording, findings))
    else:
        _say(recording, findings)
    if worst(findings) == "wrong":
        raise typer.Exit(1)


def _opened(
    path: Path, layout: str, up: str | None, options: list[str], stride: int
) -> tuple[Recording, tuple[Finding, ...]]:
    """The recording; where its up cannot be told, as it is, with a finding that says so."""
    parsed, given = parse_options(options), parse_up(up) if up else None
    try:
        return open_recording(path, layout, given, stride, parsed), ()
    except InvalidInput as error:
        if not str(error).startswith("up: "):
            raise
        told = Finding("up", "wrong", str(error).removeprefix("up: "))
        return open_recording(path, layout, _AS_IT_IS, stride, parsed), (told,)


def _draw(recording: Recording, file: Path) -> None:
    try:
        written = cv2.imwrite(str(file), draw_sheet(recording))
    except cv2.error:
        written = False
    if not written:
        raise InvalidInput(
            f"--sheet: {file} cannot be written: expected a .png or .jpg in a folder that is there"
        )


def _plain(recording: Recording, findings: tuple[Finding, ...]) -> dict[str, object]:
    return {
        "name": recording.name,
        "layout": recording.layout,
        "level": worst(findings),
        "notes": list(recording.notes),
        "findings": to_json(list(findings)),
    }


def _say(recording: Recording, findings: tuple[Finding, ...]) -> None:
    print(f"{recording.name} ({recording.layout})")
    for note in recording.notes:
        print(f"note     {note}")
    for finding in findings:
        print(f"{finding.level:8} {finding.check:13} {finding.says}")
