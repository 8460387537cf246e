"""Whether depth, poses and intrinsics fit each other: depth of a frame carried into another, and what would fit better.

Points of frame i go by the poses into camera j; where j measured within 3 % (and 1 cm) of that depth, they
agree. Right recordings agree at nine points of ten. The same is tried with other depth scales, camera axes,
directions and orders of the poses, focal lengths, and poses some frames away; a rival that agrees clearly more says
what is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ovip.recordings.inspection.finding import Figures, Finding
from ovip.recordings.inspection.views import Views, spread, turns
from ovip.recordings.layout import OPENGL_FROM_OPENCV
from ovip.recordings.scales import KNOWN_SCALES
from ovip.recordings.tum import pose_of_quaternion
from ovip.scene.types import F32, F64, Intrinsics

TOLERANCE, FLOOR_M = 0.03, 0.01
FARTHEST_M = 1.0
PAIRS, BASES_M, MOST_TURN, LEAST_TURN = 12, (0.25, 0.1), 30.0, 8.0
GOOD, POOR = 0.75, 0.5
RIVAL_LEAD, RIVAL_LEAST = 0.1, 0.6
SHIFTS = (-10, -5, -4, -3, -2, -1, 1, 2, 3, 4, 5, 10)
_GRID = 4
_LEAST_SHARE = 0.1


@dataclass(frozen=True, slots=True)
class Rival:
    """Another reading of the same files. shift: frames between an image and its pose."""

    says: str
    pose: Callable[[F64], F64] = lambda pose: pose
    depth: float = 1.0
    focal: float = 1.0
    shift: int = 0


def check_agreement(views: Views, scale: float) -> Finding:
    """Whether neighbouring frames see the same surfaces, and what other reading would make them."""
    pairs = choose_pairs(views.poses)
    if len(pairs) < 2:
        return Finding("agreement", "warning", "not checked: the camera moves too little, or always too far")
    own = _score(views, pairs, Rival("as it is"))
    rivals = [(_score(views, pairs, rival), rival) for rival in _rivals(scale)]
    best, rival = max(rivals, key=lambda found: found[0])
    figures: Figures = {"agree": own, "rival": rival.says, "rival_agree": best, "pairs": len(pairs)}
    says = f"{own:.0%} of depth agrees between frames apart"
    if best >= RIVAL_LEAST and best - own >= RIVAL_LEAD:
        return Finding("agreement", "wrong", f"{says}, but {best:.0%} would if {rival.says}", figures)
    if own >= GOOD:
        return Finding("agreement", "ok", says, figures)
    apart = float(
        np.median([np.linalg.norm(views.poses[i, :3, 3] - views.poses[j, :3, 3]) for i, j in pairs])
    )
    if apart > FARTHEST_M:
        return Finding(
            "agreement",
            "warning",
            f"not told: frames are {apart:.1f} m apart, and {own:.0%} of depth agrees",
            figures,
        )
    hint = "poses, intrinsics and depth do not belong together, or much moves in the scene"
    return Finding("agreement", "wrong" if own < POOR else "warning", f"only {says}: {hint}", figures)


def choose_pairs(poses: F64) -> list[tuple[int, int]]:
    """Positions of frames a step or else a turn apart, spread over the poses `(N, 4, 4)`."""
    for base in BASES_M:
        found = [pair for pair in (_partner(poses, at, base) for at in spread(len(poses), PAIRS)) if pair]
        if len(found) >= PAIRS // 3:
            return found
    return [pair for pair in (_turned(poses, at) for at in spread(len(poses), PAIRS)) if pair]


def agreement(first: F32, second: F32, second_from_first: F64, k: Intrinsics) -> float:
    """Share 0..1 of the points of depth `(h, w)` `first` that agree with what `second` measured, where both see.

    0 where less than a tenth of the points comes to lie in the second image.
    """
    v, u = np.mgrid[: first.shape[0] : _GRID, : first.shape[1] : _GRID]
    z = first[::_GRID, ::_GRID]
    u, v, z = u[z > 0], v[z > 0], z[z > 0].astype(np.float64)
    points = np.stack([(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z])
    x, y, depth = second_from_first[:3, :3] @ points + second_from_first[:3, 3:]
    front = depth > 0.05
    x, y, depth = x[front], y[front], depth[front]
    column = np.clip(np.round(x / depth * k.fx + k.cx), -1, k.width).astype(np.int64)
    row = np.clip(np.round(y / depth * k.fy + k.cy), -1, k.height).astype(np.int64)
    inside = (column >= 0) & (column < k.width) & (row >= 0) & (row < k.height)
    seen = second[row[inside], column[inside]].astype(np.float64)
    there = seen > 0
    if there.sum() < max(1, _LEAST_SHARE * len(z)):
        return 0.0
    error = np.abs(depth[inside] - seen)[there]
    return float((error < TOLERANCE * seen[there] + FLOOR_M).mean())


def _rivals(scale: float) -> list[Rival]:
    flip = np.diag(OPENGL_FROM_OPENCV)
    scales = [
        Rival(f"depth had {known:g} units a metre (--option depth_scale={known:g})", depth=scale / known)
        for known in KNOWN_SCALES
        if abs(known / scale - 1) > 0.02
    ]
    return [
        *scales,
        Rival("the camera's axes were OpenGL's (x right, y up, z back)", lambda pose: pose @ flip),
        Rival("the poses were camera_from_world", _inverse),
        Rival("the poses were camera_from_world of an OpenGL camera", lambda pose: _inverse(pose) @ flip),
        Rival("the camera's axes were a robot's (x forward, y left, z up)", lambda pose: pose @ _OPTICAL),
        Rival("quaternions were in the order qw qx qy qz", _reordered),
        Rival("poses were in millimetres", _shrunk),
        *(Rival(f"the focal length were {f:g} times as long", focal=f) for f in (0.5, 0.75, 4 / 3, 2.0)),
        *(Rival(f"depth had the pose of the frame {_away(shift)}", shift=shift) for shift in SHIFTS),
    ]


_OPTICAL = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)


def _inverse(pose: F64) -> F64:
    return np.asarray(np.linalg.inv(pose), np.float64)


def _away(shift: int) -> str:
    return f"{abs(shift)} {'later' if shift > 0 else 'earlier'}"


def _shrunk(pose: F64) -> F64:
    moved = pose.copy()
    moved[:3, 3] /= 1000
    return moved


def _reordered(pose: F64) -> F64:
    """The pose whose quaternion was read as x, y, z, w though the file had w first."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(pose[:3, :3]).as_quat()
    return pose_of_quaternion(np.array([*pose[:3, 3], y, z, w, x]))


