"""A walk that shows a whole home: through every area of every storey, up the stairs, slowly, touching nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from lab.simulation.camera import pose_looking
from lab.simulation.gaze import SAMPLE, arc_over, best_places, gaze, headings, rounded, sampled, turn_to
from lab.simulation.ground import Flight, Ground
from lab.simulation.home import Area, Home
from ovip.scene.types import F64, I64, Bools
from ovip.scene.walking import distance_field, straighten

_SHARES = (1.0, 0.8, 0.65, 0.5, 0.4, 0.3, 0.0)  # of an area's stops, when there are too few frames for all
_STAIR_SMOOTH = 0.25  # metres over which the camera's height follows a stair
_SPARSE = 4  # fewer things than this are no view of an area: its corners are looked at too
_CANDIDATES = 200  # places of an area that are weighed
_NEAR, _FAR = 0.6, 4.0  # metres between which things are looked at
_STRAY = 0.06  # metres by which rounding a corner may come nearer to things


@dataclass(frozen=True, slots=True)
class TourParams:
    """height: of the camera above the floor, metres. pitch: lowest and highest, radians, one a stop.

    clearance: kept from everything, metres; less (down to `least_clearance`) where an area is not reached
    otherwise. step (metres) and turn (radians): the most between two frames. crowding: an area of A square metres
    with N things has sqrt(A N) / crowding stops, 2 to `most_stops`. margin: radians that a view sees beyond what it
    points at. widest: radians of a turn on the spot.
    """

    height: float = 1.3
    pitch: tuple[float, float] = (-0.34, -0.16)
    clearance: float = 0.32
    least_clearance: float = 0.2
    step: float = 0.25
    turn: float = np.pi / 15
    crowding: float = 4.5
    most_stops: int = 5
    margin: float = 0.4
    widest: float = 3.6


def walk_through(
    home: Home,
    seed: int = 0,
    frames: int | None = None,
    params: TourParams | None = None,
    ground: Ground | None = None,
) -> list[F64]:
    """Poses `(4, 4)` of a camera carried through the home.

    It stops at places spread over each area and turns over all that stands there. frames: exactly so many; the
    tour is made shorter (fewer stops) until its steps are small, and where even the shortest is too long for them
    the steps get longer. None: as many as the steps need. Storeys follow one another by their stairs where those
    are straight; without a flight the walk goes on upstairs at once.
    """
    params, ground = params or TourParams(), ground or Ground(home)
    for share in _SHARES:
        track = _Tour(home, ground, params, seed, share).track()
        effort = _effort(track, params)
        if frames is None or effort[-1] <= frames - 1:
            break
    count = int(np.ceil(effort[-1])) + 1 if frames is None else frames
    at = np.linspace(0, effort[-1], count)
    rows = np.stack([np.interp(at, effort, column) for column in track.T], axis=1)
    return [pose_looking(row[:3], float(row[3]), float(row[4])) for row in rows]


class _Tour:
    """Puts one walk together as rows x, y, z, yaw, pitch of the camera."""

    def __init__(self, home: Home, ground: Ground, params: TourParams, seed: int, share: float) -> None:
        self._home, self._ground, self._params = home, ground, params
        self._share = share
        self._rng = np.random.default_rng(seed)
        self._rows: list[F64] = []

    def track(self) -> F64:
        """`(N, 5)` rows close together, yaw unwrapped."""
        place: F64 | None = None
        for storey in sorted(self._home.storeys, key=lambda s: s.z):
            place = self._storey(storey.floor, place)
            flight = next((f for f in self._ground.flights if f.lower == storey.floor), None)
            if flight is not None and place is not None:
                place = self._climb(flight, place)
            else:
                place = None
        track = np.concatenate(self._rows)
        track[:, 3] = np.unwrap(track[:, 3])
        return track

    def _storey(self, floor: int, place: F64 | None) -> F64 | None:
        """Walks a storey from `place` (None: anywhere) and returns where it ends; None where nobody can stand."""
        areas = [area for area in self._home.areas if area.floor == floor]
        standing, radius = self._walkable(floor, areas, place)
        if not standing.any():
            return place
        stops = {area.area_id: self._places(area, standing) for area in areas}
        stops = {area_id: places for area_id, places in stops.items() if len(places)}
        by_id = {area.area_id: area for area in areas}
        if place is None:
            first = by_id[sorted(stops)[int(self._rng.integers(len(stops)))]]
            place = stops[first.area_id][0]
        here: Area | None = None
        while stops:
            distance = self._distances(floor, place, standing)
            near = {
                key: [self._at(distance, floor, stop) for stop in places] for key, places in stops.items()
            }
            key = (
                here.area_id if here and here.area_id in stops else min(near, key=lambda k: (min(near[k]), k))
            )
            chosen = int(np.argmin(near[key]))
            here, stop = by_id[key], stops[key][chosen]
            stops[key] = np.delete(stops[key], chosen, axis=0)
            stops = {k: v for k, v in stops.items() if len(v)}
            self._walk(floor, self._trace(distance, floor, stop), radius, *self._view(here, stop))
            place = stop
        return place

    def _walkable(self, floor: int, areas: Sequence[Area], place: F64 | None) -> tuple[Bools, float]:
        """The piece of floor to walk on, with as much clearance as reaches the most areas."""
        regions = self._ground.grids[floor].regions
        best: tuple[int, Bools, float] | None = None
        for radius in np.linspace(self._params.clearance, self._params.least_clearance, 3):
            pieces, _ = ndimage.label(self._ground.standing(floor, float(radius)), np.ones((3, 3)))
            piece = pieces == self._piece(pieces, floor, place)
            reached = len(np.unique(regions[piece & (pieces > 0)])) if piece.any() else 0
            if best is None or reached > best[0]:
                best = (reached, piece & (pieces > 0), float(radius))
        assert best is not None  # three radii were tried
        return best[1], best[2]

    def _piece(self, pieces: I64, floor: int, place: F64 | None) -> int:
        """The connected piece that holds `place`, else the largest; 0 where there is none."""
        sizes = np.bincount(pieces.ravel())
        sizes[0] = 0
        if place is not None:
            cells = np.argwhere(pieces > 0)
            if len(cells):
                grid = self._ground.grids[floor]
                near = cells[np.argmin(np.hypot(*(cells - np.array(grid.cell_of(place))).T))]
                return int(pieces[tuple(near)])
        return int(np.argmax(sizes)) if sizes.any() else 0

    def _places(self, area: Area, standing: Bools) -> F64:
        """Stops `(N, 2)` from which most of an area is well seen; beside it where it has no place to stand."""
        grid = self._ground.grids[area.floor]
        number = grid.region_ids.index(str(area.area_id)) + 1
        cells = np.argwhere(standing & (grid.regions == number))
        if not len(cells):
            cells = np.argwhere(standing)
            away = np.hypot(*(cells - np.array(grid.cell_of(area.polygon.mean(axis=0)))).T) * grid.resolution
            nearest = cells[[int(np.argmin(away))]]
            return self._centres(area.floor, nearest) if away.min() < 3.0 else np.zeros((0, 2))
        cells = self._rng.permutation(cells)[:_CANDIDATES]
        size = len(np.flatnonzero(grid.regions == number)) * grid.resolution**2
        targets, weights = self._targets(area)
        full = np.clip(
            np.sqrt(size * len(self._things(area))) / self._params.crowding, 2, self._params.most_stops
        )
        count = max(1, round(self._share * float(full)))
        return best_places(self._centres(area.floor, cells), targets, weights, count)

    def _things(self, area: Area) -> F64:
        """Middles `(N, 2)` of what stands in the area."""
        boxes = [thing.box for thing in self._home.things if thing.area_id == area.area_id]
        return np.array([(box[:2] + box[3:5]) / 2 for box in boxes]).reshape(-1, 2)

    def _targets(self, area: Area) -> tuple[F64, F64]:
        """What is to be seen of an area `(N, 2)`: its things, and with less weight `(N,)` its corners and middle."""
        things = self._things(area)
        outline = np.vstack([area.polygon, area.polygon.mean(axis=0)])
        weights = np.append(np.ones(len(things)), np.full(len(outline), 0.3))
        return np.vstack([things, outline]), weights

    def _centres(self, floor: int, cells: I64) -> F64:
        grid = self._ground.grids[floor]
        return np.asarray((cells[:, ::-1] + 0.5) * grid.resolution + np.array(grid.origin))

    def _distances(self, floor: int, place: F64, standing: Bools) -> F64:
        grid = self._ground.grids[floor]
        cells = np.argwhere(standing)
        near = cells[np.argmin(np.hypot(*(cells - np.array(grid.cell_of(place))).T))]
        return distance_field(standing, (int(near[0]), int(near[1])), grid.resolution)

    def _at(self, distance: F64, floor: int, stop: F64) -> float:
        return float(distance[self._ground.grids[floor].cell_of(stop)])

    def _trace(self, distance: F64, floor: int, stop: F64) -> F64:
        """The way `(N, 2)` from where distances are counted to `stop`, downhill in them."""
        grid = self._ground.grids[floor]
        cell = grid.cell_of(stop)
        way = [cell]
        around = np.array([(r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if r or c])
        padded = np.pad(distance, 1, constant_values=np.inf)
        while distance[cell] > 0:
            steps = np.hypot(*around.T) * grid.resolution
            cost = padded[tuple((np.array(cell) + 1 + around).T)] + steps
            cost[(np.abs(around).sum(axis=1) == 2) & (cost > distance[cell] + 1e-6)] = np.inf
            row, column = np.array(cell) + around[int(np.argmin(cost))]
            cell = (int(row), int(column))
            way.append(cell)
        return self._centres(floor, np.array(way[::-1]))

    def _view(self, area: Area, stop: F64) -> tuple[float, float]:
        """First and last yaw of the turn that shows what stands in the area; equal where no turn is needed."""
        away = self._things(area) - stop
        away = away[(np.hypot(*away.T) > _NEAR) & (np.hypot(*away.T) < _FAR)]
        if len(away) < _SPARSE:
            away = np.vstack([away, area.polygon - stop])
        return arc_over(np.arctan2(away[:, 1], away[:, 0]), self._params.margin, self._params.widest)

    def _walk(self, floor: int, way: F64, radius: float, first: float, last: float) -> None:
        """Goes along a way of cell centres and turns from yaw `first` to `last` at its end, or the other way round."""
        grid = self._ground.grids[floor]
        points = sampled(straighten(grid, way, radius))
        smooth = rounded(points)
        nearest = min((self._ground.clearance_at(p, floor) for p in smooth), default=0.0)
        points = smooth if nearest >= radius - _STRAY else points
        before = self._rows[-1][-1] if self._rows else None
        along = headings(points)
        arriving = along[-1] if len(points) > 1 else (before[3] if before is not None else first)
        if abs(turn_to(arriving, last)) < abs(turn_to(arriving, first)):
            first, last = last, first
        pitch = float(self._rng.uniform(*self._params.pitch))
        start = (before[3], before[4]) if before is not None else (first, pitch)
        z = self._ground.storey(floor).z + self._params.height
        self._append(points, np.full(len(points), z), gaze(points, along, start[0], first), start[1], pitch)
        turned = np.linspace(first, last, max(2, int(np.ceil(abs(last - first) / 0.02))))
        still = np.repeat(points[-1:], len(turned), axis=0)
        self._append(still, np.full(len(turned), z), turned, pitch, pitch)

    def _climb(self, flight: Flight, place: F64) -> F64:
        """Goes to the foot of a flight and up; returns where it ends."""
        areas = [area for area in self._home.areas if area.floor == flight.lower]
        standing, radius = self._walkable(flight.lower, areas, place)
        distance = self._distances(flight.lower, place, standing)
        foot = self._nearest(standing & np.isfinite(distance), flight.lower, flight.way[0, :2])
        up = flight.way[2] - flight.way[1]
        yaw = float(np.arctan2(up[1], up[0]))
        if foot is None:
            return flight.way[3, :2]
        self._walk(flight.lower, self._trace(distance, flight.lower, foot), radius, yaw, yaw)
        knots = np.vstack([[*foot, flight.way[0, 2]], flight.way])
        length = np.append(0, np.cumsum(np.linalg.norm(np.diff(knots, axis=0), axis=1)))
        at = np.linspace(0, length[-1], int(length[-1] / SAMPLE) + 2)
        points = np.stack([np.interp(at, length, column) for column in knots.T], axis=1)
        pitch = float(self._rows[-1][-1, 4])
        rise = ndimage.gaussian_filter1d(points[:, 2], _STAIR_SMOOTH / SAMPLE, mode="nearest")
        self._append(points[:, :2], rise + self._params.height, np.full(len(points), yaw), pitch, pitch)
        return points[-1, :2]

    def _nearest(self, standing: Bools, floor: int, xy: F64) -> F64 | None:
        cells = np.argwhere(standing)
        if not len(cells):
            return None
        centres = self._centres(floor, cells)
        return np.asarray(centres[np.argmin(np.hypot(*(centres - xy).T))])

    def _append(self, points: F64, z: F64, yaw: F64, pitch: float, to_pitch: float) -> None:
        tilt = np.linspace(pitch, to_pitch, len(points))
        rows = np.column_stack([points, z, yaw, tilt])
        if self._rows:  # by the shorter way round
            rows[:, 3] += 2 * np.pi * np.round((self._rows[-1][-1, 3] - rows[0, 3]) / (2 * np.pi))
        self._rows.append(rows)


def _effort(track: F64, params: TourParams) -> F64:
    """How many frames it takes to reach each row `(N,)`."""
    change = np.abs(np.diff(track, axis=0))
    steps = np.maximum(np.linalg.norm(change[:, :3], axis=1) / params.step, change[:, 3] / params.turn)
    # a jump to a storey without a way there takes no frames
    steps[np.linalg.norm(change[:, :3], axis=1) > 1.0] = 0.0
    return np.append(0.0, np.cumsum(steps))
