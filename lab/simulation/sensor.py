"""What a real RGB-D camera makes of a perfect picture: noise, lost returns, blur, and a pose that drifts.

Depth noise: Nguyen, Izadi and Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking",
3DIMPVT 2012: axial sigma(z) = 0.0012 + 0.0019 (z - 0.4)^2 metres, lateral 0.8 pixels. Lost returns follow the
same cameras' known blind spots: slanted, dark and glossy surfaces, depth edges (a fifth of the pixels of
real Kinect recordings of rooms have none). Drift and light are chosen to be those of a good tracker and a webcam.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ovip.scene.types import F32, F64, U8, Bools, Intrinsics

_DARK = 22  # brightness (0..255) under which infrared is mostly swallowed
_EDGE = 0.04  # relative depth step between neighbours that makes an edge
_DRIFT, _FRAME = 1, 2  # streams of randomness


@dataclass(frozen=True, slots=True)
class SensorParams:
    """Each at zero is switched off; all at zero (`NO_NOISE`) gives back what went in.

    axial: base and square term of the depth noise, metres and 1/metre. lateral: pixels by which a return strays.
    grazing: degrees from the surface's normal beyond which nothing returns. edge_loss, dark_loss: share lost at
    depth edges, on dark surfaces. nearest, farthest: range in metres. step: metres to which depth is rounded.
    drift_position (metres), drift_turn (radians): spread of the pose's error per axis, a random walk that loop
    closures pull back over about `drift_frames` frames. blur: share of the motion between two frames during
    which the shutter is open. gain: spread of the exposure. grain: of each pixel, in units of 255.
    """

    axial: tuple[float, float] = (0.0012, 0.0019)
    lateral: float = 0.8
    grazing: float = 80.0
    edge_loss: float = 0.5
    dark_loss: float = 0.4
    nearest: float = 0.3
    farthest: float = 5.0
    step: float = 0.001
    drift_position: float = 0.01
    drift_turn: float = 0.004
    drift_frames: float = 60.0
    blur: float = 0.03
    gain: float = 0.03
    grain: float = 1.5


NO_NOISE = SensorParams(
    axial=(0.0, 0.0),
    lateral=0.0,
    grazing=0.0,
    edge_loss=0.0,
    dark_loss=0.0,
    nearest=0.0,
    farthest=0.0,
    step=0.0,
    drift_position=0.0,
    drift_turn=0.0,
    drift_frames=0.0,
    blur=0.0,
    gain=0.0,
    grain=0.0,
)


class Sensor:
    """One camera's noise; the same seed and frame index give the same noise, in whatever order they are asked."""

    def __init__(self, intrinsics: Intrinsics, params: SensorParams | None = None, seed: int = 0) -> None:
        self._k = intrinsics
        self._params = params or SensorParams()
        self._seed = seed
        self._walked: F64 = np.zeros((0, 6))

    def observe(
        self, rgb: U8, depth: F32, pose: F64, index: int, before: F64 | None = None
    ) -> tuple[U8, F32, F64]:
        """Noisy `(H, W, 3)` colour, `(H, W)` depth and world_from_camera `(4, 4)` of frame `index`.

        before: the true pose of the frame before, for motion blur; None for a camera at rest.
        """
        rng = np.random.default_rng([self._seed, _FRAME, index])
        return (
            self._seen(rgb, depth, pose, before, rng),
            self._measured(rgb, depth, rng),
            self._tracked(pose, index),
        )

    def _seen(self, rgb: U8, depth: F32, pose: F64, before: F64 | None, rng: np.random.Generator) -> U8:
        p = self._params
        if p.blur and before is not None:
            rgb = _smeared(rgb, p.blur * _flow(depth, pose, before, self._k))
        if not (p.gain or p.grain):
            return rgb
        light = rgb * np.float32(1 + p.gain * rng.standard_normal())
        light += np.float32(p.grain) * rng.standard_normal(rgb.shape, dtype=np.float32)
        return np.asarray(np.clip(light + np.float32(0.5), 0, 255), dtype=np.uint8)

    def _measured(self, rgb: U8, depth: F32, rng: np.random.Generator) -> F32:
        p = self._params
        lost = _lost(rgb, depth, self._k, p, rng)
        measured = _strayed(depth, p.lateral, rng)
        if any(p.axial):
            sigma = np.float32(p.axial[0]) + np.float32(p.axial[1]) * (measured - np.float32(0.4)) ** 2
            noise = sigma * rng.standard_normal(depth.shape, dtype=np.float32)
            measured = np.where(measured > 0, np.maximum(measured + noise, 0), 0).astype(np.float32)
        if p.step:
            measured = np.round(measured / np.float32(p.step)) * np.float32(p.step)
        return np.where(lost, np.float32(0), measured)

    def _tracked(self, pose: F64, index: int) -> F64:
        p = self._params
        if not (p.drift_position or p.drift_turn):
            return pose
        error = self._drift(index)
        turn, _ = cv2.Rodrigues(p.drift_turn * error[3:])
        tracked: F64 = pose.copy()
        tracked[:3, :3] = turn @ pose[:3, :3]
        tracked[:3, 3] += p.drift_position * error[:3]
        return tracked

    def _drift(self, index: int) -> F64:
        """Error of frame `index` in units of its spread `(6,)`: x_i = a x_(i-1) + sqrt(1 - a^2) n_i, x_(-1) = 0."""
        if index >= len(self._walked):
            steps = np.random.default_rng([self._seed, _DRIFT]).standard_normal((index + 256, 6))
            keep = np.exp(-1 / self._params.drift_frames) if self._params.drift_frames else 0.0
            error, walked = np.zeros(6), np.empty_like(steps)
            for number, step in enumerate(steps):
                error = keep * error + np.sqrt(1 - keep**2) * step
                walked[number] = error
            self._walked = walked
        return np.asarray(self._walked[index])


