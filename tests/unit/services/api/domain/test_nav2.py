"""Maps for nav2, read back as its map server reads them."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace

import numpy as np
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.types import I32
from services.api.domain.nav2 import Nav2Map, nav2_map, nav2_zip
from tests.unit.services.api.flat import attic_grid, grid

MEANING = {UNKNOWN: -1, FREE: 0, OCCUPIED: 100}


def occupancy_of(floor: Nav2Map) -> tuple[I32, dict[str, object]]:
    """A map message's data `(height, width)`, row 0 with the smallest y, and its YAML, as nav2 does in mode trinary."""
    described = yaml.safe_load(floor.yaml)
    assert described["image"] == floor.pgm_name
    assert described["mode"] == "trinary"
    kind, size, most, body = floor.pgm.split(b"\n", 3)
    width, height = map(int, size.split())
    assert (kind, most, len(body)) == (b"P5", b"255", width * height)
    shade = np.frombuffer(body, np.uint8).reshape(height, width).astype(np.float64) / 255
    occupied = shade if described["negate"] else 1.0 - shade
    cells = np.full(shade.shape, -1, np.int32)
    cells[occupied < described["free_thresh"]] = 0
    cells[described["occupied_thresh"] < occupied] = 100
    return cells[::-1], described


@given(st.lists(st.lists(st.sampled_from(sorted(MEANING)), min_size=3, max_size=3), min_size=1, max_size=6))
@settings(deadline=None)
def test_every_cell_is_read_as_what_it_is(rows: list[list[int]]) -> None:
    occupancy = np.array(rows, np.uint8)
    cells = FloorGrid(2, (-1.25, 0.4), 0.05, occupancy, np.zeros(occupancy.shape, np.uint16))

    read, described = occupancy_of(nav2_map(cells))

    assert read.tolist() == [[MEANING[value] for value in row] for row in rows]
    assert described["resolution"] == 0.05
    assert described["origin"] == [-1.25, 0.4, 0.0]


def test_a_place_of_the_world_is_found_at_its_cell() -> None:
    read, described = occupancy_of(nav2_map(grid()))
    origin, resolution = described["origin"], described["resolution"]
    assert isinstance(origin, list) and isinstance(resolution, float)

    def value_at(x: float, y: float) -> int:
        return int(read[int((y - origin[1]) / resolution), int((x - origin[0]) / resolution)])

    assert value_at(4.95, 1.6) == 0
    assert value_at(4.95, 3.0) == 100
    assert value_at(-0.4, 6.4) == -1


def test_an_archive_holds_both_files_of_every_floor_and_is_always_the_same_bytes() -> None:
    floors = [grid(), attic_grid()]
    archive = nav2_zip(floors)

    with zipfile.ZipFile(io.BytesIO(archive)) as files:
        assert files.namelist() == ["floor-0.pgm", "floor-0.yaml", "floor-1.pgm", "floor-1.yaml"]
        assert files.read("floor-1.pgm") == nav2_map(floors[1]).pgm
    assert nav2_zip(floors) == archive


def test_numbers_are_written_so_that_yaml_reads_them_as_numbers() -> None:
    _, described = occupancy_of(nav2_map(replace(grid(), origin=(1e-7, -20.0), resolution=0.1)))
    assert described["origin"] == [1e-7, -20.0, 0.0]
