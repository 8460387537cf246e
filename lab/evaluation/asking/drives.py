"""Drives to where a policy says the target is, over the true terrain, and whether they end at it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from lab.evaluation.asking.questions import Question
from lab.evaluation.asking.terrain import Terrain, length
from lab.evaluation.asking.worlds import Place
from lab.evaluation.scores.navigation import Drive
from lab.simulation.camera import EYE_HEIGHT, PITCH, pose_looking
from ovip.scene.types import F64, Bools

WITHIN = 1.0
"""Metres from an instance at which a drive is a success."""
_SAME_PLACE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Where a drive begins. xy: `(2,)`, the middle of a standing cell."""

    floor: int
    xy: F64
    yaw: float
    z: float

    @property
    def pose(self) -> F64:
        """world_from_camera `(4, 4)` of a robot that stands there."""
        return pose_looking((self.xy[0], self.xy[1], self.z + EYE_HEIGHT), self.yaw, PITCH)


@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """Where a policy goes. goal: `(3,)` metres, None where it says nothing. already: metres driven before, to search.

    begin: `(2,)` where that left the robot; None for the start.
    """

    goal: F64 | None
    already: float = 0.0
    begin: F64 | None = None


def start_of(terrain: Terrain, floor: int, question: int, seed: int) -> Start:
    """A standing cell drawn evenly from the storey's largest connected floor, by question and seed alone."""
    rng = np.random.default_rng([seed, question])
    cells = np.argwhere(_largest(terrain, floor))
    row, column = cells[int(rng.integers(len(cells)))]
    yaw = float(rng.uniform(-np.pi, np.pi))
    return Start(floor, terrain.grids[floor].xy_of(float(row), float(column)), yaw, terrain.heights[floor])


def drive(place: Place, question: Question, start: Start, bound: Bound) -> tuple[Drive, Drive]:
    """The drive as scored loosely, and strictly.

    Both end at the standing cell nearest to the goal, on the start's storey. Loosely it is a success within a metre,
    straight over the floor, of the footprint of an instance that was meant; strictly where one walks at most a metre
    from there to the standing place nearest to the instance, so that no wall is in between. `shortest` is the way to
    the nearest place that is such a success.
    """
    terrain = place.terrain
    begin = start.xy if bound.begin is None else bound.begin
    path = np.zeros((0, 2))
    if bound.goal is not None and terrain.floor_at(float(bound.goal[2])) == start.floor:
        path = terrain.drive(start.floor, begin, bound.goal[:2])
    taken = bound.already + length(path)
    end = terrain.grids[start.floor].cell_of(path[-1]) if len(path) else None
    walked = terrain.walked(start.floor, start.xy)
    same = _is_truth(place, question, bound)
    loose, strict = (
        _scored(area, walked, end, taken, same) for area in _success(place, question, start.floor)
    )
    return loose, strict


def _success(place: Place, question: Question, floor: int) -> tuple[Bools, Bools]:
    boxes = [t.box for t in map(place.truth.thing, question.meant) if t.floor == floor]
    terrain, nowhere = place.terrain, np.zeros_like(place.terrain.standing(floor))
    loose = np.logical_or.reduce([nowhere, *(terrain.beside(floor, box, WITHIN) for box in boxes)])
    strict = np.logical_or.reduce([nowhere, *(terrain.at(floor, box, WITHIN) for box in boxes)])
    return loose, strict


def _scored(area: Bools, walked: F64, end: tuple[int, int] | None, taken: float, same: bool) -> Drive:
    shortest = float(walked[area].min(initial=np.inf))
    return Drive(end is not None and bool(area[end]), taken, shortest, same)


def _is_truth(place: Place, question: Question, bound: Bound) -> bool:
    if bound.goal is None:
        return False
    apart = place.truth.centres(question.meant)[:, :2] - bound.goal[:2]
    return bool((np.hypot(*apart.T) <= _SAME_PLACE).any())


def _largest(terrain: Terrain, floor: int) -> Bools:
    """The largest piece of floor that can be walked without a break."""
    standing = terrain.standing(floor)
    left, best = standing.copy(), np.zeros_like(standing)
    while left.any() and left.sum() > best.sum():
        row, column = np.argwhere(left)[0]
        piece = np.isfinite(terrain.walked(floor, terrain.grids[floor].xy_of(float(row), float(column))))
        left &= ~piece
        best = piece if piece.sum() > best.sum() else best
    return best


def reachable_questions(place: Place, questions: Iterable[Question], floor: int) -> tuple[Question, ...]:
    """The questions of which some instance on the storey can be driven to from most of its floor."""
    main = _largest(place.terrain, floor)
    return tuple(q for q in questions if (_success(place, q, floor)[1] & main).any())
