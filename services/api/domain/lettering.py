"""Words in pictures: how large they are, and writing them with a halo."""

from __future__ import annotations

import functools
import unicodedata
from dataclasses import dataclass

from PIL import ImageDraw, ImageFont

Rect = tuple[float, float, float, float]
Ink = tuple[int, int, int]
_RAISED = 0.62
_LEADING = 1.22


@dataclass(frozen=True, slots=True)
class Line:
    """One line of words. size: of its letters, pixels."""

    text: str
    size: int


def plain(text: str) -> str:
    """`text` in the letters that the built-in font has: accents fall off, what is left over becomes "?"."""
    apart = unicodedata.normalize("NFKD", text.replace("²", "\0"))
    bare = "".join(letter for letter in apart if not unicodedata.combining(letter))
    return "".join("²" if c == "\0" else c if " " <= c <= "~" else "?" for c in bare)


def measure(lines: tuple[Line, ...]) -> tuple[float, float]:
    """Width and height in pixels of lines under one another."""
    return max(_width(line) for line in lines), sum(_LEADING * line.size for line in lines)


def write(
    draw: ImageDraw.ImageDraw, lines: tuple[Line, ...], box: Rect, inks: tuple[Ink, ...], halo: Ink | None
) -> None:
    """Lines centred in `box` (x0, y0, x1, y1), each in its ink (the last one's for those after)."""
    middle = (box[0] + box[2]) / 2
    y = (box[1] + box[3]) / 2 - measure(lines)[1] / 2
    for number, line in enumerate(lines):
        ink = inks[min(number, len(inks) - 1)]
        _write_line(draw, line, (middle - _width(line) / 2, y + _LEADING * line.size / 2), ink, halo)
        y += _LEADING * line.size


def write_from(draw: ImageDraw.ImageDraw, line: Line, left_middle: tuple[float, float], ink: Ink) -> None:
    """One line that begins at a point."""
    _write_line(draw, line, left_middle, ink, None)


def _write_line(
    draw: ImageDraw.ImageDraw, line: Line, at: tuple[float, float], ink: Ink, halo: Ink | None
) -> None:
    x, y = at
    for part, size, raised in _parts(line):
        options = {"stroke_width": max(1, round(line.size / 9)), "stroke_fill": halo} if halo else {}
        draw.text((x, y - raised), part, font=_font(size), anchor="lm", fill=ink, **options)  # type: ignore[arg-type]
        x += _font(size).getlength(part)


def _parts(line: Line) -> list[tuple[str, int, float]]:
    """Runs of letters with their size and how far they are raised: the font has no small raised 2."""
    runs: list[tuple[str, int, float]] = []
    for number, run in enumerate(plain(line.text).split("²")):
        if number:
            runs.append(("2", max(6, round(_RAISED * line.size)), 0.32 * line.size))
        if run:
            runs.append((run, line.size, 0.0))
    return runs


def _width(line: Line) -> float:
    return sum(float(_font(size).getlength(part)) for part, size, _ in _parts(line))


@functools.cache
def _font(size: int) -> ImageFont.FreeTypeFont:
    font = ImageFont.load_default(size)
    assert isinstance(font, ImageFont.FreeTypeFont)
    return font
