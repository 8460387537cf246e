"""Floors drawn as a PNG: regions in their functions' colours with names and areas, walls, doorways, stairs, frontiers,
objects, and a scale."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from ovip.errors import InvalidInput
from ovip.scene.types import EdgeKind
from services.api.domain.labels import Label
from services.api.domain.lettering import Line, measure, write, write_from
from services.api.domain.palette import DOOR, FLOOR, FRONTIER, HAZE, INK, PAPER, SOFT, STAIRS, mixed
from services.api.domain.plan_drawing import draw_floor, enclosed_unknown
from services.api.domain.plan_sheet import PlanFrame, PlanSheet
from services.api.domain.plan_words import area_words, words_of

MAX_SIDE = 6000
"""Pixels: a larger picture is refused."""
_COMFORTABLE = 2800
"""Pixels: without a scale given, no side of a floor is larger."""
_DRAWN_FINER = ((3_000_000, 3), (8_000_000, 2))
"""Pictures of up to so many pixels are drawn so many times larger, then shrunk."""
_EDGE, _HEAD, _FOOT = 28, 20, 15
_BAR = (80.0, 170.0)
_LEAST_UNSEEN = 0.25
"""Square metres of hatching that the signs explain."""
_NICE = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)


@dataclass(frozen=True, slots=True)
class PlanParams:
    """Pixels a metre; None: 80, or fewer where a floor would be larger than 2800 pixels on a side."""

    pixels_per_metre: float | None = None
    most_pixels_per_metre: float = 80.0


def draw_floorplans(sheets: Sequence[PlanSheet], params: PlanParams | None = None) -> bytes:
    """One picture a floor, larger y up, side by side in one PNG, all to one scale.

    InvalidInput where a side would be larger than 6000 pixels.
    """
    scale = _scale(sheets, params or PlanParams())
    frames = [PlanFrame.around(sheet.grid, scale) for sheet in sheets]
    _check(frames)
    pages = [_page(sheet, frame) for sheet, frame in zip(sheets, frames, strict=True)]
    stream = io.BytesIO()
    _side_by_side(pages).save(stream, format="PNG", compress_level=4)
    return stream.getvalue()


def _scale(sheets: Sequence[PlanSheet], params: PlanParams) -> float:
    if params.pixels_per_metre is not None:
        return params.pixels_per_metre
    extents = [_metres(sheet) for sheet in sheets]
    limits = (
        _COMFORTABLE / max(max(extent) for extent in extents),
        0.9 * MAX_SIDE / sum(width for width, _ in extents),
    )
    return min(params.most_pixels_per_metre, *limits)


def _metres(sheet: PlanSheet) -> tuple[float, float]:
    """Width and height of what a plan shows."""
    frame = PlanFrame.around(sheet.grid, 1.0)
    cells = frame.columns.stop - frame.columns.start, frame.rows.stop - frame.rows.start
    return cells[0] * sheet.grid.resolution, cells[1] * sheet.grid.resolution


def _check(frames: Sequence[PlanFrame]) -> None:
    width, height = sum(frame.size[0] for frame in frames), max(frame.size[1] for frame in frames)
    if max(width, height) > MAX_SIDE:
        raise InvalidInput(
            f"scale: the plan would be {width} x {height} pixels, expected at most {MAX_SIDE} on a side"
        )


def _side_by_side(pages: Sequence[Image.Image]) -> Image.Image:
    size = (sum(page.width for page in pages), max(page.height for page in pages))
    whole = Image.new("RGB", size, PAPER)
    x = 0
    for page in pages:
        whole.paste(page, (x, 0))
        x += page.width
    return whole


def _page(sheet: PlanSheet, frame: PlanFrame) -> Image.Image:
    """The plan with a heading above and the scale and signs below."""
    pixels = frame.size[0] * frame.size[1]
    plan = draw_floor(sheet, frame, next((finer for most, finer in _DRAWN_FINER if pixels <= most), 1))
    _write_words(plan, sheet, frame)
    width = max(plan.width, 260 + 2 * _EDGE)
    head = _heading(sheet, width - 2 * _EDGE)
    foot = _signs(sheet, frame, width - 2 * _EDGE)
    top = _EDGE + round(measure(head)[1])
    page = Image.new("RGB", (width, top + plan.height + foot.height + _EDGE // 2), PAPER)
    page.paste(plan, ((width - plan.width) // 2, top))
    page.paste(foot, (_EDGE, top + plan.height))
    draw = ImageDraw.Draw(page)
    y = float(_EDGE) * 0.7
    for number, line in enumerate(head):
        height = measure((line,))[1]
        write_from(draw, line, (_EDGE, y + height / 2), SOFT if number else INK)
        y += height
    return page


def _write_words(plan: Image.Image, sheet: PlanSheet, frame: PlanFrame) -> None:
    words = words_of(sheet, frame)
    draw = ImageDraw.Draw(plan)
    for label in words.regions:
        if label.leader is not None:
            _leader(draw, label)
    for label in words.objects:
        write(draw, label.lines, label.box, (mixed(INK, FLOOR, 0.15),), FLOOR)
    for label in words.marks:
        ink = FRONTIER if label.lines[0].text == "unexplored" else SOFT
        write(draw, label.lines, label.box, (ink,), FLOOR)
    for label in words.regions:
        names = len(label.lines) - (len(label.lines) > 1)
        write(draw, label.lines, label.box, (*(INK,) * names, SOFT), FLOOR)


def _leader(draw: ImageDraw.ImageDraw, label: Label) -> None:
    """A thin line from the words to the place they speak of, with a dot there."""
    assert label.leader is not None
    x0, y0, x1, y1 = label.box
    x, y = label.leader
    start = (min(max(x, x0), x1), min(max(y, y0), y1))
    draw.line([start, (x, y)], fill=SOFT, width=1)
    draw.ellipse((x - 2.5, y - 2.5, x + 2.5, y + 2.5), fill=SOFT)


def _heading(sheet: PlanSheet, width: int) -> tuple[Line, ...]:
    floor, partition = sheet.floor, sheet.partition
    ceiling = "no ceiling seen" if floor.ceiling_z is None else f"ceiling at {floor.ceiling_z:.2f} m"
    count = len(sheet.regions)
    facts = [
        f"{area_words(floor.area)} in {count} region{'' if count == 1 else 's'}",
        f"floor at {floor.z + 0.0:.2f} m, {ceiling}",
        f"map version {partition.map_version}, regions revision {partition.revision}",
    ]
    lines = [Line(f"{sheet.scene}, floor {floor.floor}", _HEAD)]
    for fact in facts:
        joined = Line(f"{lines[-1].text}  |  {fact}", _FOOT)
        if len(lines) > 1 and measure((joined,))[0] <= width:
            lines[-1] = joined
        else:
            lines.append(Line(fact, _FOOT))
    return tuple(lines)


def _signs(sheet: PlanSheet, frame: PlanFrame, width: int) -> Image.Image:
    """The scale bar, then what the marks on this floor mean, in as many rows as that takes."""
    signs = [
        (kind, word)
        for kind, word, there in (
            ("doorway", "doorway", sheet.passages(EdgeKind.DOORWAY)),
            ("stairs", "stairs", sheet.passages(EdgeKind.STAIRS)),
            ("frontier", "unexplored beyond", sheet.frontiers),
            ("unseen", "never seen", _worth_a_sign(sheet)),
        )
        if there
    ]
    metres = _bar_metres(frame.scale)
    places: list[tuple[int, int]] = []
    x, row = round(metres * frame.scale) + 84, 0
    for _, word in signs:
        need = 34 + round(measure((Line(word, _FOOT - 2),))[0])
        if x + need > width and x > 0:
            x, row = 0, row + 1
        places.append((x, row))
        x += need + 22
    foot = Image.new("RGB", (width, 30 * (row + 1)), PAPER)
    draw = ImageDraw.Draw(foot)
    _bar(draw, metres, frame.scale)
    for (kind, word), (at, line) in zip(signs, places, strict=True):
        y = 15 + 30 * line
        _sign(draw, kind, at, y)
        write_from(draw, Line(word, _FOOT - 2), (at + 34, y), SOFT)
    return foot


def _worth_a_sign(sheet: PlanSheet) -> bool:
    return bool(enclosed_unknown(sheet).sum() * sheet.grid.resolution**2 >= _LEAST_UNSEEN)


def _bar_metres(scale: float) -> float:
    fitting = [metres for metres in _NICE if _BAR[0] <= metres * scale <= _BAR[1]]
    return fitting[-1] if fitting else min(_NICE, key=lambda metres: abs(metres * scale - _BAR[0]))


def _bar(draw: ImageDraw.ImageDraw, metres: float, scale: float) -> None:
    length = metres * scale
    draw.line([(0, 15), (length, 15)], fill=INK, width=2)
    for x in (0.0, length):
        draw.line([(x, 10), (x, 20)], fill=INK, width=2)
    write_from(draw, Line(f"{metres:g} m", _FOOT - 1), (length + 9, 15), INK)


def _sign(draw: ImageDraw.ImageDraw, kind: str, x: int, y: int) -> None:
    if kind == "doorway":
        draw.line([(x, y), (x + 26, y)], fill=DOOR, width=2)
        for end in (x, x + 26):
            draw.line([(end, y - 6), (end, y + 6)], fill=DOOR, width=2)
    elif kind == "stairs":
        for at in np.arange(x, x + 27, 6).tolist():
            draw.line([(at, y - 6), (at, y + 6)], fill=STAIRS, width=2)
    elif kind == "frontier":
        for at in range(x, x + 26, 10):
            draw.line([(at, y), (at + 6, y)], fill=FRONTIER, width=3)
    else:
        draw.rectangle((x, y - 8, x + 26, y + 8), fill=FLOOR, outline=HAZE)
        for at in range(x + 2, x + 26, 6):
            draw.line(
                [(at, y + 7), (min(at + 14, x + 25), max(y + 7 - 14, y + 7 + at - x - 25))],
                fill=HAZE,
                width=1,
            )
