"""Prepared meshes on disk, by a key of what they were made from."""

from __future__ import annotations

import os
import tempfile
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from lab.simulation.home import Material, Mesh


class MeshCache:
    """`folder/KEY.npz` for each mesh. A file that cannot be read is made anew; where none can be written, none is."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def get(self, key: str, make: Callable[[], Mesh]) -> Mesh:
        """The mesh of a key; made, and kept, where it is not there."""
        path = self._folder / f"{key}.npz"
        found = _read(path)
        if found is None:
            found = make()
            with suppress(OSError):  # a full or read-only disk costs time later, not the home now
                _write(path, found)
        return found


def _read(path: Path) -> Mesh | None:
    try:
        with np.load(path) as held:
            return Mesh(
                vertices=held["vertices"],
                triangles=held["triangles"],
                normals=held["normals"],
                uv=held["uv"],
                material_ids=held["material_ids"],
                materials=tuple(
                    Material(color, held.get(f"texture{i}")) for i, color in enumerate(held["colors"])
                ),
                object_ids=np.zeros(len(held["triangles"]), np.uint16),
            )
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None


def _write(path: Path, mesh: Mesh) -> None:
    """Beside its place first, then moved there, so that a reader never sees half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    arrays: dict[str, Any] = {
        "vertices": mesh.vertices,
        "triangles": mesh.triangles,
        "normals": mesh.normals,
        "uv": mesh.uv,
        "material_ids": mesh.material_ids,
        "colors": np.stack([m.color for m in mesh.materials]),
    }
    arrays |= {f"texture{i}": m.texture for i, m in enumerate(mesh.materials) if m.texture is not None}
    handle, half = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, **arrays)
        Path(half).replace(path)
    except OSError:
        Path(half).unlink(missing_ok=True)
        raise
