"""Whether colour and depth are of one moment and one camera: do their edges lie on each other.

Edges of grey and jumps of depth are correlated, in stretches where the camera moves most: between frames some
steps apart (which finds images out of step), and at shifts of some pixels (which finds depth that is not
registered to colour).
"""

from __future__ import annotations

from collections import defaultdict

import cv2
import numpy as np

from ovip.recordings.inspection.finding import Figures, Finding
from ovip.recordings.inspection.views import View, Views, turns
from ovip.scene.types import F32, F64

STRETCHES, LENGTH, REACH = 6, 9, 6
LEAST_FRAMES, LEAST_PER_SHIFT = 5, 6
FARTHEST_SHIFT = 0.04
REGISTERED = 0.012
"""Shares of the image's width: shifts that are tried, and shifts that do not matter."""
LEAD = 1.15
FAINT = 0.03
DEPTH_JUMP = 0.05


def check_registration(views: Views) -> Finding:
    """Whether edges of colour and of depth lie on each other, in time and in the image."""
    by_step: defaultdict[int, list[float]] = defaultdict(list)
    by_shift = np.zeros((views.k.height, views.k.width))
    for start in busiest(views.poses):
        seen = views.all_at(range(start, min(start + LENGTH, len(views))))
        edges = [(at, color_edges(view), depth_edges(view)) for at, view in seen]
        for at, color, _ in edges:
            for other, _, depth in edges:
                if abs(other - at) <= REACH:
                    by_step[other - at].append(float((color * depth).mean()))
        for _, color, depth in edges:
            by_shift += _shifted(color, depth)
    if len(by_step[0]) < LEAST_FRAMES:
        return Finding(
            "registration", "warning", f"not checked: expected {LEAST_FRAMES} frames or more to tell"
        )
    steps = {step: float(np.mean(v)) for step, v in by_step.items() if len(v) >= LEAST_PER_SHIFT or step == 0}
    return _judge(steps, by_shift / len(by_step[0]), views.step)


def busiest(poses: F64) -> list[int]:
    """Where the stretches of LENGTH frames start that move most in the image; at most STRETCHES, apart."""
    if len(poses) <= LENGTH:
        return [0]
    moved = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1) / 2
    motion = turns(poses[1:, :3, :3], poses[:-1, :3, :3]) + np.degrees(moved)
    # a jump is no motion
    motion = np.where(motion > 45, 0, motion)
    left = np.convolve(motion, np.ones(LENGTH - 1), "valid")
    chosen: list[int] = []
    while len(chosen) < STRETCHES and left.max() >= 0:
        start = int(left.argmax())
        chosen.append(start)
        left[max(0, start - LENGTH + 1) : start + LENGTH] = -1
    return chosen


def color_edges(view: View) -> F32:
    """Strength of grey edges `(h, w)`, mean 0 and deviation 1; the strongest are cut so that none rules."""
    soft = cv2.GaussianBlur(view.gray, (0, 0), 1.0).astype(np.float32)
    edges = np.hypot(cv2.Sobel(soft, cv2.CV_32F, 1, 0), cv2.Sobel(soft, cv2.CV_32F, 0, 1))
    return _standard(np.minimum(edges, np.quantile(edges, 0.95)))


def depth_edges(view: View) -> F32:
    """Where depth jumps by 5 % `(h, w)`, away from where it is missing; mean 0 and deviation 1."""
    cross = np.ones((3, 3), np.uint8)
    there = cv2.erode((view.metres > 0).astype(np.uint8), cross) > 0
    logarithm = np.log(np.maximum(view.metres, 0.01))
    jumps = (cv2.dilate(logarithm, cross) - cv2.erode(logarithm, cross) > DEPTH_JUMP) & there
    return _standard(jumps.astype(np.float32))


def _standard(edges: F32) -> F32:
    soft = cv2.GaussianBlur(edges, (0, 0), 1.0)
    return np.asarray((soft - soft.mean()) / (soft.std() + 1e-9), np.float32)


def _shifted(color: F32, depth: F32) -> F64:
    """Correlation at every shift `(h, w)`: entry (dy, dx) moves depth down by dy and right by dx, cyclic."""
    spectrum = np.fft.rfft2(color) * np.conj(np.fft.rfft2(depth))
    return np.asarray(np.fft.irfft2(spectrum, s=color.shape) / color.size)


def _judge(steps: dict[int, float], shifted: F64, grid: int) -> Finding:
    own = steps[0]
    step = max(steps, key=lambda at: steps[at])
    dx, dy, best = _best_shift(shifted)
    pixels = float(np.hypot(dx, dy)) * grid
    figures: Figures = {
        "correlation": own,
        "best_step": step,
        "best_step_correlation": steps[step],
        "best_shift_px": [float(dx * grid), float(dy * grid)],
        "best_shift_correlation": best,
    }
    if step != 0 and steps[step] > LEAD * max(own, FAINT):
        when = "later" if step > 0 else "earlier"
        says = f"colour and depth are out of step: depth of {abs(step)} frames {when} fits the colour better"
        return Finding("registration", "wrong", says, figures)
    if max(own, best) < FAINT:
        return Finding(
            "registration", "warning", "not told: edges of colour and depth have little in common", figures
        )
    if pixels > REGISTERED * shifted.shape[1] * grid and best > LEAD * own:
        says = f"depth does not lie on colour: it fits better moved by ({dx * grid}, {dy * grid}) pixels"
        return Finding("registration", "warning", f"{says}; is it registered?", figures)
    return Finding("registration", "ok", "edges of colour and depth lie on each other", figures)


def _best_shift(shifted: F64) -> tuple[int, int, float]:
    """dx, dy (in pixels of the grid) and value of the best correlation within the farthest shift."""
    reach = max(1, round(FARTHEST_SHIFT * shifted.shape[1]))
    window = np.roll(shifted, (reach, reach), axis=(0, 1))[: 2 * reach + 1, : 2 * reach + 1]
    row, column = np.unravel_index(int(window.argmax()), window.shape)
    return int(column) - reach, int(row) - reach, float(window[row, column])
