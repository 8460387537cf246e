"""The XML of a Sweet Home 3D home as values in our frame and unit, nothing placed yet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from ovip.scene.types import F64, U8

PIECES = ("pieceOfFurniture", "light")
ARC_STEPS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Wall:
    """A straight wall. start, end: `(2,)` metres. heights: above its level at start and end. sides: left, right RGB."""

    level: str
    start: F64
    end: F64
    thickness: float
    heights: tuple[float, float]
    sides: tuple[U8 | None, U8 | None]
    joined: tuple[bool, bool]


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """polygon: `(N, 2)` metres. name: "" for none."""

    level: str
    name: str
    polygon: F64
    floor: bool
    ceiling: bool
    color: U8 | None


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A piece of furniture, a door or a window. position: foot above its level, `(3,)`. size: before it is tilted.

    yaw: radians counter-clockwise from above. colors: by material name; color: of all. group: the group that it
    is a part of, "" for none.
    """

    level: str
    model: str
    name: str
    position: F64
    size: tuple[float, float, float]
    yaw: float
    pitch: float
    roll: float
    mirrored: bool
    rotation: tuple[float, ...] | None
    color: U8 | None
    colors: dict[str, U8]
    opening: bool
    stairs: bool
    top: float | None
    group: str


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """A storey as drawn: metres."""

    name: str
    z: float
    height: float


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A home as drawn; levels by id, "" for the only one of a home without levels."""

    levels: dict[str, Level]
    walls: tuple[Wall, ...]
    rooms: tuple[Room, ...]
    pieces: tuple[Piece, ...]
    author: str
    license: str


def read_plan(text: str) -> Plan:
    """A plan from a `Home.xml`; invisible pieces are left out."""
    root = ElementTree.fromstring(text)
    height = float(root.get("wallHeight", 250)) / 100
    levels = {level.get("id", ""): _level(level) for level in root.iter("level")} or {
        "": Level("", 0.0, height)
    }
    facts = {p.get("name"): p.get("value", "") for p in root.iter("property")}
    return Plan(
        levels=levels,
        walls=tuple(part for wall in root.iter("wall") for part in _walls(wall, height)),
        rooms=tuple(_room(room) for room in root.iter("room")),
        pieces=tuple(_pieces(root, "")),
        author=str(facts.get("Author") or "its author"),
        license=str(facts.get("License") or "its own licence"),
    )


def _level(element: ElementTree.Element) -> Level:
    return Level(element.get("name", ""), _metres(element, "elevation"), _metres(element, "height", 250))


def _walls(element: ElementTree.Element, usual: float) -> Iterator[Wall]:
    """One wall, or the straight pieces of a round one."""
    first = np.array([_metres(element, "xStart"), -_metres(element, "yStart")])
    last = np.array([_metres(element, "xEnd"), -_metres(element, "yEnd")])
    extent = float(element.get("arcExtent", 0))
    points = [first, last] if abs(extent) < 1e-3 else _arc(first, last, extent)
    low = _metres(element, "height", usual * 100)
    heights = np.linspace(low, _metres(element, "heightAtEnd", low * 100), len(points))
    sides = (_color(element.get("leftSideColor")), _color(element.get("rightSideColor")))
    for i in range(len(points) - 1):
        yield Wall(
            level=element.get("level", ""),
            start=points[i],
            end=points[i + 1],
            thickness=_metres(element, "thickness", 7.5),
            heights=(float(heights[i]), float(heights[i + 1])),
            sides=sides,
            joined=(
                i > 0 or "wallAtStart" in element.attrib,
                i < len(points) - 2 or "wallAtEnd" in element.attrib,
            ),
        )


def _arc(first: F64, last: F64, extent: float) -> list[F64]:
    """Points of a circle from one end to the other; `extent` is drawn with y down, so it turns the other way."""
    chord = last - first
    turn = -extent
    middle = (first + last) / 2 + np.array([-chord[1], chord[0]]) / (2 * np.tan(turn / 2))
    arm = first - middle
    angles = np.linspace(0, turn, ARC_STEPS + 1)
    return [middle + _turned(arm, float(angle)) for angle in angles]


def _turned(vector: F64, angle: float) -> F64:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def _room(element: ElementTree.Element) -> Room:
    corners = [(_metres(p, "x"), -_metres(p, "y")) for p in element.findall("point")]
    return Room(
        level=element.get("level", ""),
        name=element.get("name", "").strip(),
        polygon=np.asarray(corners, np.float64),
        floor=element.get("floorVisible") != "false",
        ceiling=element.get("ceilingVisible") != "false",
        color=_color(element.get("floorColor")),
    )


def _pieces(parent: ElementTree.Element, group: str) -> Iterator[Piece]:
    for element in parent:
        if element.get("visible") == "false":
            continue
        if element.tag == "furnitureGroup":
            name = group or f"{element.get('name', '')}#{element.get('x')}#{element.get('y')}"
            yield from _pieces(element, name)
        elif element.tag in (*PIECES, "doorOrWindow"):
            yield _piece(element, group)


def _piece(element: ElementTree.Element, group: str) -> Piece:
    model = element.get("model", "")
    rotation = element.get("modelRotation")
    top = float(element.get("dropOnTopElevation", 1))
    size = (_metres(element, "width"), _metres(element, "depth"), _metres(element, "height"))
    position = (_metres(element, "x"), -_metres(element, "y"), _metres(element, "elevation"))
    colors = {m.get("name", ""): _color(m.get("color")) for m in element.findall("material")}
    return Piece(
        level=element.get("level", ""),
        model=model,
        name=element.get("name", ""),
        position=np.asarray(position, np.float64),
        size=size,
        yaw=-float(element.get("angle", 0)),
        pitch=float(element.get("pitch", 0)),
        roll=float(element.get("roll", 0)),
        mirrored=element.get("modelMirrored") == "true",
        rotation=tuple(float(v) for v in rotation.split()) if rotation else None,
        color=_color(element.get("color")),
        colors={name: color for name, color in colors.items() if color is not None},
        opening=element.tag == "doorOrWindow",
        stairs="staircaseCutOutShape" in element.attrib,
        top=top * size[2] if top > 0 else None,
        group=group,
    )


def _metres(element: ElementTree.Element, name: str, default: float = 0.0) -> float:
    return float(element.get(name, default)) / 100


def _color(value: str | None) -> U8 | None:
    """RGB of an `AARRGGBB` word."""
    if not value:
        return None
    return np.array([int(value[-6:][i : i + 2], 16) for i in (0, 2, 4)], np.uint8)
