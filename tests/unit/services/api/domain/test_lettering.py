"""Words in pictures."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw

from ovip.scene.types import Bools
from services.api.domain.lettering import Line, measure, plain, write


def inked(*lines: Line) -> Bools:
    """Where lines written into the middle of a white picture left ink, `(100, 300)`."""
    picture = Image.new("RGB", (300, 100), (255, 255, 255))
    write(ImageDraw.Draw(picture), lines, (0, 0, 300, 100), ((0, 0, 0),), None)
    ink: Bools = np.asarray(picture)[..., 0] < 128
    return ink


def test_letters_that_the_font_lacks_lose_their_accents_or_become_question_marks() -> None:
    assert plain("Küche 2, 4 m²") == "Kuche 2, 4 m²"
    assert plain("厨房") == "??"


def test_words_lie_within_the_size_they_are_measured_to_have() -> None:
    lines = (Line("living room 2", 17), Line("29 m²", 14))
    width, height = measure(lines)
    rows, columns = np.nonzero(inked(*lines))

    assert 150 - width / 2 - 1 <= columns.min() and columns.max() <= 150 + width / 2 + 1
    assert 50 - height / 2 <= rows.min() and rows.max() <= 50 + height / 2


def test_the_two_of_square_metres_is_small_and_raised() -> None:
    rows, columns = np.nonzero(inked(Line("m²", 40)))
    two = rows[columns > columns.max() - 12]

    assert two.max() < rows.max() - 10
    assert measure((Line("m²", 40),))[0] < measure((Line("m2", 40),))[0]
