"""The regions of a scene in words: floors, a table of regions, what is unexplored, what changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any


def regions_table(body: Mapping[str, Any]) -> list[str]:
    """The api's `regions` as lines: a floor and the regions on it, floor after floor, then what changed last."""
    regions = body["regions"]
    names = {region["region_id"]: region["display_name"] for region in regions}
    lines = [
        ", ".join(
            (
                f"map version {body['map_version']}",
                f"regions revision {body['regions_revision']}",
                _count(len(body["floors"]), "floor"),
                _count(len(regions), "region"),
            )
        )
    ]
    widths = {
        "region_id": max([2, *(len(region["region_id"]) for region in regions)]),
        "display_name": max([4, *(len(region["display_name"]) for region in regions)]),
        "function": max([8, *(len(region["function"]) for region in regions)]),
    }
    for floor in body["floors"]:
        lines += ["", _floor_line(floor)]
        lines.append(_row(("id", "name", "function", "area", "objects", "ways"), widths))
        lines += [
            _row(_cells(region, body, names), widths)
            for region in regions
            if region["floor"] == floor["floor"]
        ]
        lines += [
            f"  unexplored: {frontier['width']:.1f} m at {_place(frontier['position'])}, {where}"
            for frontier in body["frontiers"]
            if frontier["floor"] == floor["floor"]
            for where in [names.get(frontier["region_id"], "no region")]
        ]
    changed = [event_words(event, names) for event in body["events"]]
    return [*lines, *(["", "changed with this revision: " + "; ".join(changed)] if changed else [])]


def event_words(event: Mapping[str, Any], names: Mapping[str, str]) -> str:
    """ "kitchen appeared (was dining area)"."""
    name, other = event["display_name"], names.get(event["other"], event["other"])
    said = {
        "appeared": f"{name} appeared" + (f" (was {other})" if other else ""),
        "vanished": f"{name} is gone" + (f" (now {other})" if other else ""),
        "retyped": f"{event['region_id']} is now called {name}",
        "reshaped": f"{name} has another shape",
    }
    return said[event["kind"]]


def way_words(way: Mapping[str, Any], body: Mapping[str, Any]) -> str:
    """ "5.3 m: living room, doorway 0.9 m, kitchen", or why there is no way."""
    if way["why"]:
        return f"no way: {way['why']}"
    names = {region["region_id"]: region["display_name"] for region in body["regions"]}
    through = [names.get(region_id, region_id) for region_id in way["region_ids"]]
    passages = [f"{passage['kind']} {passage['width']:.1f} m" for passage in way["passages"]]
    corners = " -> ".join(_place(corner) for corner in way["path"])
    words = [f"{way['length']:.1f} m through {', '.join(through) or 'no region'}"]
    return "; ".join([*words, *([f"by {', '.join(passages)}"] if passages else [])]) + f"\n{corners}"


def _floor_line(floor: Mapping[str, Any]) -> str:
    ceiling = "no ceiling seen" if floor["ceiling_z"] is None else f"ceiling at {floor['ceiling_z']:.2f} m"
    return f"floor {floor['floor']}: {floor['area']:.1f} m² at {floor['z']:.2f} m, {ceiling}"


def _cells(
    region: Mapping[str, Any], body: Mapping[str, Any], names: Mapping[str, str]
) -> tuple[str, str, str, str, str, str]:
    ways = "; ".join(_ways(region["region_id"], body, names)) or "none"
    area, objects = f"{region['area']:.1f} m²", str(len(region["object_ids"]))
    return region["region_id"], region["display_name"], region["function"], area, objects, ways


def _ways(region_id: str, body: Mapping[str, Any], names: Mapping[str, str]) -> Iterator[str]:
    for edge in body["edges"]:
        if region_id in (edge["a"], edge["b"]):
            other = edge["b"] if edge["a"] == region_id else edge["a"]
            yield f"{names.get(other, other)} {other} ({edge['kind']} {edge['width']:.1f} m)"


def _row(cells: tuple[str, str, str, str, str, str], widths: Mapping[str, int]) -> str:
    region_id, name, function, area, objects, ways = cells
    return (
        f"  {region_id:{widths['region_id']}}  {name:{widths['display_name']}}  "
        f"{function:{widths['function']}}  {area:>9}  {objects:>7}  {ways}"
    )


def _place(position: list[float]) -> str:
    return f"({position[0]:.2f}, {position[1]:.2f})"


def _count(number: int, word: str) -> str:
    return f"{number} {word}{'' if number == 1 else 's'}"
