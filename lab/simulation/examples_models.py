"""The furniture of an example home: its models, coloured, sized, turned and placed."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

import numpy as np

from lab.simulation.catalogue.config import cache_folder
from lab.simulation.catalogue.mesh_cache import MeshCache
from lab.simulation.catalogue.model import fitted, mesh_bounds
from lab.simulation.catalogue.simplifying import simplified
from lab.simulation.catalogue.sweet_home import rotated, triangle_budget, upright
from lab.simulation.catalogue.wavefront import read_wavefront
from lab.simulation.examples_plan import Piece
from lab.simulation.examples_words import NAMED_MATERIALS
from lab.simulation.home import Material, Mesh
from ovip.errors import NotConfigured
from ovip.scene.types import F64

RESOURCES = "com/eteks/sweethome3d/io/resources/"
"""Where models lie in Sweet Home 3D's archive; here they lie in `resources`."""
PREPARATION = 1
"""Part of every cache key; counted up when meshes come out otherwise than before."""


class PieceModels:
    """Meshes of pieces from the models in a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._cache = MeshCache(cache_folder() / "examples")

    def placed(self, piece: Piece, z: float) -> Mesh:
        """A piece's mesh where it stands on a level whose floor is at `z` metres."""
        mesh = self._shaped(piece)
        if piece.mirrored:
            mesh = _mirrored(mesh)
        mesh = fitted(mesh, piece.size)
        if piece.pitch or piece.roll:
            mesh = _recentred(rotated(mesh, _about_x(-piece.pitch) @ _about_y(piece.roll)))
        mesh = rotated(mesh, _about_z(piece.yaw))
        return replace(
            mesh, vertices=mesh.vertices + (piece.position + np.array([0, 0, z])).astype(np.float32)
        )

    def _shaped(self, piece: Piece) -> Mesh:
        """The model upright, simplified, in the piece's colours."""
        path = self._folder / piece.model.replace(RESOURCES, "resources/")
        if not path.is_file():
            raise NotConfigured(
                f"the model {path} is missing; scripts/lab.sh brings the example homes and their models"
            )
        text = path.read_bytes()
        colors = sorted((name, color.tolist()) for name, color in piece.colors.items())
        paint = None if piece.color is None else piece.color.tolist()
        made_of = (
            PREPARATION,
            hashlib.sha256(text).hexdigest(),
            colors,
            paint,
            piece.rotation,
            max(piece.size),
        )
        key = hashlib.sha256(repr(made_of).encode()).hexdigest()[:32]
        return self._cache.get(key, lambda: _prepared(piece, path, text.decode("latin-1")))


def _prepared(piece: Piece, path: Path, text: str) -> Mesh:
    def beside(name: str) -> bytes | None:
        found = path.parent / name
        return found.read_bytes() if found.is_file() else None

    known = {**NAMED_MATERIALS, **{name: Material(color) for name, color in piece.colors.items()}}
    mesh = read_wavefront(text, beside, known)
    if piece.color is not None:
        mesh = replace(mesh, materials=tuple(Material(piece.color) for _ in mesh.materials))
    return simplified(upright(mesh, piece.rotation), triangle_budget(piece.size))


def _mirrored(mesh: Mesh) -> Mesh:
    flip = np.array([-1, 1, 1], np.float32)
    return replace(
        mesh,
        vertices=mesh.vertices * flip,
        triangles=np.ascontiguousarray(mesh.triangles[:, ::-1]),
        normals=np.ascontiguousarray((mesh.normals * flip)[:, ::-1]),
        uv=np.ascontiguousarray(mesh.uv[:, ::-1]),
    )


def _recentred(mesh: Mesh) -> Mesh:
    low, high = mesh_bounds(mesh)
    foot = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    return replace(mesh, vertices=(mesh.vertices - foot).astype(np.float32))


def _about_x(angle: float) -> F64:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def _about_y(angle: float) -> F64:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def _about_z(angle: float) -> F64:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
