"""Answers and objects as the JSON that REST, the dashboard and `ovip find --json` all print.

Lengths are metres, angles radians, boxes six numbers (low corner, then high corner), pixel boxes x0 y0 x1 y1.
Numbers are rounded to a tenth of a millimetre.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ovip.scene.answers import (
    Answer,
    Candidate,
    Coverage,
    Goal,
    SearchEvent,
    TierReport,
    TierStarted,
    Viewpoint,
)
from ovip.scene.boxes import transformed_bounds
from ovip.scene.types import F32, F64, Box2, MapObject, Relation

_DECIMALS = 4


@dataclass(frozen=True, slots=True)
class OutputFrame:
    """The frame that positions are reported in: the scene's z-up world, or the recording's own.

    world_from_source: `(4, 4)` rigid, or None for the world itself. A box turned into the source frame is the
    axis-aligned bounds of its eight turned corners, so it is never smaller than the box it came from.
    """

    world_from_source: F64 | None = None

    @property
    def name(self) -> str:
        return "world" if self.world_from_source is None else "source"

    def points(self, points: F32 | F64) -> F64:
        """World points `(N, 3)` in this frame -> `(N, 3)`."""
        points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        if self.world_from_source is None:
            return points
        return (points - self.world_from_source[:3, 3]) @ self.world_from_source[:3, :3]

    def box(self, box: F64) -> F64:
        """A world box `(6,)` in this frame -> `(6,)`."""
        return (
            box
            if self.world_from_source is None
            else transformed_bounds(box, _inverse(self.world_from_source))
        )

    def pose(self, world_from_camera: F64) -> F64:
        """A world pose `(4, 4)` as a pose in this frame -> `(4, 4)`."""
        if self.world_from_source is None:
            return world_from_camera
        return _inverse(self.world_from_source) @ world_from_camera

    def world_pose(self, pose: F64) -> F64:
        """A pose `(4, 4)` given in this frame as a world pose: undoes `pose`."""
        return pose if self.world_from_source is None else self.world_from_source @ pose

    def facing(self, yaw: float) -> F64:
        """The unit vector `(3,)` in this frame of a heading of `yaw` radians about the world's z."""
        heading = np.array([np.cos(yaw), np.sin(yaw), 0.0])
        return heading if self.world_from_source is None else heading @ self.world_from_source[:3, :3]


WORLD = OutputFrame()


def answer_to_json(
    answer: Answer, search_id: str = "", world_from_source: F64 | None = None
) -> dict[str, Any]:
    """The answer with its whole account; in the recording's own frame where `world_from_source` is given."""
    frame = OutputFrame(world_from_source)
    return {
        "outcome": answer.outcome.value,
        "tier": answer.tier,
        "object": None if answer.object is None else _candidate(answer.object, frame),
        "goal": None if answer.goal is None else _goal(answer.goal, frame),
        "path": numbers(frame.points(answer.path)),
        "tiers": [_tier(report) for report in answer.tiers],
        "candidates": [_candidate(candidate, frame) for candidate in answer.candidates],
        "rejected": [_candidate(candidate, frame) for candidate in answer.rejected],
        "fallbacks": list(answer.fallbacks),
        "map_version": answer.map_version,
        "regions_revision": answer.regions_revision,
        "coverage": None if answer.coverage is None else _coverage(answer.coverage),
        "needs": answer.needs,
        "search_id": search_id,
        "frame": frame.name,
    }


def object_to_json(obj: MapObject, world_from_source: F64 | None = None) -> dict[str, Any]:
    """A mapped object without its feature; `frame_id` and `box2` say where it is best seen."""
    frame = OutputFrame(world_from_source)
    return {
        "id": obj.object_id,
        "label": obj.label,
        "position": numbers(frame.points(obj.centroid)[0]),
        "box": numbers(frame.box(obj.box)),
        "label_counts": dict(sorted(obj.label_counts.items(), key=lambda item: (-item[1], item[0]))),
        "observations": obj.observations,
        "frames": obj.frames,
        "first_seen_ns": obj.first_seen_ns,
        "last_seen_ns": obj.last_seen_ns,
        "voxels": obj.voxels,
        "mean_color": numbers(obj.mean_color),
        "view_weight": number(obj.view_weight),
        "frame_id": obj.best_frame_id or None,
        "box2": _box2(obj.best_box2) if obj.best_frame_id else None,
        "version": obj.version,
        "revision": obj.revision,
        "presence": obj.presence.value,
        "pinned": obj.pinned,
        "label_given": obj.label_given,
        "relations": [_relation(relation) for relation in obj.relations],
        "moves": [
            {"timestamp_ns": move.timestamp_ns, "position": numbers(frame.points(move.origin)[0])}
            for move in obj.moves
        ],
    }


