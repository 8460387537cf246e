"""Region polygons as GeoJSON."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np

from ovip.scene.types import Floor, Partition, Region
from services.api.domain.region_polygons import regions_geojson
from tests.unit.services.api.flat import flat

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def region(outlines: tuple[np.ndarray, ...], holes: tuple[np.ndarray, ...]) -> Region:
    return Region("r1", 0, "kitchen", "kitchen", 1.0, np.zeros(3), outlines, holes, ("o1",), ())


def polygons(found: Region) -> list[list[list[list[float]]]]:
    body = regions_geojson("x", Partition(3, 2, (Floor(0, 0.1, None, 1.0),), (found,)))
    coordinates: list[list[list[list[float]]]] = body["features"][0]["geometry"]["coordinates"]
    return coordinates


def signed_area(ring: list[list[float]]) -> float:
    points = np.array(ring[:-1])
    following = np.roll(points, -1, axis=0)
    return float((points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0]).sum() / 2)


def test_rings_are_closed_outer_ones_counter_clockwise_and_holes_clockwise() -> None:
    for outline in (4 * SQUARE, 4 * SQUARE[::-1]):
        for hole in (SQUARE + 1, (SQUARE + 1)[::-1]):
            ((outer, inner),) = polygons(region((outline,), (hole,)))
            assert outer[0] == outer[-1] and inner[0] == inner[-1]
            assert signed_area(outer) == 16.0
            assert signed_area(inner) == -1.0


def test_a_hole_belongs_to_the_smallest_outline_around_it() -> None:
    island = 2 * SQUARE + 4  # within the hole of the first
    found = polygons(region((10 * SQUARE, island, SQUARE + 20), (4 * SQUARE + 3, 0.5 * SQUARE + 4.5)))

    assert [len(polygon) for polygon in found] == [2, 2, 1]
    assert min(found[1][1]) == [4.5, 4.5]


def test_a_feature_says_what_the_region_is_in_which_frame() -> None:
    home = flat()
    body = regions_geojson("flat", home.partition())
    kitchen = next(f for f in body["features"] if f["id"] == "r-kitchen")

    assert (body["type"], body["frame"], body["unit"]) == ("FeatureCollection", "world", "metre")
    assert kitchen["geometry"]["type"] == "MultiPolygon"
    assert kitchen["geometry"]["coordinates"][0][0][2] == [8.0, 6.0]
    assert kitchen["properties"]["display_name"] == "kitchen"
    assert kitchen["properties"]["area"] == 9.0
    assert "o-008" in kitchen["properties"]["object_ids"]
    assert json.loads(json.dumps(body)) == body


def test_a_region_without_cells_has_no_polygons() -> None:
    assert polygons(replace(region((), ()), area=0.0)) == []
