from __future__ import annotations

import numpy as np

from lab.evaluation.asking.policies import lexical, most_alike, nearest, random
from ovip.scene.types import Box2, MapObject


def mapped(
    object_id: str, label: str, x: float = 0.0, frames: int = 5, feature: tuple[float, ...] = (1, 0)
) -> MapObject:
    return MapObject(
        object_id=object_id,
        label=label,
        label_counts={label: frames},
        centroid=np.array([x, 0.0, 0.5]),
        box=np.array([x - 0.1, -0.1, 0.4, x + 0.1, 0.1, 0.6]),
        feature=np.array(feature, np.float32),
        view_weight=1.0,
        observations=frames,
        frames=frames,
        first_seen_ns=0,
        last_seen_ns=0,
        voxels=1,
        mean_color=np.zeros(3),
        best_frame_id="f",
        best_box2=Box2(0, 0, 1, 1),
        version=1,
    )


def ids(objects: tuple[MapObject, ...]) -> list[str]:
    return [o.object_id for o in objects]


def test_lexical_takes_who_shares_most_words_and_nobody_else() -> None:
    objects = [
        mapped("a", "wine glass"),
        mapped("b", "glass"),
        mapped("c", "wine bottle"),
        mapped("d", "sofa"),
    ]
    assert ids(lexical("the wine glass", objects)) == ["a", "b", "c"]
    assert lexical("couch", objects) == ()


def test_lexical_prefers_the_object_seen_more_often_among_equals() -> None:
    objects = [mapped("a", "mug", frames=3), mapped("b", "mug", frames=9), mapped("c", "mug", frames=9)]
    assert ids(lexical("red mug", objects)) == ["b", "c", "a"]


def test_likeness_ranks_everything() -> None:
    objects = [
        mapped("a", "x", feature=(0, 1)),
        mapped("b", "y", feature=(0.8, 0.6)),
        mapped("c", "z", feature=(0, 1)),
    ]
    assert ids(most_alike(np.array([1, 0], np.float32), objects)) == ["b", "a", "c"]
    assert most_alike(np.array([1, 0], np.float32), []) == ()


def test_nearest_does_not_care_what_was_asked() -> None:
    objects = [mapped("a", "mug", 3.0), mapped("b", "sofa", 1.0), mapped("c", "bed", -1.0)]
    assert ids(nearest(np.zeros(2), objects)) == ["b", "c", "a"]


def test_random_is_every_object_in_an_order_that_its_seed_decides() -> None:
    objects = [mapped(str(k), "mug") for k in range(20)]
    first, again = (random(np.random.default_rng(7), objects) for _ in range(2))
    assert ids(first) == ids(again) != ids(tuple(objects))
    assert sorted(ids(first)) == sorted(ids(tuple(objects)))