def _lost(rgb: U8, depth: F32, k: Intrinsics, p: SensorParams, rng: np.random.Generator) -> Bools:
    """Where nothing comes back `(H, W)`."""
    lost = depth <= 0
    if p.nearest:
        lost |= depth < p.nearest
    if p.farthest:
        lost |= depth > p.farthest
    if p.grazing:
        lost |= _slant(depth, k) < np.cos(np.radians(p.grazing))
    if p.edge_loss:
        step = cv2.dilate(depth, np.ones((3, 3))) - cv2.erode(depth, np.ones((3, 3)))
        lost |= (step > _EDGE * depth) & (rng.random(depth.shape, dtype=np.float32) < p.edge_loss)
    if p.dark_loss:
        dark = rgb.max(axis=2) < _DARK
        lost |= dark & (rng.random(depth.shape, dtype=np.float32) < p.dark_loss)
    return np.asarray(lost)


def _slant(depth: F32, k: Intrinsics) -> F32:
    """Cosine between each pixel's ray and its surface's normal `(H, W)`, from the depth image itself.

    A depth edge counts by its smoother side, so that a thing's border is not taken for a slanted surface.
    """
    slope = []
    for axis, focal in ((1, k.fx), (0, k.fy)):
        ahead = np.diff(depth, axis=axis, append=np.take(depth, [-1], axis=axis))
        behind = np.roll(ahead, 1, axis=axis)
        gentle = np.where(np.abs(ahead) < np.abs(behind), ahead, behind)
        slope.append(gentle * np.float32(focal) / np.maximum(depth, np.float32(1e-3)))
    v, u = np.mgrid[: k.height, : k.width].astype(np.float32)
    x, y = (u - np.float32(k.cx)) / np.float32(k.fx), (v - np.float32(k.cy)) / np.float32(k.fy)
    # with a, b the slopes of log depth by x, y of the ray (x, y, 1), the normal is (-a, -b, 1 + a x + b y),
    # and its product with the ray is 1
    a, b = slope
    third = 1 + a * x + b * y
    length = np.sqrt(a**2 + b**2 + third**2) * np.sqrt(x**2 + y**2 + 1)
    return np.asarray(1 / length, dtype=np.float32)


def _strayed(depth: F32, lateral: float, rng: np.random.Generator) -> F32:
    """Depth of a pixel nearby for each pixel, by a spread of `lateral` pixels."""
    if not lateral:
        return depth
    height, width = depth.shape
    v, u = np.mgrid[:height, :width]
    dv, du = np.rint(lateral * rng.standard_normal((2, height, width), dtype=np.float32)).astype(np.int64)
    return np.asarray(depth[np.clip(v + dv, 0, height - 1), np.clip(u + du, 0, width - 1)])


def _flow(depth: F32, pose: F64, before: F64, k: Intrinsics) -> F64:
    """How far the picture's middle moved since the frame before `(2,)`, pixels, at the median depth."""
    seen = depth[depth > 0]
    point = np.array([0.0, 0.0, float(np.median(seen)) if seen.size else 3.0, 1.0])
    there = np.linalg.inv(before) @ pose @ point
    if there[2] < 0.1:
        return np.zeros(2)
    return np.asarray(np.array([k.fx, k.fy]) * -there[:2] / there[2])


def _smeared(rgb: U8, way: F64) -> U8:
    """The picture averaged along a straight way `(2,)` of pixels."""
    length = float(np.hypot(*way))
    if length < 0.5:
        return rgb
    size = 2 * int(np.ceil(length / 2)) + 1
    kernel = np.zeros((size, size), dtype=np.float32)
    for at in np.linspace(-0.5, 0.5, 4 * size):
        column, row = np.rint(size // 2 + at * way).astype(int)
        kernel[row, column] += 1
    return np.asarray(cv2.filter2D(rgb, -1, kernel / kernel.sum()), dtype=np.uint8)
