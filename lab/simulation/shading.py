"""How much light falls on what a camera sees: lamps and windows with soft shadows, sky, and near darkness.

Radiance is linear; a picture is albedo times light, through one fixed film curve. Nothing is random: shadows are
softened by a fixed 4x4 pattern of light positions, averaged over each 4x4 pixels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from lab.simulation.lights import Light
from lab.simulation.raycaster import RayCaster
from ovip.scene.types import F32, U8

_COARSE = 12  # every so many-th pixel votes on which lights matter
_SKIP = 0.35  # metres before a light that hide nothing: its own fixture
_LIFT = 0.004  # metres that shadow rays start off their surface
_DIM = 0.002  # light that needs no shadow
_TABLE = 4096
_BRIGHTEST = 4.0
_MOST_STOPS = 2.5


@dataclass(frozen=True, slots=True)
class ShadingParams:
    """lights: how many of the lights, the strongest in view, are traced, the first `sharp` at full resolution.

    middle: the radiance that the exposure brings the median pixel towards, `adaption` of the way (0: not at all, 1:
    wholly; in stops). sky: light from everywhere, more from above, less from below. occlusion_reach: metres within
    which surfaces take that light away; occlusion_rays: how many directions are asked, at half the resolution.
    """

    lights: int = 4
    sharp: int = 2
    middle: float = 0.32
    adaption: float = 0.6
    sky: tuple[float, float, float] = (0.34, 0.10, 0.02)
    occlusion_reach: float = 0.7
    occlusion_rays: int = 4


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """What rays hit, as `(3, H, W)` float32 planes: points, unit normals (smooth, and true ones `faces`).

    Both normals look towards the camera.
    """

    points: F32
    normals: F32
    faces: F32


class Shading:
    """Lights a surface within a mesh."""

    def __init__(
        self, caster: RayCaster, lights: Sequence[Light], params: ShadingParams | None = None
    ) -> None:
        self._caster = caster
        self._lights = tuple(lights)
        self._params = params or ShadingParams()

    def light(self, surface: Surface) -> F32:
        """Linear RGB light `(H, W, 3)` that falls on the surface."""
        ambient, up, down = self._params.sky
        n_z = surface.normals[2]
        sky = (ambient + up * np.maximum(n_z, 0) - down * n_z) * self._openness(surface)
        total = [sky * np.float32(c) for c in (1.0, 0.985, 0.96)]
        for rank, light in enumerate(self._strongest(surface) if self._lights else ()):
            received = _received(light, surface.points, surface.normals)
            received *= self._unshadowed(light, surface, received, 1 if rank < self._params.sharp else 2)
            for plane, tint in zip(total, light.color, strict=True):
                plane += received * np.float32(tint)
        return np.asarray(cv2.merge(total), dtype=np.float32)

    def exposed(self, linear: F32) -> F32:
        """Linear radiance `(H, W, 3)` as exposed by the camera for this very picture."""
        median = float(np.median(linear[::_COARSE, ::_COARSE, 1]))
        stops = np.clip(np.log2(self._params.middle / max(median, 1e-3)), -_MOST_STOPS, _MOST_STOPS)
        return linear * np.float32(2 ** (self._params.adaption * stops))

    def _strongest(self, surface: Surface) -> list[Light]:
        """The lights that give most to what is seen, by a coarse look with shadows."""
        few = Surface(*(a[:, ::_COARSE, ::_COARSE] for a in (surface.points, surface.normals, surface.faces)))
        received = np.stack([_received(light, few.points, few.normals) for light in self._lights])
        start = np.broadcast_to(
            few.points + np.float32(_LIFT) * few.faces, (len(self._lights), *few.points.shape)
        )
        position = np.array([light.position for light in self._lights], dtype=np.float32)
        way = position[:, :, None, None] - start
        distance = np.sqrt((way**2).sum(axis=1, keepdims=True))
        rays = np.concatenate([start, way * _kept(distance)], axis=1)
        seen = ~self._caster.blocked(np.moveaxis(rays, 1, -1))
        gain = (received * seen).sum(axis=(1, 2), dtype=np.float64)
        order = np.argsort(-gain, kind="stable")[: self._params.lights]
        return [self._lights[i] for i in order if gain[i] > 0]

    def _unshadowed(self, light: Light, surface: Surface, received: F32, every: int) -> F32:
        """Share of the light `(H, W)` that nothing hides, asked of every so many-th pixel each way."""
        height, width = received.shape
        few = Surface(*(a[:, ::every, ::every] for a in (surface.points, surface.normals, surface.faces)))
        h, w = few.points.shape[1:]
        offset = np.tile(_PATTERN * np.float32(light.radius), (1, h // 4 + 1, w // 4 + 1))
        position = [np.float32(p) + offset[i, :h, :w] for i, p in enumerate(light.position)]
        seen = _averaged(self._visible(position, few, received[::every, ::every]))
        return seen if every == 1 else _enlarged(seen, width, height)

    def _visible(self, position: Sequence[Any], surface: Surface, received: F32) -> F32:
        """1 where nothing lies between the surface and `position`, 0 elsewhere -> `(H, W)`.

        Where nothing would be `received` the way is cut short, which is quicker.
        """
        start = surface.points + np.float32(_LIFT) * surface.faces
        way = [p - s for p, s in zip(position, start, strict=True)]
        distance = np.sqrt(way[0] ** 2 + way[1] ** 2 + way[2] ** 2)
        keep = np.where(received > _DIM, _kept(distance), np.float32(1e-3))
        return 1 - self._hit(start, [w * keep for w in way])

    def _openness(self, surface: Surface) -> F32:
        """Share of the directions above each point in which nothing is near -> `(H, W)`."""
        height, width = surface.points.shape[1:]
        if not self._params.occlusion_rays:
            return np.ones((height, width), dtype=np.float32)
        half = Surface(*(a[:, ::2, ::2] for a in (surface.points, surface.normals, surface.faces)))
        start = half.points + np.float32(_LIFT) * half.faces
        h, w = start.shape[1:]
        blocked = np.zeros((h, w), dtype=np.float32)
        for number in range(self._params.occlusion_rays):
            ball = np.tile(_BALLS[number % len(_BALLS)], (1, h // 4 + 1, w // 4 + 1))[:, :h, :w]
            way = (half.normals + ball[:3]) * (ball[3] * np.float32(self._params.occlusion_reach))
            blocked += self._hit(start, way)
        opened = _averaged((1 - blocked / self._params.occlusion_rays).astype(np.float32))
        return np.asarray(
            cv2.resize(opened, (width, height), interpolation=cv2.INTER_LINEAR), dtype=np.float32
        )

    def _hit(self, start: Sequence[F32] | F32, way: Sequence[F32] | F32) -> F32:
        rays = cv2.merge([*(np.ascontiguousarray(plane) for plane in start), *way])
        return self._caster.blocked(np.asarray(rays, dtype=np.float32)).astype(np.float32)


def developed(linear: F32) -> U8:
    """sRGB `(H, W, 3)` of linear radiance: straight in the darks, rolled off towards white."""
    index = np.clip(linear * np.float32(_TABLE / _BRIGHTEST), 0, _TABLE - 1).astype(np.uint16)
    return np.asarray(_FILM.take(index), dtype=np.uint8)


def linear_albedo(srgb: U8) -> F32:
    """Linear reflectance of sRGB `(H, W, 3)`; nothing reflects more than 0.9."""
    return np.asarray(cv2.LUT(srgb, _LINEAR), dtype=np.float32)


def _received(light: Light, points: F32, normals: F32) -> F32:
    """Light that arrives unhindered `(H, W)`: the cosine law, falling with the square of the distance."""
    way = [np.float32(p) - x for p, x in zip(light.position, points, strict=True)]
    square = way[0] ** 2 + way[1] ** 2 + way[2] ** 2
    cosine = np.maximum(way[0] * normals[0] + way[1] * normals[1] + way[2] * normals[2], 0)
    if light.normal is not None:  # a window sends most light straight in
        out = -(way[0] * np.float32(light.normal[0]) + way[1] * np.float32(light.normal[1]))
        cosine *= np.maximum(out / np.sqrt(square), 0) * 2
    received: F32 = np.float32(light.power) * cosine / (np.sqrt(square) * (square + np.float32(0.8)))
    return received


def _kept(distance: F32) -> F32:
    """Share of the way to a light on which things hide it."""
    return np.asarray(np.maximum(1 - np.float32(_SKIP) / distance, np.float32(0.2)))


def _averaged(plane: F32) -> F32:
    return np.asarray(cv2.blur(plane, (4, 4), borderType=cv2.BORDER_REFLECT_101), dtype=np.float32)


def _enlarged(plane: F32, width: int, height: int) -> F32:
    return np.asarray(cv2.resize(plane, (width, height), interpolation=cv2.INTER_LINEAR), dtype=np.float32)


def _film() -> U8:
    x = np.arange(_TABLE) * (_BRIGHTEST / _TABLE)
    rolled = np.where(x < 0.6, x, 0.6 + 0.4 * np.tanh((x - 0.6) / 0.4 * 0.8))
    srgb = np.where(
        rolled <= 0.0031308, 12.92 * rolled, 1.055 * np.maximum(rolled, 1e-9) ** (1 / 2.4) - 0.055
    )
    return np.asarray(np.clip(srgb * 255 + 0.5, 0, 255), dtype=np.uint8)


def _sphere_pattern(seed: int) -> F32:
    """Points `(3, 4, 4)` on the unit sphere, one a pixel of a 4x4 block, evenly spread and shuffled."""
    i = np.arange(16) + 0.5
    z, angle = 1 - 2 * i / 16, np.pi * (1 + np.sqrt(5)) * i
    points = np.stack([np.sqrt(1 - z**2) * np.cos(angle), np.sqrt(1 - z**2) * np.sin(angle), z])
    shuffled = points[:, np.random.default_rng(seed).permutation(16)]
    return shuffled.reshape(3, 4, 4).astype(np.float32)


def _ball_pattern(seed: int) -> F32:
    """As above, and a length from 0.15 to 1 `(4, 4, 4)`: how far to look."""
    length = np.linspace(0.15, 1, 16)[np.random.default_rng(100 + seed).permutation(16)]
    return np.concatenate([_sphere_pattern(seed), length.reshape(1, 4, 4).astype(np.float32)])


_LINEAR: F32 = (
    0.9
    * np.where(
        np.arange(256) <= 10, np.arange(256) / 255 / 12.92, ((np.arange(256) / 255 + 0.055) / 1.055) ** 2.4
    )
).astype(np.float32)
_FILM = _film()
_PATTERN = _sphere_pattern(0)
_BALLS = tuple(_ball_pattern(seed) for seed in range(1, 9))
