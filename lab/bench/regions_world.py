"""A floor of any size to cut up: units of 10 x 5 m with a corridor, walled rooms or an open hall, and much furniture.

One unit of each kind is looked at by a camera, frame by frame; a floor is these units' evidence laid side by side, so
that a large one takes little time to make and holds as many voxels a square metre as a real one does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lab.bench.regions_tiles import Tile
from lab.bench.regions_units import KINDS, THINGS, UNIT, UnitSurfaces, unit_surfaces
from ovip.scene.types import F32, F64
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.evidence import FloorEvidence

_EYE, _SIGHT, _FIELD = 1.2, 6.0, np.pi / 2  # metres, metres, radians across
_TURN = 2.4  # radians from frame to frame: the golden angle, so that few of them look everywhere


@dataclass(frozen=True, slots=True)
class OfficeParams:
    """frames: of a unit's walk. points: most of a frame's surface. things: mapped objects to a unit's part.

    odd: share of the things whose words are of another function than the part's.
    """

    frames: int = 60
    points: int = 5000
    things: int = 20
    odd: float = 0.08


class Office:
    """Floors of `columns` x `rows` units: every third one an open hall, corridors along x, halls that join them.

    Equal seeds give equal floors.
    """

    def __init__(self, seed: int = 0, params: OfficeParams | None = None) -> None:
        self._seed = seed
        self.params = params or OfficeParams()

    def evidence(self, columns: int, rows: int) -> FloorEvidence:
        """What a camera that goes through all of it gathers."""
        whole = FloorEvidence()
        for number, unit in enumerate(_units(columns, rows)):
            self._tiles[unit.kind].lay(whole, unit.corner, f"u{number}-")
        return whole

    def objects(self, columns: int, rows: int) -> PlacedObjects:
        """Things everywhere in each unit's parts, each with a word of its part's function or an odd one."""
        rng = np.random.default_rng([self._seed, columns, rows])
        labels, centres = [], []
        for unit in _units(columns, rows):
            for function, part in zip(KINDS[unit.kind], self._surfaces[unit.kind].parts, strict=True):
                for _ in range(self.params.things):
                    odd = rng.random() < self.params.odd
                    words = THINGS[str(rng.choice(list(THINGS))) if odd else function]
                    labels.append(str(rng.choice(words)))
                    x, y = rng.uniform(part[:2], part[2:]) + unit.corner
                    centres.append((x, y, rng.uniform(0.2, 1.2)))
        ids = tuple(f"o{number:06d}" for number in range(len(labels)))
        return PlacedObjects(ids, tuple(labels), np.array(centres).reshape(-1, 3))

    def look(self, kind: int, number: int) -> tuple[F32, F64]:
        """Frame `number` of a unit's walk: surface `(N, 3)` and camera `(3,)`."""
        rng = np.random.default_rng([self._seed, kind, number])
        return _look(self._surfaces[kind], number / self.params.frames % 1, number * _TURN, rng, self.params)

    @cached_property
    def _surfaces(self) -> tuple[UnitSurfaces, ...]:
        return tuple(
            unit_surfaces(kind, np.random.default_rng([self._seed, kind])) for kind in range(len(KINDS))
        )

    @cached_property
    def _tiles(self) -> tuple[Tile, ...]:
        """What a camera that goes through a unit of each kind gathers."""
        tiles = []
        for kind in range(len(KINDS)):
            evidence = FloorEvidence()
            for number in range(self.params.frames):
                evidence.add(f"f{number}", *self.look(kind, number))
            tiles.append(Tile.of(evidence))
        return tuple(tiles)


@dataclass(frozen=True, slots=True)
class _Unit:
    """kind: index into KINDS. corner: its least x and y, metres."""

    kind: int
    corner: tuple[float, float]


def _units(columns: int, rows: int) -> list[_Unit]:
    return [
        _Unit((column + 2 * row) % len(KINDS), (column * UNIT[0], row * UNIT[1]))
        for row in range(rows)
        for column in range(columns)
    ]


def _look(
    unit: UnitSurfaces, gone: float, heading: float, rng: np.random.Generator, params: OfficeParams
) -> tuple[F32, F64]:
    """What is seen after a share `gone` of the walk from somewhere in that room, thinned; walls hide what is behind."""
    zone = int(np.searchsorted(np.cumsum(unit.shares)[:-1], gone, side="right"))
    camera = np.append(rng.uniform(unit.stands[zone][:2] + 0.3, unit.stands[zone][2:] - 0.3), _EYE)
    away = unit.surfaces[zone] - camera
    bearing = np.arctan2(away[:, 1], away[:, 0]) - heading
    ahead = np.abs((bearing + np.pi) % (2 * np.pi) - np.pi) < _FIELD / 2
    seen = np.flatnonzero(ahead & (np.linalg.norm(away, axis=1) < _SIGHT))
    kept = rng.choice(seen, min(params.points, len(seen)), replace=False)
    return unit.surfaces[zone][np.sort(kept)], camera
