"""What a robot detected on board, as JSON beside a recording's frame: one file a frame, masks as run lengths.

`{"detections": [{"label", "score", "box": [x0, y0, x1, y1], "mask": {"size": [H, W], "counts": [...]},
"feature": [...], "second_feature": [...]}]}`; mask and features may be absent. The mask is COCO's uncompressed
run-length form: lengths of runs that take turns, outside first, down the columns from the left.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.frames import OnboardDetection
from ovip.recordings.text import json_number, read_json
from ovip.scene.types import F32, Bools, Box2


def read_onboard(path: Path) -> tuple[OnboardDetection, ...]:
    """The detections in `path`; InvalidInput says which one is wrong."""
    listed = read_json(path).get("detections")
    if not isinstance(listed, list):
        raise InvalidInput(f"{path}: expected a list under 'detections', got {type(listed).__name__}")
    return tuple(_detection(item, path) for item in listed)


def write_onboard(path: Path, detections: Sequence[OnboardDetection]) -> None:
    """Writes what `read_onboard` reads."""
    path.write_text(
        json.dumps({"detections": [_plain(detection) for detection in detections]}), encoding="utf-8"
    )


def encode_runs(mask: Bools) -> dict[str, list[int]]:
    """An `(H, W)` mask as COCO's uncompressed run lengths."""
    flat = np.asarray(mask, dtype=np.bool_).ravel(order="F")
    changes = np.flatnonzero(np.diff(flat)) + 1
    lengths = np.diff(np.concatenate([[0], changes, [flat.size]])).tolist()
    return {"size": list(mask.shape), "counts": [0, *lengths] if flat.size and flat[0] else lengths}


def decode_runs(runs: object, where: str) -> Bools:
    """COCO's uncompressed run lengths -> `(H, W)` mask."""
    size = _whole(runs.get("size")) if isinstance(runs, dict) else None
    counts = _whole(runs.get("counts")) if isinstance(runs, dict) else None
    if size is None or counts is None or len(size) != 2:
        raise InvalidInput(f"{where}: expected a mask {{size: [H, W], counts: [...]}}, got {runs!r:.80}")
    if sum(counts) != size[0] * size[1]:
        raise InvalidInput(
            f"{where}: expected runs over {size[0]}x{size[1]} pixels, got {sum(counts)} pixels"
        )
    inside = np.arange(len(counts)) % 2 == 1
    return np.asarray(np.repeat(inside, counts).reshape((size[0], size[1]), order="F"), dtype=np.bool_)


def _whole(values: object) -> list[int] | None:
    """`values` where it is a list of whole numbers, none negative."""
    if not isinstance(values, list):
        return None
    return values if all(type(value) is int and value >= 0 for value in values) else None


def _detection(item: object, path: Path) -> OnboardDetection:
    if not isinstance(item, dict) or not isinstance(item.get("label"), str):
        raise InvalidInput(f"{path}: expected a detection with a 'label', got {item!r:.80}")
    box = item.get("box")
    if not (isinstance(box, list) and len(box) == 4 and all(isinstance(edge, int | float) for edge in box)):
        raise InvalidInput(f"{path}: expected 'box': [x0, y0, x1, y1] for {item['label']!r}, got {box!r}")
    mask = item.get("mask")
    return OnboardDetection(
        label=item["label"],
        score=json_number(item, "score", path),
        box2=Box2(*map(float, box)),
        mask=None if mask is None else decode_runs(mask, str(path)),
        feature=_feature(item, "feature", path),
        second_feature=_feature(item, "second_feature", path),
    )


def _feature(item: dict[str, object], name: str, path: Path) -> F32 | None:
    values = item.get(name)
    if values is None:
        return None
    if not (isinstance(values, list) and values and all(isinstance(value, int | float) for value in values)):
        raise InvalidInput(f"{path}: expected {name!r} as a list of numbers, got {values!r:.80}")
    return np.asarray(values, dtype=np.float32)


def _plain(detection: OnboardDetection) -> dict[str, object]:
    box = detection.box2
    plain: dict[str, object] = {
        "label": detection.label,
        "score": round(detection.score, 6),
        "box": [box.x0, box.y0, box.x1, box.y1],
    }
    if detection.mask is not None:
        plain["mask"] = encode_runs(detection.mask)
    for name, feature in (("feature", detection.feature), ("second_feature", detection.second_feature)):
        if feature is not None:
            plain[name] = feature.tolist()
    return plain
