"""A camera in a home: shaded colour, z-depth and instance ids by casting rays at its mesh (needs Open3D)."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from lab.simulation.home import Home, Mesh
from lab.simulation.lights import home_lights
from lab.simulation.raycaster import Hits, RayCaster
from lab.simulation.rendering import Rendering
from lab.simulation.shading import Shading, ShadingParams, Surface, developed, linear_albedo
from lab.simulation.textures import TextureAtlas
from ovip.scene.types import F32, F64, U8, U16, Bools, Intrinsics

_SKY = np.array([176, 200, 226], dtype=np.uint8)
_GLOW = {"window": 0.5, "lamp": 0.4, "chandelier": 0.3, "television": 0.12, "tv": 0.12, "monitor": 0.12}


@dataclass(frozen=True, slots=True)
class RenderParams:
    """supersample: colour is rendered at so many times the resolution each way, and averaged."""

    supersample: int = 1
    shading: ShadingParams = field(default_factory=ShadingParams)


class Renderer:
    """Renders one home through one camera; poses are world_from_camera `(4, 4)`."""

    def __init__(self, home: Home, intrinsics: Intrinsics, params: RenderParams | None = None) -> None:
        self.intrinsics = intrinsics
        self._params = params or RenderParams()
        self._caster = RayCaster(home.mesh)
        self._rays = _rays(intrinsics, 1)
        self._fine = _rays(intrinsics, self._params.supersample)
        self._ids = np.append(home.mesh.object_ids, np.uint16(0)).astype(np.uint16)
        self._table = _table(home.mesh)
        self._material = np.append(home.mesh.material_ids, 0).astype(np.int32)
        self._atlas = TextureAtlas.of(home.mesh.materials)
        self._detail = _detail(home.mesh, self._atlas)
        self._glow = _glow(home)
        self._shading = Shading(self._caster, home_lights(home, self._ceiling_above), self._params.shading)

    def render(self, pose: F64) -> Rendering:
        """Colour, depth and ids; depth and ids are those of the pixels' centres."""
        seen = self._cast(self._rays, pose)
        fine = seen if self._params.supersample == 1 else self._cast(self._fine, pose)
        return Rendering(self._colors(*fine, pose), *self._depth_and_ids(seen[1]))

    def depth_and_ids(self, pose: F64) -> tuple[F32, U16]:
        """z-depth `(H, W)` float32 metres and object ids `(H, W)` uint16, 0 = nothing."""
        return self._depth_and_ids(self._cast(self._rays, pose)[1])

    def _depth_and_ids(self, hits: Hits) -> tuple[F32, U16]:
        depth = np.where(np.isfinite(hits.distance), hits.distance, np.float32(0))
        return depth, self._ids.take(hits.triangle)

    def _cast(self, rays: F32, pose: F64) -> tuple[F32, Hits]:
        """Directions `(H, W, 3)` in the world, and what they hit at which z-depth."""
        directions = np.asarray(cv2.transform(rays, np.asarray(pose[:3, :3], np.float32)), np.float32)
        bundle = np.empty((*rays.shape[:2], 6), dtype=np.float32)
        bundle[..., :3] = pose[:3, 3]
        bundle[..., 3:] = directions
        return directions, self._caster.first_hits(bundle)

    def _colors(self, directions: F32, hits: Hits, pose: F64) -> U8:
        missed: Bools = hits.triangle == len(self._ids) - 1
        distance = np.where(missed, np.float32(100), hits.distance)
        rows = self._table.take(hits.triangle, axis=0)
        a, b = hits.uv[..., 0], hits.uv[..., 1]
        surface = _surface(directions, hits, rows, distance, pose)
        u, v = (rows[..., i] + a * rows[..., i + 2] + b * rows[..., i + 4] for i in (0, 1))
        facing = np.abs(sum(surface.faces[i] * directions[..., i] for i in range(3)))
        footprint = (
            self._detail.take(hits.triangle) * distance / np.sqrt(np.maximum(facing, np.float32(0.05)))
        )
        footprint *= np.float32(1 / (self.intrinsics.fx * self._params.supersample))
        srgb = self._atlas.colors(self._material.take(hits.triangle), u, v, footprint)
        light = self._shading.light(surface) + self._glow.take(hits.triangle)[..., None]
        rgb = developed(self._shading.exposed(linear_albedo(srgb) * light))
        rgb[missed] = _SKY
        size = (self.intrinsics.width, self.intrinsics.height)
        return (
            rgb
            if rgb.shape[1] == size[0]
            else np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA))
        )

    def _ceiling_above(self, points: F64) -> F64:
        up = np.broadcast_to([0.0, 0.0, 1.0], points.shape)
        distance = self._caster.first_hits(np.concatenate([points, up], axis=1).astype(np.float32)).distance
        return np.asarray(points[:, 2] + distance, dtype=np.float64)


