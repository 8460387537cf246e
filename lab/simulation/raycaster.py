"""Rays against a mesh (Open3D): the one place that speaks to it."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from lab.simulation.home import Mesh
from ovip.errors import NotConfigured
from ovip.scene.types import F32, I32, Bools

_MISSED = np.uint32(0xFFFFFFFF)


@dataclass(frozen=True, slots=True, eq=False)
class Hits:
    """What rays `(..., 6)` met first.

    distance: `(...)` in lengths of their direction, infinite for nothing. triangle: `(...)`, the number of triangles
    for nothing. uv: `(..., 2)`, weights of its second and third corner. faces: `(..., 3)` its unit normal.
    """

    distance: F32
    triangle: I32
    uv: F32
    faces: F32


class RayCaster:
    """One mesh to cast rays at. Rays are `(..., 6)` float32: start, direction (its length counts)."""

    def __init__(self, mesh: Mesh) -> None:
        self._o3d = _open3d()
        self._count = len(mesh.triangles)
        self._scene = self._o3d.t.geometry.RaycastingScene()
        self._scene.add_triangles(self._tensor(mesh.vertices), self._tensor(mesh.triangles.astype(np.uint32)))

    def first_hits(self, rays: F32) -> Hits:
        """The nearest triangle along each ray."""
        answer = self._scene.cast_rays(self._tensor(rays))
        triangle = answer["primitive_ids"].numpy()
        triangle[triangle == _MISSED] = self._count
        return Hits(
            distance=answer["t_hit"].numpy(),
            triangle=triangle.view(np.int32),
            uv=answer["primitive_uvs"].numpy(),
            faces=answer["primitive_normals"].numpy(),
        )

    def blocked(self, rays: F32) -> Bools:
        """Whether anything lies within one length of each ray's direction `(...)`."""
        return np.asarray(self._scene.test_occlusions(self._tensor(rays), tnear=0.0, tfar=1.0).numpy())

    def _tensor(self, array: np.ndarray[Any, Any]) -> Any:
        return self._o3d.core.Tensor.from_numpy(np.require(array, requirements=("C", "W")))


def _open3d() -> Any:
    try:
        return importlib.import_module("open3d")
    except ImportError as error:
        raise NotConfigured("rendering a home needs Open3D: pip install 'ovip-sg[lab]'") from error
