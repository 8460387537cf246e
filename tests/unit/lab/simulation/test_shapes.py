"""Composed shapes: every label, in plausible metres, facing the front."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.simulation.catalogue import Catalogue, open_catalogue
from lab.simulation.catalogue.sculpt import Sculpt
from lab.simulation.home import Mesh, triangle_areas

LABELS = sorted(open_catalogue(Path("nowhere")).labels)


@pytest.fixture(scope="module")
def composed() -> Catalogue:
    return open_catalogue(Path("nowhere"))


def surface_under(mesh: Mesh, x: float, y: float) -> list[float]:
    """Heights at which the vertical through a point meets faces that look up."""
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    a, b, c = (corners[:, i, :2] - (x, y) for i in range(3))

    def turn(p: np.ndarray, q: np.ndarray) -> np.ndarray:
        return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]

    weights = np.stack([turn(b, c), turn(c, a), turn(a, b)], axis=1)
    whole = weights.sum(axis=1)
    hit = (np.abs(whole) > 1e-12) & ((weights >= 0).all(axis=1) | (weights <= 0).all(axis=1))
    up = mesh.normals.mean(axis=1)[:, 2] > 0.5
    shares = weights[hit & up] / whole[hit & up, None]
    return [float(height) for height in (shares * corners[hit & up, :, 2]).sum(axis=1)]


@pytest.mark.parametrize("label", LABELS)
def test_a_composed_model_measures_what_its_variant_says_and_stands_on_its_foot(
    composed: Catalogue, label: str
) -> None:
    for variant in composed.variants(label):
        model = composed.build(variant)
        low, high = model.mesh.vertices.min(axis=0), model.mesh.vertices.max(axis=0)
        np.testing.assert_allclose(high - low, variant.size, atol=1e-5)
        np.testing.assert_allclose([low[0] + high[0], low[1] + high[1], low[2]], 0, atol=1e-5)
        assert min(variant.size) > 0.002 and max(variant.size) < 2.6
        assert "Apache-2.0" in model.attribution


@pytest.mark.parametrize("label", LABELS)
def test_a_composed_mesh_is_whole(composed: Catalogue, label: str) -> None:
    mesh = composed.build(composed.variants(label)[0]).mesh
    assert mesh.triangles.min() >= 0 and mesh.triangles.max() < len(mesh.vertices)
    assert mesh.material_ids.max() < len(mesh.materials)
    assert not mesh.object_ids.any()
    assert np.isfinite(mesh.uv).all() and len(mesh.triangles) < 12_000
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=2), 1, atol=1e-3)


@pytest.mark.parametrize("label", LABELS)
def test_what_carries_things_has_a_surface_at_its_top(composed: Catalogue, label: str) -> None:
    for variant in composed.variants(label):
        if variant.top is not None:
            heights = surface_under(
                composed.build(variant).mesh, 0.021 * variant.size[0], -0.05 * variant.size[1]
            )
            assert any(abs(height - variant.top) < 0.03 for height in heights), (variant.name, heights)


@pytest.mark.parametrize("label", ["chair", "sofa", "armchair", "office chair", "bed", "toilet", "laptop"])
def test_the_back_is_behind(composed: Catalogue, label: str) -> None:
    """The upper part of what has a back is at +y, so its front faces -y."""
    mesh = composed.build(composed.variants(label)[0]).mesh
    corners = mesh.vertices[mesh.triangles]
    middles, areas = corners.mean(axis=1), triangle_areas(mesh)
    upper = middles[:, 2] > 0.7 * mesh.vertices[:, 2].max()
    assert np.average(middles[upper, 1], weights=areas[upper]) > -0.01
    lower = ~upper
    assert np.average(middles[upper, 1], weights=areas[upper]) > np.average(
        middles[lower, 1], weights=areas[lower]
    )


def test_equal_requests_give_equal_bits() -> None:
    one, two = (open_catalogue(Path("nowhere")) for _ in range(2))
    for label in ("plant", "towel", "bookshelf"):
        a = one.build(
            one.variants(label)[0], *([one.variants(label)[0].attributes[0]] if label != "plant" else [])
        )
        b = two.build(
            two.variants(label)[0], *([two.variants(label)[0].attributes[0]] if label != "plant" else [])
        )
        assert a.mesh.vertices.tobytes() == b.mesh.vertices.tobytes()
        for m, n in zip(a.mesh.materials, b.mesh.materials, strict=True):
            assert m.color.tobytes() == n.color.tobytes()
            assert (m.texture is None) == (n.texture is None)
            assert m.texture is None or n.texture is None or m.texture.tobytes() == n.texture.tobytes()


def test_a_box_has_the_surface_of_a_box() -> None:
    sculpt = Sculpt("red")
    sculpt.box((1, 2, 3), (2, 3, 4))
    mesh = sculpt.mesh()
    assert triangle_areas(mesh).sum() == pytest.approx(2 * (2 * 3 + 3 * 4 + 4 * 2))
    np.testing.assert_allclose(mesh.vertices.mean(axis=0), (1, 2, 3), atol=1e-6)


@given(st.floats(0.05, 2), st.floats(0.05, 2))
def test_a_cylinder_nears_its_true_surface(radius: float, height: float) -> None:
    sculpt = Sculpt("red")
    sculpt.cylinder((0, 0, 0), radius, height, sides=64)
    true = 2 * np.pi * radius * (radius + height)
    assert triangle_areas(sculpt.mesh()).sum() == pytest.approx(true, rel=0.01)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_faces_of_turned_bodies_look_outward(axis: str) -> None:
    sculpt = Sculpt("red")
    sculpt.cylinder((0, 0, 0), 0.5, 1.0, axis=axis)
    mesh = sculpt.mesh()
    corners = mesh.vertices[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    outward = corners.mean(axis=1) - middle
    assert (np.einsum("ij,ij->i", cross, outward) > 0).all()
    assert (np.einsum("ij,ij->i", mesh.normals.mean(axis=1), outward) > 0).all()
