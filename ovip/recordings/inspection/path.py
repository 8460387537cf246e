"""Checks of frames, times and poses: how many, rising, continuous. No image is read."""

from __future__ import annotations

from collections import Counter

import numpy as np

from ovip.recordings.inspection.finding import Finding
from ovip.recordings.inspection.views import turns
from ovip.recordings.recording import Recording
from ovip.scene.types import F64, I64

MOST_SKIPPED = 0.1
JUMP_M, JUMP_TURN, JUMP_TIMES = 0.5, 45.0, 8.0
"""A step is a jump above this many metres (or degrees) and this many times the median step."""
FASTEST = 5.0
STILL_M, STILL_TURN = 0.05, 2.0


def check_frames(recording: Recording) -> Finding:
    """How many frames can be used, and why the others cannot."""
    used, skipped = len(recording), len(recording.skipped)
    k = recording.intrinsics
    says = f"{used} frames of {k.width}x{k.height}"
    figures = {"frames": used, "skipped": skipped}
    if not skipped:
        return Finding("frames", "ok", says, figures)
    reasons = Counter(frame.reason for frame in recording.skipped).most_common(3)
    told = "; ".join(f"{count} because of: {reason}" for reason, count in reasons)
    many = skipped > MOST_SKIPPED * (used + skipped)
    return Finding("frames", "warning" if many else "ok", f"{says}, {skipped} skipped ({told})", figures)


def check_times(times: I64, names: tuple[str, ...]) -> Finding:
    """Whether the timestamps `(N,)` rise, and without holes."""
    steps = np.diff(times) / 1e9
    if len(steps) == 0:
        return Finding("times", "warning", "one frame only", {})
    seconds, middle = float(times[-1] - times[0]) / 1e9, float(np.median(steps))
    figures = {"seconds": seconds, "median_step_s": middle, "largest_step_s": float(steps.max())}
    falls = np.flatnonzero(steps < 0)
    if falls.size:
        return Finding(
            "times", "wrong", f"time falls {falls.size} times, first at {names[falls[0] + 1]}", figures
        )
    same = int((steps == 0).sum())
    if same:
        return Finding("times", "warning", f"{same} frames have the time of the frame before", figures)
    gap = int(steps.argmax())
    if steps[gap] > max(1.0, 10 * middle):
        return Finding("times", "warning", f"a hole of {steps[gap]:.1f} s before {names[gap + 1]}", figures)
    return Finding("times", "ok", f"rising, {seconds:.1f} s, {1 / middle:.1f} frames a second", figures)


def check_path(poses: F64, times: I64, names: tuple[str, ...]) -> Finding:
    """Whether the camera moves, and without jumps; poses `(N, 4, 4)` are rigid (others were skipped)."""
    if len(poses) < 2:
        return Finding("path", "warning", "one pose only: nothing can be told of the camera's way", {})
    steps = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1)
    turned = turns(poses[1:, :3, :3], poses[:-1, :3, :3])
    extent = np.ptp(poses[:, :3, 3], axis=0)
    far, wide = int(steps.argmax()), int(turned.argmax())
    figures: dict[str, float | str | list[float]] = {
        "length_m": float(steps.sum()),
        "extent_m": extent.round(3).tolist(),
        "largest_step_m": float(steps[far]),
        "largest_step_at": names[far + 1],
        "largest_turn_deg": float(turned[wide]),
        "largest_turn_at": names[wide + 1],
    }
    size = " x ".join(f"{side:.1f}" for side in extent)
    says = (
        f"{steps.sum():.1f} m long within {size} m; largest step {steps[far]:.2f} m (at {names[far + 1]}), "
        f"largest turn {turned[wide]:.0f} degrees (at {names[wide + 1]})"
    )
    if extent.max() < STILL_M and turns(poses[:, :3, :3], poses[0, :3, :3]).max() < STILL_TURN:
        return Finding("path", "warning", f"the camera hardly moves: {says}", figures)
    jumps = _jumps(steps, turned)
    if jumps.size:
        told = ", ".join(names[at + 1] for at in jumps[:5]) + (", .." if jumps.size > 5 else "")
        return Finding("path", "warning", f"{jumps.size} jumps, at {told}: {says}", figures)
    speed = float(np.median(steps / np.maximum(np.diff(times) / 1e9, 1e-9)))
    if speed > FASTEST:
        return Finding("path", "warning", f"{speed:.0f} m/s by its times, are they seconds? {says}", figures)
    return Finding("path", "ok", says, figures)


def _jumps(steps: F64, turned: F64) -> I64:
    far = (steps > JUMP_M) & (steps > JUMP_TIMES * np.median(steps))
    wide = (turned > JUMP_TURN) & (turned > JUMP_TIMES * np.median(turned))
    return np.flatnonzero(far | wide)
