"""The made-up scene that tier 1 is measured on."""

from __future__ import annotations

import numpy as np
import pytest

from lab.bench.synthetic import SIDE, synthetic_floor, synthetic_map
from ovip.scene.grid import FREE


def test_one_object_a_label_on_the_floor_with_a_unit_feature_near_its_labels() -> None:
    features = np.eye(3, 64, dtype=np.float32)
    made = synthetic_map(["cup", "bed", "cup"], features).objects
    assert [item.label for item in made] == ["cup", "bed", "cup"]
    assert len({item.object_id for item in made}) == 3
    for item, feature in zip(made, features, strict=True):
        assert (item.box[:3] < item.box[3:]).all()
        assert item.box[:2].min() >= 0
        assert item.box[3:5].max() <= SIDE
        assert np.linalg.norm(item.feature) == pytest.approx(1.0, abs=1e-5)
        assert item.feature @ feature > 0.9


def test_the_same_seed_makes_the_same_scene() -> None:
    features = np.eye(1, 8, dtype=np.float32)
    once, again = (
        synthetic_map(["cup"], features, 4).objects[0],
        synthetic_map(["cup"], features, 4).objects[0],
    )
    assert once.box.tolist() == again.box.tolist()
    assert once.feature.tolist() == again.feature.tolist()
    assert synthetic_floor(4).occupancy.tolist() == synthetic_floor(4).occupancy.tolist()


def test_most_of_the_floor_is_free_and_some_is_not() -> None:
    assert 0.7 < (synthetic_floor().occupancy == FREE).mean() < 0.98
