"""The catalogue: libraries in Sweet Home 3D's layout, turned into our frame, and the same labels everywhere."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lab.simulation.catalogue import Catalogue, Variant, open_catalogue
from lab.simulation.catalogue.config import cache_folder
from lab.simulation.catalogue.model import fitted
from lab.simulation.catalogue.models import LABEL_OF
from lab.simulation.catalogue.sweet_home import FURNITURE, library_entries, properties
from lab.simulation.home import triangle_areas
from ovip.errors import InvalidInput, NotFound
from tests.unit.lab.simulation import sweet_home_files as files

installed = pytest.mark.skipif(
    not any(FURNITURE.glob("*.sh3f")), reason="Debian's sweethome3d-furniture is not installed"
)


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("OVIP_LAB_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "furniture"
    folder.mkdir()
    files.write_library(folder)
    return folder


def variant_named(catalogue: Catalogue, label: str, name: str) -> Variant:
    return next(v for v in catalogue.variants(label) if v.name == name)


def test_an_entry_carries_its_metric_size_its_maker_and_its_licence(library: Path) -> None:
    chair, remote, _ = library_entries(library / "Scopia.sh3f")
    assert chair.size == pytest.approx((0.42, 0.474, 0.88))
    assert chair.top == pytest.approx(0.482)
    assert chair.attribution == "Café chair by Scopia, CC-BY 3.0 (Sweet Home 3D furniture library)"
    assert remote.rotation == (1, 0, 0, 0, 0, 1, 0, -1, 0)


def test_models_fill_their_label_and_composed_shapes_the_rest(library: Path) -> None:
    catalogue = open_catalogue(library)
    assert catalogue.source == "Sweet Home 3D furniture library"
    assert [v.name for v in catalogue.variants("chair")] == ["Scopia/chair"]
    assert all(v.name.startswith("composed/") for v in catalogue.variants("cushion"))


def test_labels_are_the_same_with_and_without_libraries(library: Path, tmp_path: Path) -> None:
    composed = open_catalogue(tmp_path / "nowhere")
    assert composed.source == "composed shapes"
    assert composed.labels == open_catalogue(library).labels


def test_every_mapped_model_has_a_label_that_is_composed_too(tmp_path: Path) -> None:
    assert {mapped.label for mapped in LABEL_OF.values()} <= open_catalogue(tmp_path).labels


def test_a_model_measures_its_catalogue_size_and_its_back_is_behind(library: Path) -> None:
    catalogue = open_catalogue(library)
    model = catalogue.build(variant_named(catalogue, "chair", "Scopia/chair"))
    low, high = model.mesh.vertices.min(axis=0), model.mesh.vertices.max(axis=0)
    np.testing.assert_allclose(low, (-0.21, -0.237, 0), atol=1e-6)
    np.testing.assert_allclose(high, (0.21, 0.237, 0.88), atol=1e-6)
    upper = model.mesh.vertices[model.mesh.vertices[:, 2] > 0.8]
    assert upper[:, 1].min() > 0.18
    assert model.top == pytest.approx(0.482)


def test_a_model_that_is_drawn_standing_is_laid_down_by_its_rotation(library: Path) -> None:
    catalogue = open_catalogue(library)
    model = catalogue.build(variant_named(catalogue, "remote control", "Scopia/tv-remote-control"))
    assert model.size == pytest.approx((0.045, 0.18, 0.017))
    raised = model.mesh.vertices[model.mesh.vertices[:, 2] > 0.0169]
    assert raised[:, 1].min() == pytest.approx(0.045, abs=1e-6)
    assert raised[:, 1].max() == pytest.approx(0.09, abs=1e-6)
    assert model.top is None


def test_materials_keep_colours_and_textures_are_made_small(library: Path) -> None:
    catalogue = open_catalogue(library)
    seat, back = catalogue.build(catalogue.variants("chair")[0]).mesh.materials
    assert seat.texture is None and seat.color.tolist() == [255, 127, 0]
    assert back.texture is not None and back.texture.shape == (128, 256, 3)
    assert np.abs(back.texture.reshape(-1, 3).mean(axis=0) - (10, 30, 200)).max() < 6


def test_a_prepared_model_is_read_from_the_cache_bit_for_bit(library: Path) -> None:
    first = open_catalogue(library).build(open_catalogue(library).variants("chair")[0]).mesh
    kept = list((cache_folder() / "models").glob("*.npz"))
    assert len(kept) == 1
    again = open_catalogue(library).build(open_catalogue(library).variants("chair")[0]).mesh
    for name in ("vertices", "triangles", "normals", "uv", "material_ids"):
        one, two = getattr(first, name), getattr(again, name)
        assert one.dtype == two.dtype and one.tobytes() == two.tobytes()
    assert [m.color.tolist() for m in first.materials] == [m.color.tolist() for m in again.materials]


def test_a_damaged_cache_file_is_made_anew(library: Path) -> None:
    catalogue = open_catalogue(library)
    catalogue.build(catalogue.variants("chair")[0])
    (kept,) = (cache_folder() / "models").glob("*.npz")
    whole = kept.read_bytes()
    kept.write_bytes(whole[: len(whole) // 2])
    fresh = open_catalogue(library)
    assert len(fresh.build(fresh.variants("chair")[0]).mesh.triangles) == 24
    assert kept.read_bytes() == whole
    assert not list(kept.parent.glob("*.part"))


def test_another_size_stretches_the_model_and_its_top(library: Path) -> None:
    catalogue = open_catalogue(library)
    model = catalogue.build(catalogue.variants("chair")[0], size=(0.4, 0.4, 0.44))
    np.testing.assert_allclose(model.mesh.vertices.max(axis=0), (0.2, 0.2, 0.44), atol=1e-6)
    assert model.top == pytest.approx(0.241)


def test_an_attribute_changes_colours_and_not_the_shape(library: Path) -> None:
    catalogue = open_catalogue(library)
    chair = catalogue.variants("chair")[0]
    plain, red = catalogue.build(chair).mesh, catalogue.build(chair, "red").mesh
    assert plain.vertices.tobytes() == red.vertices.tobytes()
    areas = np.bincount(red.material_ids, triangle_areas(red))
    color = red.materials[int(areas.argmax())].color.astype(int)
    assert color[0] > 150 and color[1] < 60 and color[2] < 60


def test_an_attribute_that_a_variant_cannot_have_is_refused(library: Path) -> None:
    catalogue = open_catalogue(library)
    with pytest.raises(InvalidInput, match="floral"):
        catalogue.build(catalogue.variants("chair")[0], "floral")


def test_an_unknown_label_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFound, match="unicorn"):
        open_catalogue(tmp_path).variants("unicorn")


def test_properties_know_comments_escapes_and_continued_lines() -> None:
    text = "# a = b\n! c = d\nname#1 = Caf\\u00e9\\\n   table\nempty#1=\nurl=http://x=y\n"
    assert properties(text) == {"name#1": "Cafétable", "empty#1": "", "url": "http://x=y"}


def test_a_mesh_that_is_flat_stays_flat_when_fitted(tmp_path: Path) -> None:
    catalogue = open_catalogue(tmp_path)
    mesh = catalogue.build(catalogue.variants("rug")[0]).mesh
    flat = fitted(mesh, (1.0, 1.0, 0.02))
    again = fitted(type(flat)(**{**_fields(flat), "vertices": flat.vertices * (1, 1, 0)}), (2.0, 2.0, 0.5))
    assert again.vertices[:, 2].max() == 0 and np.isfinite(again.vertices).all()


def _fields(mesh: object) -> dict[str, object]:
    return {name: getattr(mesh, name) for name in mesh.__slots__}  # type: ignore[attr-defined]


@installed
def test_every_mapped_model_is_in_debians_package() -> None:
    catalogue = open_catalogue()
    found = {v.name for label in catalogue.labels for v in catalogue.variants(label)}
    assert set(LABEL_OF) <= found


@installed
@pytest.mark.parametrize(
    "name", ["Scopia/chair3", "BlendSwap-CC-BY/fotel", "Scopia/simple_sofa", "Scopia/office_chair"]
)
def test_the_back_of_a_real_seat_is_behind(name: str) -> None:
    catalogue = open_catalogue()
    mesh = catalogue.build(variant_named(catalogue, LABEL_OF[name].label, name)).mesh
    upper = mesh.vertices[mesh.vertices[:, 2] > 0.75 * mesh.vertices[:, 2].max()]
    assert upper[:, 1].mean() > 0.05


@installed
def test_a_heavy_real_model_fits_its_budget_and_keeps_its_size() -> None:
    catalogue = open_catalogue()
    teapot = variant_named(catalogue, "teapot", "Scopia/teapot")
    mesh = catalogue.build(teapot).mesh
    assert 1000 < len(mesh.triangles) <= 2000
    np.testing.assert_allclose(mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0), teapot.size, atol=1e-5)
