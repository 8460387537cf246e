"""Class anchors have the geometry of real CLIP text features."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from lab.simulation.imperfect.anchors import AnchorParams, conformity, meaning, spectrum, text_feature
from lab.simulation.imperfect.kinship import kin_of, kin_words
from ovip.scene.types import F64

REAL = Path(__file__).resolve().parents[6] / "shared" / "data" / "clip_text"


def anchors_of(words: list[str], seed: int = 0) -> F64:
    deviations, params = spectrum(512), AnchorParams()
    return np.stack([text_feature(word, deviations, seed, params) for word in words])


def geometry(words: list[str], features: F64) -> dict[str, float]:
    """Mean and spread of the cosines, by kinship, and of each word's nearest other word."""
    cosines = features @ features.T
    kin = [kin_of(word) for word in words]
    synonyms = np.array([[a is not None and a == b for b in kin] for a in kin])
    kind = (
        np.array([[a is not None and b is not None and a.kind == b.kind for b in kin] for a in kin])
        & ~synonyms
    )
    pairs = np.triu(np.ones(cosines.shape, dtype=bool), 1)
    nearest = np.where(np.eye(len(words), dtype=bool), -1, cosines).max(axis=1)
    return {
        "mean": float(cosines[pairs].mean()),
        "spread": float(cosines[pairs].std()),
        "synonyms": float(cosines[pairs & synonyms].mean()),
        "kind": float(cosines[pairs & kind].mean()),
        "others": float(cosines[pairs & ~synonyms & ~kind].mean()),
        "nearest": float(nearest.mean()),
        "nearest spread": float(nearest.std()),
    }


MEASURED = {
    "mean": 0.763,
    "spread": 0.047,
    "synonyms": 0.886,
    "kind": 0.792,
    "others": 0.760,
    "nearest": 0.889,
    "nearest spread": 0.036,
}
"""Of the 300 LVIS names that stand in the table of kin, by CLIP ViT-B/32."""


def test_the_table_of_kin_has_the_cosines_measured_of_real_text_features() -> None:
    words = list(kin_words())
    for seed in (0, 1, 2):
        made = geometry(words, anchors_of(words, seed))
        assert made == pytest.approx(MEASURED, abs=0.02), seed


def test_the_real_features_have_the_same_geometry_name_by_name() -> None:
    if not REAL.is_dir():
        pytest.skip(
            "../shared/data/clip_text is not here: the comparison with real text features was skipped"
        )
    features = np.load(REAL / "lvis_v1_clip_vitb32_text.npy").astype(np.float64)
    features /= np.linalg.norm(features, axis=1, keepdims=True)
    names = json.loads((REAL / "lvis_v1_names.json").read_text())
    row = {entry["name"].replace("_", " ").split(" (")[0].lower(): i for i, entry in enumerate(names)}
    words = [word for word in kin_words() if word in row]
    assert len(words) > 250
    real = geometry(words, features[[row[word] for word in words]])
    assert real == pytest.approx(MEASURED, abs=0.002)
    assert geometry(words, anchors_of(words)) == pytest.approx(real, abs=0.02)
    centred = features - features.mean(axis=0)
    energy = np.linalg.svd(centred, compute_uv=False) ** 2
    difference = np.cumsum(energy / energy.sum())[:510] - np.cumsum(spectrum(512) ** 2)
    assert np.abs(difference).max() < 0.015


def test_unknown_words_lie_in_the_same_cone() -> None:
    strange = anchors_of([f"zorblax {i}" for i in range(60)])
    cosines = (strange @ strange.T)[np.triu_indices(60, 1)]
    assert cosines.mean() == pytest.approx(0.743, abs=0.015)


def test_features_and_meanings_are_of_unit_length_and_the_spectrum_too() -> None:
    words = ["mug", "cup", "zorblax"]
    assert np.linalg.norm(anchors_of(words), axis=1) == pytest.approx(1)
    deviations = spectrum(512)
    assert (deviations**2).sum() == pytest.approx(1)
    assert 1 / (deviations**4).sum() == pytest.approx(108, abs=1)  # effective dimensions; real: 107.5
    assert meaning("mug", deviations, 0, AnchorParams())[:2] == pytest.approx(0)


def test_a_text_s_cosine_to_what_all_share_is_its_conformity() -> None:
    made = anchors_of(["mug"])[0]
    assert made[0] == pytest.approx(conformity("mug", 0, AnchorParams()))
