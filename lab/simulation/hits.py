"""`python -m lab.simulation.hits RECORDING`: how often perception finds what a rendered recording really shows."""

from __future__ import annotations

import argparse
import asyncio
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ovip.clients import VlmClient, connect
from ovip.errors import InvalidInput, OvipError
from ovip.recordings import open_recording
from ovip.recordings.text import read_text
from ovip.scene.types import U16, Box2, Frame
from ovip.wire import decode_depth, decode_rgb
from services.perception.adapters.model_sets import open_models
from services.perception.config import Settings
from services.perception.domain.boxes2d import ScoredBox
from services.perception.ports import Grounder


@dataclass(frozen=True, slots=True)
class HitParams:
    """min_pixels: of an object that counts as visible. min_iou: of a found box with the visible part's box."""

    min_pixels: int = 400
    min_iou: float = 0.3
    stride: int = 1


@dataclass(slots=True)
class Hits:
    """What was there and what was found.

    seen, hit: (object, frame) pairs by label. objects_seen, objects_hit: objects at least once. boxes, right: boxes
    found in all, and those that lie on an object of their class.
    """

    frames: int = 0
    seen: dict[str, int] = field(default_factory=dict)
    hit: dict[str, int] = field(default_factory=dict)
    objects_seen: set[int] = field(default_factory=set)
    objects_hit: set[int] = field(default_factory=set)
    boxes: int = 0
    right: int = 0


def main() -> None:
    """A known error ends with one line and status 1."""
    parser = argparse.ArgumentParser(prog="python -m lab.simulation.hits", description=__doc__)
    parser.add_argument("recording", type=Path, help="layout ovip, with instance/ and objects.json")
    parser.add_argument("--stride", type=int, default=1, help="every so many-th frame")
    parser.add_argument("--min-pixels", type=int, default=400, help="of an object that counts as visible")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    params = HitParams(chosen.min_pixels, stride=chosen.stride)
    try:
        hits, groundable = asyncio.run(perception_hits(chosen.recording, params))
    except OvipError as error:
        print(f"hits: {error}", file=sys.stderr)
        raise SystemExit(1) from error
    report = summary(hits, groundable)
    print(json.dumps(report, indent=1) if chosen.json else _table(report))


async def perception_hits(recording: Path, params: HitParams | None = None) -> tuple[Hits, frozenset[str]]:
    """Runs perception's own models over a recording -> what was hit, and the labels that they can see at all.

    InvalidInput where the recording has no truth beside it.
    """
    params = params or HitParams()
    labels = _labels(recording)
    settings = Settings().model_copy(update={"enumerator": "detector"})
    gateway = connect(settings.vlm_gateway_address, settings.api_key)
    try:
        models = open_models(settings, VlmClient(gateway))
        hits = Hits()
        for frame, ids in _frames(recording, params.stride):
            found = await _found(
                models.grounder, frame, sorted(set(labels.values())), settings.min_confidence
            )
            every = await models.grounder.ground(frame, await models.enumerator.enumerate(frame))
            count_frame(
                hits, ids, labels, found, [b for b in every if b.score >= settings.min_confidence], params
            )
        return hits, frozenset(label for label in labels.values() if models.grounder.groundable(label))
    finally:
        await gateway.close()


def count_frame(
    hits: Hits,
    ids: U16,
    labels: Mapping[int, str],
    found: Mapping[str, Sequence[ScoredBox]],
    every: Sequence[ScoredBox],
    params: HitParams,
) -> None:
    """Adds one frame: its true ids `(H, W)`, the boxes found by label, and all boxes found."""
    hits.frames += 1
    right: set[int] = set()
    for object_id, box, pixels in _visible(ids, labels):
        label = labels[object_id]
        on_it = [b for b in found.get(label, ()) if _iou(b.box, box) > params.min_iou]
        right |= {i for i, b in enumerate(every) if any(b.box == other.box for other in on_it)}
        if pixels < params.min_pixels:
            continue
        hits.seen[label] = hits.seen.get(label, 0) + 1
        hits.hit[label] = hits.hit.get(label, 0) + bool(on_it)
        hits.objects_seen.add(object_id)
        if on_it:
            hits.objects_hit.add(object_id)
    hits.boxes += len(every)
    hits.right += len(right)


