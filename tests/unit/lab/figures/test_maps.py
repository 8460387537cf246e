from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.figures.curves import draw_curves
from lab.figures.maps import MapLayer, draw_map, instance_colors
from tests.builders import block

pytest.importorskip("matplotlib", reason="pictures are drawn with matplotlib")


def test_the_plan_shows_what_lies_on_top_in_its_own_colour(tmp_path: Path) -> None:
    table, cloth = block((0, 0, 0.7), (2, 2, 0.72), 0.02), block((0, 0, 0.74), (2, 2, 0.76), 0.02)
    shown = _colours(tmp_path / "a.png", [table, cloth])
    below, above = (tuple(color.tolist()) for color in instance_colors(2))
    assert above in shown
    assert shown[above] > 20 * shown.get(below, 0)


def test_a_storey_without_objects_and_a_map_of_two_storeys_are_drawn(tmp_path: Path) -> None:
    square = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]])
    layers = [
        MapLayer("floor 0", [], [], [("hall", square)]),
        MapLayer("floor 1", [block((0, 0, 3), (1, 1, 3.5))], ["box"], [("attic", square)]),
    ]
    one, two = draw_map(tmp_path / "one.png", layers[:1]), draw_map(tmp_path / "two.png", layers, "two")
    assert cv2.imread(str(two)).shape[0] > 1.5 * cv2.imread(str(one)).shape[0]


def test_neighbours_in_the_list_have_different_colours() -> None:
    colors = instance_colors(40).astype(int)
    assert np.abs(np.diff(colors, axis=0)).sum(axis=1).min() > 60


def test_curves_are_drawn_the_same_each_time(tmp_path: Path) -> None:
    curves = {"PQ": [0.2, 0.4, 0.3], "SQ": [0.7, 0.8, 0.75]}
    first, second = (
        draw_curves(tmp_path / name / "tau.png", [0.8, 1.0, 1.2], curves, "tau", "share", mark=1.0)
        for name in ("a", "b")
    )
    assert first.read_bytes() == second.read_bytes()


def _colours(path: Path, clouds: list[np.ndarray]) -> dict[tuple[int, ...], int]:  # type: ignore[type-arg]
    """How many pixels of the picture have each colour, R G B."""
    image = cv2.imread(str(draw_map(path, [MapLayer("room", clouds, [""] * len(clouds))])))
    colors, counts = np.unique(image.reshape(-1, 3)[:, ::-1], axis=0, return_counts=True)
    return {tuple(color.tolist()): int(count) for color, count in zip(colors, counts, strict=True)}