def _rays(k: Intrinsics, times: int) -> F32:
    """Directions `(H, W, 3)` in camera axes with z = 1, so that distance along them is z-depth."""
    v, u = np.mgrid[: k.height * times, : k.width * times]
    u, v = (u + 0.5) / times - 0.5, (v + 0.5) / times - 0.5
    return np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=2).astype(np.float32)


def _table(mesh: Mesh) -> F32:
    """A row a triangle and one for none: first corner's uv and normal, and their way to the other corners.

    `(T + 1, 16)`: u, v, du1, dv1, du2, dv2, n, dn1, dn2, 0.
    """
    table = np.zeros((len(mesh.triangles) + 1, 16), dtype=np.float32)
    for first, corners in ((0, mesh.uv), (6, mesh.normals)):
        width = corners.shape[2]
        table[:-1, first : first + width] = corners[:, 0]
        table[:-1, first + width : first + 2 * width] = corners[:, 1] - corners[:, 0]
        table[:-1, first + 2 * width : first + 3 * width] = corners[:, 2] - corners[:, 0]
    table[-1, 8] = 1.0
    return table


def _surface(directions: F32, hits: Hits, rows: F32, distance: F32, pose: F64) -> Surface:
    a, b = hits.uv[..., 0], hits.uv[..., 1]
    planes = cv2.split(directions)
    points = np.stack([np.float32(o) + d * distance for o, d in zip(pose[:3, 3], planes, strict=True)])
    faces = np.stack(cv2.split(hits.faces))
    towards = np.where((faces * np.stack(planes)).sum(axis=0) > 0, np.float32(-1), np.float32(1))
    faces *= towards
    smooth = np.stack([rows[..., 6 + i] + a * rows[..., 9 + i] + b * rows[..., 12 + i] for i in range(3)])
    length = np.sqrt((smooth**2).sum(axis=0))
    aligned = np.where((smooth * faces).sum(axis=0) < 0, np.float32(-1), np.float32(1))
    normals = np.where(length > 0.1, smooth * (aligned / np.maximum(length, np.float32(1e-6))), faces)
    return Surface(points, normals.astype(np.float32), faces)


def _detail(mesh: Mesh, atlas: TextureAtlas) -> F32:
    """Texture pixels a metre of each triangle `(T + 1,)`."""
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    e, f = mesh.uv[:, 1] - mesh.uv[:, 0], mesh.uv[:, 2] - mesh.uv[:, 0]
    on_texture = np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])
    density = np.sqrt(on_texture / np.maximum(area, 1e-12)) * atlas.sizes[mesh.material_ids]
    return np.append(density, 0.0).astype(np.float32)


def _glow(home: Home) -> F32:
    """Light that a triangle's own object gives off, in units of paper-white light `(T + 1,)`."""
    most = max((thing.object_id for thing in home.objects), default=0)
    glow = np.zeros(max(most, int(home.mesh.object_ids.max(initial=0))) + 1, dtype=np.float32)
    for thing in home.objects:
        glow[thing.object_id] = max(
            (g for word, g in _GLOW.items() if thing.label.endswith(word)), default=0.0
        )
    return np.append(glow[home.mesh.object_ids], np.float32(0))
