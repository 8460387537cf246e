"""Makes mapped objects and maps of any size, for whoever reads, sends or shows them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ovip.scene.types import Box2, MapObject, SceneMap


def map_object(object_id: str, **changes: Any) -> MapObject:
    """A cup of 10 cm at the origin, confirmed and present."""
    cup = MapObject(
        object_id=object_id,
        label="cup",
        label_counts={"cup": 3},
        centroid=np.zeros(3),
        box=np.array([-0.05, -0.05, -0.05, 0.05, 0.05, 0.05]),
        feature=np.array([0.0, 1.0], np.float32),
        view_weight=1.0,
        observations=3,
        frames=3,
        first_seen_ns=1,
        last_seen_ns=2,
        voxels=10,
        mean_color=np.array([200.0, 100.0, 50.0]),
        best_frame_id="r.s.00000001",
        best_box2=Box2(0, 0, 1, 1),
        version=7,
    )
    return replace(cup, **changes)


def scene_map(objects: int, dimension: int, version: int = 7) -> SceneMap:
    """The kitchen: so many cups, each with a feature of its own."""
    rng = np.random.default_rng(1)
    features = rng.normal(size=(objects, dimension)).astype(np.float32)
    cups = tuple(map_object(f"o{i:06d}", feature=feature) for i, feature in enumerate(features))
    return SceneMap("kitchen", version, cups, f"hash-{version}", 3, 60, "17-0")
