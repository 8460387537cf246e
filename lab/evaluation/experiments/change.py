"""What a map makes of time: static places seen twice must not lose a thing; what went or moved must be noticed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from lab.evaluation.asking.worlds import WorldSpec, world_notes, worlds_of
from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.stages import Shown, Stage, stage_of, walked
from lab.evaluation.processes import in_processes
from ovip.scene.types import DetectionBatch, MapDelta, MapObject, Presence
from services.mapper.domain.object_map import ObjectMap, map_of
from services.mapper.domain.params import MapParams

_OWN = 0.08  # metres from a thing's surface within which a mapped point is the thing's
_OWNED = 1 / 3  # of an object's points that must be one thing's
_CHANCES = 3  # views without which nobody could notice
_ARRIVED = 0.3  # metres from the middle of where a thing went
_THICK = 0.06  # metres: twice the drift that presence allows for
_NOTES = (
    "a walk, and the same again: other noise, another drift of the pose, other mistakes of an imperfect detector",
    "false_removals: share of the objects confirmed by the first walk that the second gave up though nothing changed",
    "strict false_removals: of those that are of a thing, and not of nothing",
    f"noticed: of things that went or moved, mapped, {_CHANCES} views past their place: share given up or recognised",
    "views: how many of those views it took, at the median and at most",
    f"strict noticed: of those whose thinnest side is over {_THICK} m, which depth can tell from what carried them",
    f"same: of things that moved, mapped, shown {_CHANCES} times where they went: share that keeps its id there",
    "same leans on what the simulated encoder tells of single things; no real encoder was measured",
    "others_lost: share of the objects of things that stayed that were given up",
    "wrong_moves: objects recognised elsewhere that had not moved there",
)


@dataclass(frozen=True, slots=True, eq=False)
class History:
    """What a second walk did to a map. departed: id -> frame that first gave it up; moved: ids recognised elsewhere."""

    after: ObjectMap
    departed: dict[str, int]
    moved: frozenset[str]


def run(options: Options) -> Result:
    """A row for the places as they were, and one for the places changed."""
    specs = worlds_of(options)
    counted = [row for rows in in_processes(_scored, specs, options.workers) for row in rows]
    configs = dict.fromkeys(row["config"] for row in counted)
    rows = [_shares(_pooled([row for row in counted if row["config"] == config])) for config in configs]
    return Result(rows, [_shares(row) for row in counted], notes=(*world_notes(specs), *_NOTES))


def score(stage: Stage, params: MapParams | None = None) -> list[Row]:
    """The counts of one place: static, then changed."""
    first, shown = walked(stage, stage.before, 0)
    base = map_of(first, params)
    owners = owners_of(base, shown)
    still, _ = walked(stage, stage.before, 1)
    other, seen = walked(stage, stage.after, 1, shown)
    return [
        _static(stage, _continued(base, still), owners),
        _changed(stage, _continued(base, other), owners, seen),
    ]


def owners_of(base: ObjectMap, shown: Shown) -> dict[str, int]:
    """Object id -> the thing that most of its points lie on, 0 for none."""
    tree = cKDTree(shown.points) if len(shown.points) else None
    owners = {}
    for o in base.objects():
        cloud = base.cloud_of(o.object_id)
        assert cloud is not None
        owners[o.object_id] = 0
        if tree is not None:
            distance, nearest = tree.query(cloud[0], distance_upper_bound=_OWN)
            counts = np.bincount(shown.ids[nearest[np.isfinite(distance)]], minlength=1)
            owners[o.object_id] = int(counts.argmax()) if counts.max() >= _OWNED * len(cloud[0]) else 0
    return owners


def _continued(base: ObjectMap, batches: Sequence[DetectionBatch]) -> History:
    """A copy of the map, with more batches."""
    after = ObjectMap.restore([base.segment(0)])
    departed: dict[str, int] = {}
    moved: set[str] = set()

    def note(delta: MapDelta, frame: int) -> None:
        moved.update(delta.moved)
        for object_id in delta.departed:
            departed.setdefault(object_id, frame)

    for batch in batches:
        note(after.integrate(batch), int(batch.frame_id))
        if after.upkeep_due:
            note(after.upkeep(), int(batch.frame_id))
    note(after.upkeep(), int(batches[-1].frame_id) if batches else 0)
    return History(after, departed, frozenset(moved))


def _static(stage: Stage, history: History, owners: dict[str, int]) -> Row:
    gone = [object_id for object_id in owners if _is_gone(history, object_id)]
    of_things = [object_id for object_id, owner in owners.items() if owner]
    return {
        "config": "static",
        "scene": stage.name,
        "objects": len(owners),
        "_removed": len(gone),
        "_for_a_while": sum(object_id in history.departed for object_id in owners),
        "_objects_of_things": len(of_things),
        "_removed_of_things": sum(object_id in of_things for object_id in gone),
        "wrong_moves": len(history.moved),
    }


def _changed(stage: Stage, history: History, owners: dict[str, int], seen: Shown) -> Row:
    touched = stage.change.removed | stage.change.moved.keys()
    stayed = [object_id for object_id, owner in owners.items() if owner and owner not in touched]
    mapped = {i: object_id for i in sorted(touched) if (object_id := _object_of(history, owners, i))}
    could = [i for i in mapped if len(seen.past.get(i, ())) >= _CHANCES]
    noticed = [i for i in could if _is_noticed(history, mapped[i])]
    thick = [i for i in could if _thinnest(stage, i) > _THICK]
    views = [_views(history, mapped[i], seen.past[i]) for i in noticed if mapped[i] in history.departed]
    elsewhere = [i for i in mapped if i in stage.change.moved and len(seen.views.get(i, ())) >= _CHANCES]
    same = [i for i in elsewhere if _arrived(history, mapped[i], stage, i)]
    return {
        "config": "changed",
        "scene": stage.name,
        "objects": len(owners),
        "changes": len(touched),
        "mapped": len(mapped),
        "could_notice": len(could),
        "_noticed": len(noticed),
        "_could_notice_thick": len(thick),
        "_noticed_thick": sum(i in thick for i in noticed),
        "_views": views,
        "moves": len(elsewhere),
        "_same": len(same),
        "wrong_moves": len(history.moved - {mapped[i] for i in same}),
        "_stayed": len(stayed),
        "_lost": sum(_is_gone(history, object_id) for object_id in stayed),
    }


def _object_of(history: History, owners: dict[str, int], thing: int) -> str | None:
    """The mapped object of a thing that most frames saw."""
    own = [object_id for object_id, owner in owners.items() if owner == thing]
    return max(own, key=lambda object_id: _now(history, object_id).frames, default=None)


def _now(history: History, object_id: str) -> MapObject:
    found = history.after.find(object_id)
    assert found is not None  # confirmed objects are never forgotten
    return found


def _is_gone(history: History, object_id: str) -> bool:
    return _now(history, object_id).presence is Presence.MOVED_OR_REMOVED


def _is_noticed(history: History, object_id: str) -> bool:
    return _is_gone(history, object_id) or history.after.resolve(object_id) in history.moved


def _views(history: History, object_id: str, past: list[int]) -> int:
    return sum(frame <= history.departed[object_id] for frame in past)


def _arrived(history: History, object_id: str, stage: Stage, thing: int) -> bool:
    """Whether the object is recognised, and stands where the thing does."""
    box = stage.boxes[thing]
    away = np.linalg.norm(_now(history, object_id).centroid - (box[:3] + box[3:]) / 2)
    return history.after.resolve(object_id) in history.moved and bool(away <= _ARRIVED)


def _thinnest(stage: Stage, thing: int) -> float:
    box = next(t.box for t in stage.things if t.object_id == thing)
    return float((box[3:] - box[:3]).min())


def _scored(spec: WorldSpec) -> list[Row]:
    return score(stage_of(spec))


def _pooled(rows: Sequence[Row]) -> Row:
    """Counts of several places, together."""
    first = {column: value for column, value in rows[0].items() if column != "scene"}
    return {
        column: value if isinstance(value, str) else sum((row[column] for row in rows), type(value)())
        for column, value in first.items()
    }


def _shares(row: Row) -> Row:
    """The row as it is read: counts that begin with an underscore made shares."""
    shown = {column: value for column, value in row.items() if not column.startswith("_")}
    if row["config"] == "static":
        return shown | {
            "false_removals": _share(row["_removed"], row["objects"]),
            "for_a_while": _share(row["_for_a_while"], row["objects"]),
            "strict": {"false_removals": _share(row["_removed_of_things"], row["_objects_of_things"])},
        }
    return shown | {
        "noticed": _share(row["_noticed"], row["could_notice"]),
        "views": float(np.median(row["_views"])) if row["_views"] else None,
        "most_views": max(row["_views"], default=None),
        "same": _share(row["_same"], row["moves"]),
        "others_lost": _share(row["_lost"], row["_stayed"]),
        "strict": {"noticed": _share(row["_noticed_thick"], row["_could_notice_thick"])},
    }


def _share(part: int, whole: int) -> float | None:
    return part / whole if whole else None
