"""A place that changed since it was seen: things carried away, and things put elsewhere."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from lab.simulation.home import Home, HomeObject, Mesh, RelationKind
from lab.simulation.room import SimulatedObject, SimulatedRoom
from lab.simulation.solids import Solid
from ovip.scene.types import F64, I64, Bools

_FLAT = 0.98  # cosine to the vertical from which on a face can carry things
_LEVEL = 0.01  # metres by which what carries a thing may be uneven
_TRIES = 400  # places drawn for a thing


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """removed: ids of things carried away. moved: id -> where to, as a shift `(3,)` in metres."""

    removed: frozenset[int] = frozenset()
    moved: Mapping[int, F64] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class ChangeParams:
    """removed, moved: how many things. smallest, largest: metres of a thing's longest side.

    low, high: metres above its storey's floor between which surfaces are put things on. away: least metres moved.
    """

    removed: int = 8
    moved: int = 8
    smallest: float = 0.06
    largest: float = 0.7
    low: float = 0.3
    high: float = 1.3
    away: float = 1.0


def changed_home(home: Home, change: Change) -> Home:
    """The home after the change. Relations of what went or moved are forgotten."""
    touched = change.removed | change.moved.keys()
    return replace(
        home,
        mesh=_changed_mesh(home.mesh, change),
        objects=tuple(_shifted(home, o, change) for o in home.objects if o.object_id not in change.removed),
        relations=tuple(r for r in home.relations if r.subject not in touched and r.object not in touched),
    )


def some_change(
    home: Home, seed: int, params: ChangeParams | None = None, among: Collection[int] | None = None
) -> Change:
    """Loose things of a home, by seed: some carried away, some put on free places of other things.

    among: ids of the things that are changed and that things are put on, None = all. Fewer than asked for where no
    more are loose, or no place is found for them.
    """
    params = params or ChangeParams()
    chosen = {thing.object_id for thing in home.things} if among is None else set(among)
    rng = np.random.default_rng([seed, 77])
    loose = [thing for thing in loose_things(home, params) if thing.object_id in chosen]
    things = [loose[i] for i in rng.permutation(len(loose))]
    removed = frozenset(thing.object_id for thing in things[: params.removed])
    moved: dict[int, F64] = {}
    places = _Places(home, params, chosen)
    for thing in things[params.removed :]:
        if len(moved) < params.moved and (shift := places.found(thing, moved, rng)) is not None:
            moved[thing.object_id] = shift
    return Change(removed, moved)


def loose_things(home: Home, params: ChangeParams) -> list[HomeObject]:
    """Things of a size to be carried, that carry nothing and are fixed to nothing."""
    carrying = {r.object for r in home.relations if r.kind is not RelationKind.NEXT}
    fixed = {r.subject for r in home.relations if r.kind is RelationKind.ATTACHED}
    return [
        thing
        for thing in home.things
        if params.smallest <= (thing.box[3:] - thing.box[:3]).max() <= params.largest
        and thing.object_id not in carrying | fixed
    ]


class ChangedRoom(SimulatedRoom):
    """The small room of a seed after a change."""

    def __init__(self, seed: int, change: Change) -> None:
        super().__init__(seed)
        self._solids = tuple(_moved_solids(self._solids, change))
        self._obstacles = tuple(_moved_solids(self._obstacles, change))
        self.objects = tuple(
            _moved_object(thing, change) for thing in self.objects if thing.object_id not in change.removed
        )

    def object_with(self, object_id: int) -> SimulatedObject:
        """The object with this id. KeyError for one that was carried away."""
        return {thing.object_id: thing for thing in self.objects}[object_id]


def _moved_solids(solids: Sequence[Solid], change: Change) -> Iterator[Solid]:
    for solid in solids:
        if solid.object_id in change.moved:
            x, y, z = (np.array(solid.center) + change.moved[solid.object_id]).tolist()
            yield replace(solid, center=(x, y, z))
        elif solid.object_id not in change.removed:
            yield solid


def _moved_object(thing: SimulatedObject, change: Change) -> SimulatedObject:
    shift = change.moved.get(thing.object_id)
    return thing if shift is None else replace(thing, box=thing.box + np.tile(shift, 2))


def _shifted(home: Home, thing: HomeObject, change: Change) -> HomeObject:
    """The object where it is after the change, in the area that is there."""
    shift = change.moved.get(thing.object_id)
    if shift is None:
        return thing
    box = thing.box + np.tile(shift, 2)
    area = home.area_at(thing.floor, (box[:2] + box[3:5]) / 2)
    return replace(thing, box=box, area_id=area.area_id if area else 0)


def _changed_mesh(mesh: Mesh, change: Change) -> Mesh:
    """Without the triangles of what went; what moved has corners of its own, so that nothing else is dragged along."""
    keep = ~np.isin(mesh.object_ids, sorted(change.removed))
    triangles, ids = mesh.triangles[keep].copy(), mesh.object_ids[keep]
    vertices = [mesh.vertices]
    count = len(mesh.vertices)
    for object_id, shift in change.moved.items():
        own = ids == object_id
        corners, renamed = np.unique(triangles[own], return_inverse=True)
        vertices.append((mesh.vertices[corners] + shift).astype(np.float32))
        triangles[own] = renamed.reshape(-1, 3) + count
        count += len(corners)
    return replace(
        mesh,
        vertices=np.concatenate(vertices),
        triangles=triangles,
        normals=mesh.normals[keep],
        uv=mesh.uv[keep],
        material_ids=mesh.material_ids[keep],
        object_ids=ids,
    )


class _Places:
    """Where a thing can be put down: flat faces of other things, at a height that people reach, and free."""

    def __init__(self, home: Home, params: ChangeParams, among: Collection[int]) -> None:
        self._home, self._params = home, params
        corners = home.mesh.vertices[home.mesh.triangles].astype(np.float64)
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(cross, axis=1)
        carries = (np.abs(cross[:, 2]) >= _FLAT * np.maximum(area, 1e-12)) & (area > 1e-6)
        carries &= self._reached(corners) & np.isin(home.mesh.object_ids, sorted(among))
        self._faces, self._areas = corners[carries], area[carries]
        self._ids: I64 = home.mesh.object_ids[carries].astype(np.int64)
        self._low, self._high = corners.min(axis=1), corners.max(axis=1)
        self._owners: I64 = home.mesh.object_ids.astype(np.int64)

    def found(self, thing: HomeObject, moved: Mapping[int, F64], rng: np.random.Generator) -> F64 | None:
        """A shift `(3,)` that puts the thing onto a free place; None where none of many tried is one."""
        if not len(self._faces):
            return None
        chance = self._areas / self._areas.sum()
        for face in rng.choice(len(self._faces), _TRIES, p=chance):
            a, b, c = self._faces[face]
            u, v = rng.random(2)
            u, v = (1 - u, 1 - v) if u + v > 1 else (u, v)
            shift = a + u * (b - a) + v * (c - a) - _foot(thing.box)
            if self._is_free(thing, shift, moved):
                return np.asarray(shift, np.float64)
        return None

    def _is_free(self, thing: HomeObject, shift: F64, moved: Mapping[int, F64]) -> bool:
        box = thing.box + np.tile(shift, 2)
        if np.linalg.norm(shift) < self._params.away or not self._is_carried(box, thing.object_id):
            return False
        room = box + np.array([0, 0, _LEVEL, 0, 0, 0])
        others = [o.box + np.tile(moved[o.object_id], 2) for o in self._home.things if o.object_id in moved]
        if any(_meet(room, other) for other in others):
            return False
        crossing = ((self._low < room[3:]) & (self._high > room[:3])).all(axis=1)
        return not (crossing & (self._owners != thing.object_id)).any()

    def _is_carried(self, box: F64, object_id: int) -> bool:
        """Whether its corners and its middle rest on faces of other things, at one height."""
        x, y = np.meshgrid([box[0], box[3]], [box[1], box[4]])
        points = np.vstack([np.column_stack([x.ravel(), y.ravel()]), (box[:2] + box[3:5]) / 2])
        level = np.abs(self._faces[:, :, 2] - box[2]).max(axis=1) <= _LEVEL
        faces = self._faces[level & (self._ids != object_id)]
        return all(_over(faces, point).any() for point in points)

    def _reached(self, corners: F64) -> Bools:
        """Which faces lie at a height that things are put down at, above the floor of some storey."""
        middle = corners[:, :, 2].mean(axis=1)
        heights = [middle - storey.z for storey in self._home.storeys]
        reached: Bools = np.any([(self._params.low <= h) & (h <= self._params.high) for h in heights], axis=0)
        return reached


def _foot(box: F64) -> F64:
    return np.array([(box[0] + box[3]) / 2, (box[1] + box[4]) / 2, box[2]])


def _meet(a: F64, b: F64) -> bool:
    return bool(((a[:3] < b[3:]) & (a[3:] > b[:3])).all())


def _over(faces: F64, point: F64) -> Bools:
    """Which of `(T, 3, 3)` triangles, seen from above, hold the point `(2,)`."""
    a, b, c = (faces[:, i, :2] for i in range(3))
    sides = np.stack([_side(p, q, point) for p, q in ((a, b), (b, c), (c, a))])
    return np.asarray((sides >= 0).all(axis=0) | (sides <= 0).all(axis=0))


def _side(p: F64, q: F64, point: F64) -> F64:
    way, to = q - p, point - p
    return np.asarray(way[:, 0] * to[:, 1] - way[:, 1] * to[:, 0])
