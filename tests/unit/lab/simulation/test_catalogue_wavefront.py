"""Wavefront files read into meshes; polygons cut; heavy meshes thinned."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.simulation.catalogue.dressing import dressed, main_materials
from lab.simulation.catalogue.ears import triangulated
from lab.simulation.catalogue.sculpt import Sculpt
from lab.simulation.catalogue.simplifying import simplified
from lab.simulation.catalogue.wavefront import read_wavefront
from lab.simulation.home import Material, polygon_area, triangle_areas
from ovip.errors import InvalidInput

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def nothing(_name: str) -> bytes | None:
    return None


def test_indices_may_count_from_the_end() -> None:
    one = read_wavefront(SQUARE + "f 1 2 3 4\n", nothing)
    two = read_wavefront(SQUARE + "f -4 -3 -2 -1\n", nothing)
    assert one.triangles.tolist() == two.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert triangle_areas(one).sum() == pytest.approx(1)


def test_uv_and_normals_are_taken_per_corner() -> None:
    text = SQUARE + "vt 0 0\nvt 2 0\nvt 2 3\nvn 0 0 5\nf 1/1/1 2/2/1 3/3/1\n"
    mesh = read_wavefront(text, nothing)
    assert mesh.uv.tolist() == [[[0, 0], [2, 0], [2, 3]]]
    assert mesh.normals.tolist() == [[[0, 0, 1]] * 3]


def test_missing_normals_are_smooth_over_a_bend_and_sharp_over_an_edge() -> None:
    def folded(rise: float) -> np.ndarray:
        strip = f"v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 2 0 {rise}\nv 2 1 {rise}\n"
        return read_wavefront(strip + "f 1 3 4 2\nf 3 5 6 4\n", nothing).normals

    gentle, sharp = folded(0.2), folded(3.0)
    assert np.abs(gentle[0, 1] - gentle[0, 0]).max() > 0.01
    np.testing.assert_allclose(sharp[0], [[0, 0, 1]] * 3, atol=1e-6)


def test_a_file_without_faces_is_refused() -> None:
    with pytest.raises(InvalidInput, match="faces"):
        read_wavefront(SQUARE, nothing)


def test_materials_are_read_from_the_library_beside_the_model() -> None:
    picture = np.zeros((4, 2, 4), np.uint8)
    picture[:2] = (0, 0, 255, 255)
    png = cv2.imencode(".png", picture)[1].tobytes()
    mtl = (
        b"newmtl cloth\nKd 1 1 1\nmap_Kd -s 2 2 1 /somewhere/else/My cloth.png\n"
        b"newmtl air\nd 0.0\nnewmtl pane\nKd 0 0 0\nd 0.5\n"
    )
    held = {"a.mtl": mtl, "My cloth.png": png}
    text = "mtllib a.mtl\n" + SQUARE
    for name in ("cloth", "air", "pane", "unheard-of"):
        text += f"usemtl {name}\nf 1 2 3\n"
    mesh = read_wavefront(text, held.get)
    cloth, pane, unknown = mesh.materials
    assert len(mesh.triangles) == 3
    assert cloth.texture is not None and (cloth.texture == (255, 0, 0)).all()
    assert pane.color.tolist() == [103, 109, 110]
    assert unknown.color.tolist() == [200, 200, 200]


def test_known_materials_stand_before_the_files_own() -> None:
    mtl = b"newmtl seat\nKd 1 0 0\n"
    text = "mtllib a.mtl\n" + SQUARE + "usemtl seat\nf 1 2 3\n"
    blue = Material(np.array([0, 0, 255], np.uint8))
    assert read_wavefront(text, {"a.mtl": mtl}.get, {"seat": blue}).materials == (blue,)


@given(st.lists(st.floats(0.3, 1.0), min_size=5, max_size=14), st.integers(0, 2), st.booleans())
def test_a_star_is_cut_into_triangles_of_its_area(radii: list[float], axis: int, backward: bool) -> None:
    angles = np.arange(len(radii)) * 2 * np.pi / len(radii)
    flat = np.stack([np.cos(angles), np.sin(angles)], axis=1) * np.asarray(radii)[:, None]
    flat = flat[::-1] if backward else flat
    ring = np.insert(flat, axis, 0.7, axis=1)
    triangles = triangulated(ring)
    assert len(triangles) == len(radii) - 2
    areas = [polygon_area(flat[list(t)]) for t in triangles]
    assert sum(areas) == pytest.approx(polygon_area(flat), rel=1e-9)


def test_a_heavy_mesh_is_thinned_to_its_budget_and_a_light_one_left() -> None:
    sculpt = Sculpt("red")
    for x in range(8):
        sculpt.soft((x, 0, 0), (1, 1, 1), "main" if x % 2 else "blue")
    mesh = sculpt.mesh()
    assert simplified(mesh, len(mesh.triangles)) is mesh
    thin = simplified(mesh, 1000)
    assert 300 < len(thin.triangles) <= 1000
    assert len(thin.normals) == len(thin.uv) == len(thin.material_ids) == len(thin.triangles)
    assert triangle_areas(thin).sum() == pytest.approx(triangle_areas(mesh).sum(), rel=0.15)
    assert triangle_areas(thin).min() > 0


def test_the_main_materials_cover_most_of_the_surface_widest_first() -> None:
    sculpt = Sculpt("red")
    sculpt.box((0, 0, 0), (1, 1, 1))
    sculpt.box((0, 0, 0), (2, 2, 2), "blue")
    sculpt.box((0, 0, 0), (0.1, 0.1, 0.1), "green")
    assert main_materials(sculpt.mesh()) == (1,)


def test_a_pattern_lies_over_the_main_faces_only() -> None:
    sculpt = Sculpt("red")
    sculpt.box((0, 0, 0), (1, 1, 1))
    sculpt.box((0, 0, 2), (1, 1, 1), "blue")
    mesh = sculpt.mesh()
    floral = dressed(mesh, (0,), "floral")
    other = mesh.material_ids == 1
    assert floral.materials[0].texture is not None
    assert floral.materials[1] is mesh.materials[1]
    np.testing.assert_array_equal(floral.uv[other], mesh.uv[other])
    assert np.ptp(floral.uv[~other]) > 0.5


def test_a_tinted_texture_keeps_its_light_and_dark() -> None:
    sculpt = Sculpt("wood")
    sculpt.box((0, 0, 0), (1, 1, 1))
    wood = sculpt.mesh()
    green = dressed(wood, (0,), "green").materials[0]
    before, after = wood.materials[0].texture, green.texture
    assert before is not None and after is not None
    light = np.corrcoef(before.mean(axis=2).ravel(), after.mean(axis=2).ravel())[0, 1]
    assert light > 0.95
    assert after[..., 1].mean() > 1.5 * after[..., 0].mean()


def test_an_unknown_attribute_is_refused() -> None:
    sculpt = Sculpt("red")
    sculpt.box((0, 0, 0), (1, 1, 1))
    with pytest.raises(InvalidInput, match="ultraviolet"):
        dressed(replace(sculpt.mesh()), (0,), "ultraviolet")
