"""A mesh in another colour or pattern: how alike instances are made to differ by an attribute."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lab.simulation.catalogue.model import mesh_bounds
from lab.simulation.catalogue.palette import COLORS, is_pattern, material
from lab.simulation.home import Material, Mesh, triangle_areas
from ovip.errors import InvalidInput
from ovip.scene.types import F32, U8, Bools

MAIN_SHARE = 0.6
"""Of a mesh's surface that its main materials cover at least."""
TEXTURE_TINT = 0.35
"""How much of a texture's light and dark stays when it is tinted."""


def main_materials(mesh: Mesh) -> tuple[int, ...]:
    """The materials that cover most of a mesh, widest first, until they have `MAIN_SHARE` of it."""
    areas = np.bincount(mesh.material_ids, triangle_areas(mesh), minlength=len(mesh.materials))
    widest = np.argsort(-areas, kind="stable")
    before = np.concatenate([[0.0], np.cumsum(areas[widest])[:-1]])
    return tuple(int(i) for i in widest[before < MAIN_SHARE * areas.sum()])


def dressed(mesh: Mesh, main: tuple[int, ...], attribute: str) -> Mesh:
    """The mesh with its main materials in a colour or a pattern. InvalidInput for an unknown word."""
    if attribute in COLORS:
        return _painted(mesh, main, np.array(COLORS[attribute], np.float64))
    if not is_pattern(attribute):
        raise InvalidInput(f"expected a colour of {sorted(COLORS)} or a pattern, not {attribute!r}")
    chosen = np.isin(mesh.material_ids, main)
    cloth = material(attribute)
    materials = tuple(cloth if i in main else m for i, m in enumerate(mesh.materials))
    return replace(mesh, uv=_laid_over(mesh, chosen), materials=materials)


def _painted(
    mesh: Mesh, main: tuple[int, ...], color: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> Mesh:
    tones = {i: float(_tone(mesh.materials[i])) for i in main}
    middle = float(np.mean(list(tones.values())))
    materials = list(mesh.materials)
    for i, tone in tones.items():
        paint = color * np.clip(1 + 0.4 * (tone - middle) / 255, 0.8, 1.15)
        materials[i] = _tinted(materials[i], paint)
    return replace(mesh, materials=tuple(materials))


def _tinted(old: Material, color: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Material:
    flat = np.clip(color, 0, 255).astype(np.uint8)
    if old.texture is None:
        return Material(flat)
    light = old.texture.mean(axis=2, keepdims=True)
    relief = 1 + TEXTURE_TINT * (light - light.mean()) / max(float(light.mean()), 24.0)
    texture: U8 = np.clip(color * relief, 0, 255).astype(np.uint8)
    return Material(flat, texture)


def _tone(material: Material) -> float:
    source = material.color if material.texture is None else material.texture
    return float(source.mean())


def _laid_over(mesh: Mesh, chosen: Bools) -> F32:
    """uv of a picture laid over the chosen triangles from the side each looks to, a few times across the mesh."""
    low, high = mesh_bounds(mesh)
    width = float(np.clip((high - low).max() / 2.5, 0.07, 0.45))
    corners = (mesh.vertices[mesh.triangles[chosen]] - low) / width
    faces = np.abs(mesh.normals[chosen].mean(axis=1)).argmax(axis=1)
    axes = np.array([[1, 2], [0, 2], [0, 1]])[faces]
    uv = mesh.uv.copy()
    uv[chosen] = np.take_along_axis(corners, np.broadcast_to(axes[:, None, :], (len(axes), 3, 2)), axis=2)
    return uv