def summary(hits: Hits, groundable: frozenset[str]) -> dict[str, Any]:
    """Shares: rows by label, hit rate over labels that perception can see, and over all."""
    rows = [
        {
            "label": label,
            "groundable": label in groundable,
            "seen": seen,
            "hit": hits.hit[label],
            "rate": round(hits.hit[label] / seen, 3),
        }
        for label, seen in sorted(hits.seen.items(), key=lambda entry: (-entry[1], entry[0]))
    ]
    known = [row for row in rows if row["groundable"]]
    return {
        "rows": rows,
        "frames": hits.frames,
        "hit_rate": _share(
            sum(hits.hit[str(r["label"])] for r in known), sum(hits.seen[str(r["label"])] for r in known)
        ),
        "hit_rate_all": _share(sum(hits.hit.values()), sum(hits.seen.values())),
        "objects_seen": len(hits.objects_seen),
        "objects_hit": len(hits.objects_hit),
        "boxes": hits.boxes,
        "precision": _share(hits.right, hits.boxes),
    }


async def _found(
    grounder: Grounder, frame: Frame, labels: Sequence[str], least: float
) -> dict[str, list[ScoredBox]]:
    """Each label asked for by itself, since several labels may mean one class of the detector's."""
    found = {}
    for label in labels:
        if grounder.groundable(label):
            found[label] = [box for box in await grounder.ground(frame, [label]) if box.score >= least]
    return found


def _frames(recording: Path, stride: int) -> Iterator[tuple[Frame, U16]]:
    opened = open_recording(recording, "ovip", stride=stride)
    for frame in opened:
        path = recording / "instance" / f"{frame.index:06d}.png"
        ids = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        if ids is None:
            raise InvalidInput(f"{path}: expected an image of object ids, got none")
        rgb = decode_rgb(frame.rgb_bytes, opened.intrinsics)
        depth = decode_depth(frame.depth_bytes, "png16", frame.depth_scale, opened.intrinsics)
        pose = frame.world_from_camera
        seen = Frame(f"{frame.index:06d}", frame.timestamp_ns, opened.intrinsics, pose, rgb, depth)
        yield seen, np.asarray(ids, dtype=np.uint16)


def _labels(recording: Path) -> dict[int, str]:
    """Label of each object that is no structure, from objects.json in the recording or in the folder above it."""
    path = next(
        (p / "objects.json" for p in (recording, recording.parent) if (p / "objects.json").is_file()), None
    )
    if path is None:
        raise InvalidInput(f"{recording}: expected the truth in objects.json, got none")
    things = json.loads(read_text(path))
    return {int(thing["object_id"]): thing["label"] for thing in things if not thing["structural"]}


def _visible(ids: U16, labels: Mapping[int, str]) -> Iterator[tuple[int, Box2, int]]:
    """Objects in view with the box of their visible part and its pixels."""
    for object_id in np.unique(ids).tolist():
        if object_id in labels:
            rows, columns = np.nonzero(ids == object_id)
            box = Box2(
                float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1)
            )
            yield object_id, box, len(rows)


def _iou(a: Box2, b: Box2) -> float:
    width, height = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
    both = max(width, 0.0) * max(height, 0.0)
    return both / (a.area + b.area - both) if both else 0.0


def _share(part: int, whole: int) -> float:
    return round(part / whole, 3) if whole else 0.0


def _table(report: Mapping[str, Any]) -> str:
    lines = [f"{'label':20} {'seen':>5} {'hit':>5} {'rate':>6}"]
    lines += [
        f"{row['label']:20} {row['seen']:5} {row['hit']:5} {row['rate']:6.2f}"
        + ("" if row["groundable"] else "  (no class of the detector)")
        for row in report["rows"]
    ]
    lines.append(
        f"{report['frames']} frames; hit rate {report['hit_rate']:.2f} where the detector has a class, "
        f"{report['hit_rate_all']:.2f} of all; {report['objects_hit']} of {report['objects_seen']} objects at least "
        f"once; {report['precision']:.2f} of {report['boxes']} boxes lie on a thing of their class"
    )
    return "\n".join(lines)


if __name__ == "__main__":
    main()
