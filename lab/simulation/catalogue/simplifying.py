"""Heavy meshes with fewer triangles: vertices of one cell of a grid become one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lab.simulation.catalogue.model import mesh_bounds
from lab.simulation.home import Mesh
from ovip.scene.types import F32, I32

FINEST, COARSEST = 1 / 512, 1 / 12
"""Cells tried, as a share of the mesh's longest side."""


def simplified(mesh: Mesh, budget: int) -> Mesh:
    """The mesh with at most `budget` triangles where clustering can reach that, unchanged if it has no more.

    The grid is the finest that fits the budget. Corners keep their normals and uv, so pictures shift by less than
    a cell. A mesh that is too heavy even on the coarsest grid comes back on that one.
    """
    if len(mesh.triangles) <= budget:
        return mesh
    low, high = mesh_bounds(mesh)
    side = float((high - low).max())
    fine, coarse = np.log(FINEST), np.log(COARSEST)
    best = _clustered(mesh, side * COARSEST)
    for _ in range(8):
        middle = (fine + coarse) / 2
        tried = _clustered(mesh, side * float(np.exp(middle)))
        if len(tried.triangles) > budget:
            fine = middle
        else:
            coarse, best = middle, tried
    return best


def _clustered(mesh: Mesh, cell: float) -> Mesh:
    low, _ = mesh_bounds(mesh)
    places = np.floor((mesh.vertices - low) / cell + 0.5).astype(np.int64)
    _, cluster = np.unique(places, axis=0, return_inverse=True)
    cluster = cluster.reshape(-1)
    vertices = _means(mesh.vertices, cluster)
    triangles = cluster[mesh.triangles].astype(np.int32)
    keep = _distinct(triangles, mesh.material_ids)
    return replace(
        mesh,
        vertices=vertices,
        triangles=triangles[keep],
        normals=mesh.normals[keep],
        uv=mesh.uv[keep],
        material_ids=mesh.material_ids[keep],
        object_ids=mesh.object_ids[keep],
    )


def _means(vertices: F32, cluster: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> F32:
    count = np.bincount(cluster)
    sums = [np.bincount(cluster, vertices[:, axis]) for axis in range(3)]
    return (np.stack(sums, axis=1) / count[:, None]).astype(np.float32)


def _distinct(triangles: I32, materials: I32) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """Rows that are no line, each set of corners once, in their order."""
    a, b, c = triangles.T
    whole = np.flatnonzero((a != b) & (b != c) & (c != a))
    keys = np.column_stack([np.sort(triangles[whole], axis=1), materials[whole]])
    _, first = np.unique(keys, axis=0, return_index=True)
    return whole[np.sort(first)]