def _score(views: Views, pairs: Sequence[tuple[int, int]], rival: Rival) -> float:
    """Mean agreement over the pairs that it can be told for."""
    k = replace(views.k, fx=views.k.fx * rival.focal, fy=views.k.fy * rival.focal)
    scores = []
    for i, j in pairs:
        first, second = views.at(i), views.at(j)
        if (
            first is None
            or second is None
            or not 0 <= min(i, j) + rival.shift <= max(i, j) + rival.shift < len(views)
        ):
            continue
        from_pose, to_pose = (rival.pose(views.poses[at + rival.shift]) for at in (i, j))
        between = np.linalg.inv(to_pose) @ from_pose
        scores.append(agreement(first.metres * rival.depth, second.metres * rival.depth, between, k))
    return float(np.mean(scores)) if len(scores) >= max(2, len(pairs) // 2) else 0.0


def _partner(poses: F64, at: int, base: float) -> tuple[int, int] | None:
    """`at` and the first frame after it that is `base` metres away, where it looks about the same way."""
    moved = np.linalg.norm(poses[at + 1 :, :3, 3] - poses[at, :3, 3], axis=1) > base
    if not moved.any():
        return None
    other = at + 1 + int(moved.argmax())
    return (at, other) if turns(poses[other, :3, :3], poses[at, :3, :3]) < MOST_TURN else None


def _turned(poses: F64, at: int) -> tuple[int, int] | None:
    turned = turns(poses[at + 1 :, :3, :3], poses[at, :3, :3])
    found = np.flatnonzero((turned > LEAST_TURN) & (turned < MOST_TURN))
    return (at, at + 1 + int(found[0])) if found.size else None