def event_to_json(
    event: SearchEvent, search_id: str, world_from_source: F64 | None = None
) -> tuple[str, dict[str, Any]]:
    """The name and body of one event of a search: tier_started, tier_finished, viewpoint or answer."""
    match event:
        case TierStarted():
            return "tier_started", {"tier": event.tier, "search_id": search_id}
        case TierReport():
            return "tier_finished", _tier(event) | {"search_id": search_id}
        case Viewpoint():
            return "viewpoint", _viewpoint(event, OutputFrame(world_from_source)) | {"search_id": search_id}
        case Answer():
            return "answer", answer_to_json(event, search_id, world_from_source)


def numbers(values: F32 | F64) -> Any:
    """An array of any shape as nested lists of rounded numbers; an array of no elements as []."""
    return np.round(np.asarray(values, dtype=np.float64), _DECIMALS).tolist()


def number(value: float) -> float | None:
    """A rounded number; None where it is not finite (JSON has no word for that)."""
    return round(float(value), _DECIMALS) if np.isfinite(value) else None


def _relation(relation: Relation) -> dict[str, Any]:
    return {
        "kind": relation.kind.value,
        "object_id": relation.other_id,
        "evidence": {name: number(value) for name, value in sorted(relation.evidence.items())},
    }


def _candidate(candidate: Candidate, frame: OutputFrame) -> dict[str, Any]:
    return {
        "id": candidate.object_id or None,
        "label": candidate.label,
        "position": numbers(frame.points(candidate.position)[0]),
        "box": None if candidate.box is None else numbers(frame.box(candidate.box)),
        "score": number(candidate.score),
        "why": candidate.why,
        "frame_id": candidate.frame_id or None,
        "box2": None if candidate.box2 is None else _box2(candidate.box2),
    }


def _goal(goal: Goal, frame: OutputFrame) -> dict[str, Any]:
    return {"position": numbers(frame.points(goal.position)[0])} | _heading(goal.yaw, frame)


def _viewpoint(viewpoint: Viewpoint, frame: OutputFrame) -> dict[str, Any]:
    return {
        "viewpoint_id": viewpoint.viewpoint_id,
        "position": numbers(frame.points(viewpoint.position)[0]),
        "region_id": viewpoint.region_id,
        "index": viewpoint.index,
        "total": viewpoint.total,
        "path": numbers(frame.points(viewpoint.path)),
    } | _heading(viewpoint.yaw, frame)


def _heading(yaw: float, frame: OutputFrame) -> dict[str, Any]:
    """`yaw` turns about the world's z, which is no axis of the source frame: there only `facing` is given."""
    return {
        "yaw": number(yaw) if frame.world_from_source is None else None,
        "facing": numbers(frame.facing(yaw)),
    }


def _tier(report: TierReport) -> dict[str, Any]:
    return {
        "tier": report.tier,
        "result": report.result.value,
        "why": report.why,
        "vlm_calls": report.vlm_calls,
        "ms": round(report.ms, 3),
    }


def _coverage(coverage: Coverage) -> dict[str, Any]:
    return {
        "planned": coverage.planned,
        "visited": coverage.visited,
        "unreachable": coverage.unreachable,
        "regions": [
            {
                "region_id": region.region_id,
                "display_name": region.display_name,
                "area": number(region.area),
                "seen": number(region.seen),
                "prior": number(region.prior),
            }
            for region in coverage.regions
        ],
        "posterior_present": number(coverage.posterior_present),
        "complete": coverage.complete,
    }


def _box2(box: Box2) -> list[float]:
    return [round(float(value), 2) for value in (box.x0, box.y0, box.x1, box.y1)]


def _inverse(transform: F64) -> F64:
    """Inverse of a rigid `(4, 4)`."""
    inverse = np.eye(4)
    inverse[:3, :3] = transform[:3, :3].T
    inverse[:3, 3] = -transform[:3, :3].T @ transform[:3, 3]
    return inverse
