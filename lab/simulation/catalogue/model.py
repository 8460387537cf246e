"""What a catalogue offers and what it builds: `Variant` and `Model`, and a mesh brought to a size."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from lab.simulation.home import Mesh
from ovip.scene.types import F32, F64

Size = tuple[float, float, float]
"""Width (x), depth (y), height (z) in metres."""


@dataclass(frozen=True, slots=True)
class Variant:
    """One model of a label, not built yet.

    size: what it measures as made. top: height above its foot of the surface that things stand on, None = it
    carries nothing. attributes: what it can be built with ("red", "floral"). elevation: metres above the floor
    where such a thing usually hangs, 0 = it stands on what carries it. name: unique in its catalogue.
    """

    label: str
    name: str
    size: Size
    top: float | None
    attributes: tuple[str, ...] = ()
    elevation: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A built variant in its own frame: x right, y back (its front faces -y), z up, foot at z = 0, centred in x, y.

    mesh: with object ids 0. attribution: who made it, under which licence.
    """

    mesh: Mesh
    size: Size
    top: float | None
    attribution: str


@dataclass(frozen=True, slots=True, eq=False)
class Undressed:
    """A mesh as its maker made it. main: ids of the materials that an attribute changes."""

    mesh: Mesh
    main: tuple[int, ...]
    attribution: str


class Shelf(Protocol):
    """Where a catalogue takes its models from."""

    @property
    def variants(self) -> tuple[Variant, ...]:
        """Everything on it."""
        ...

    def make(self, variant: Variant, size: Size) -> Undressed:
        """One of its variants, built to measure `size`."""
        ...


def mesh_bounds(mesh: Mesh) -> tuple[F64, F64]:
    """Low and high corner `(3,)`, `(3,)` of all vertices."""
    return mesh.vertices.min(axis=0).astype(np.float64), mesh.vertices.max(axis=0).astype(np.float64)


def fitted(mesh: Mesh, size: Size) -> Mesh:
    """The mesh stretched to measure `size`, its foot at z = 0, centred in x and y.

    A mesh that is flat along an axis stays flat there.
    """
    low, high = mesh_bounds(mesh)
    extent = high - low
    flat = extent < 1e-9
    scale = np.where(flat, 1.0, np.asarray(size) / np.where(flat, 1.0, extent))
    foot = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    vertices = ((mesh.vertices - foot) * scale).astype(np.float32)
    return replace(mesh, vertices=vertices, normals=_unit(mesh.normals / scale))


def _unit(vectors: F64) -> F32:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: F32 = (vectors / np.maximum(length, 1e-12)).astype(np.float32)
    return unit
