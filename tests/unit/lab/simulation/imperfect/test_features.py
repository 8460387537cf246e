"""Image features: two cones with a gap, and crops that show what they contain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lab.simulation.imperfect import FeatureModel, FeatureParams, Thing, View, truth_of
from ovip.errors import InvalidInput
from ovip.scene.types import F32

CLASSES = [
    "sofa",
    "armchair",
    "cushion",
    "blanket",
    "mug",
    "bowl",
    "plate",
    "bottle",
    "vase",
    "book",
    "table",
    "nightstand",
    "cabinet",
    "bookshelf",
    "lamp",
    "picture",
    "television",
    "remote",
    "refrigerator",
    "stove",
    "sink",
    "faucet",
    "curtain",
    "rug",
    "towel",
    "spoon",
    "knife",
    "clock",
    "wardrobe",
    "basket",
    "mirror",
    "switch",
    "bicycle",
    "piano",
    "guitar",
    "backpack",
    "umbrella",
    "laptop",
    "printer",
    "chandelier",
    "fan",
]
PER_CLASS = 4
THINGS = [Thing(1 + PER_CLASS * i + j, label) for i, label in enumerate(CLASSES) for j in range(PER_CLASS)]
WALL = Thing(900, "wall", (), True)
TRUTH = truth_of([*THINGS, WALL])
AHEAD = np.array([1.0, 0.0, 0.0])


def view(thing: int, frame: int = 0, side: float = 200.0) -> View:
    """A clean, centred view of a thing, a little wall around it."""
    pixels = int(side**2)
    return View(frame, thing, {thing: pixels}, {900: pixels // 4}, side, 0.0, 0.0, 0.0, AHEAD)


@pytest.fixture(scope="module")
def model() -> FeatureModel:
    return FeatureModel(CLASSES)


def images(model: FeatureModel, frame: int = 0, side: float = 200.0) -> F32:
    return model.image([view(thing.object_id, frame, side) for thing in THINGS], TRUTH)


def right(model: FeatureModel, features: F32) -> float:
    """Share of the things' features whose best class is theirs."""
    best = (features @ model.text(CLASSES).T).argmax(axis=1)
    return float(np.mean(best == np.repeat(np.arange(len(CLASSES)), PER_CLASS)))


def test_all_features_are_of_unit_length(model: FeatureModel) -> None:
    for features in (images(model), images(model, side=8), model.text(["mug", "red mug", "zorblax"])):
        assert features.dtype == np.float32
        assert np.linalg.norm(features, axis=1) == pytest.approx(1, abs=1e-6)
    assert model.text([]).shape == (0, 512) and model.image([], TRUTH).shape == (0, 512)


def test_texts_and_images_lie_in_two_cones(model: FeatureModel) -> None:
    features, texts = images(model), model.text(CLASSES)
    cosines = features @ texts.T
    own = np.repeat(np.arange(len(CLASSES)), PER_CLASS)
    is_right = own[:, None] == np.arange(len(CLASSES))
    assert cosines[is_right].mean() == pytest.approx(0.285, abs=0.025)
    assert cosines[~is_right].mean() == pytest.approx(0.215, abs=0.02)


def test_two_views_are_alike_as_they_show_the_same_thing_the_same_class_or_another(
    model: FeatureModel,
) -> None:
    first, second = images(model, 0), images(model, 1)
    cosines = first @ second.T
    label = np.repeat(np.arange(len(CLASSES)), PER_CLASS)
    same = np.eye(len(THINGS), dtype=bool)
    same_class = (label[:, None] == label) & ~same
    assert cosines[same].mean() == pytest.approx(0.92, abs=0.03)
    assert cosines[same_class].mean() == pytest.approx(0.78, abs=0.03)
    assert cosines[label[:, None] != label].mean() == pytest.approx(0.57, abs=0.03)


def test_good_views_are_mostly_classified_right_and_small_ones_mostly_not() -> None:
    good, small = [], []
    for seed in range(4):
        model = FeatureModel(CLASSES, seed=seed)
        good.append(right(model, images(model)))
        small.append(right(model, images(model, side=14)))
    assert 0.6 < np.mean(good) < 0.85
    assert 0.2 < np.mean(small) < 0.45


def test_a_view_s_noise_grows_as_it_is_smaller_cut_off_centre_or_blurred(model: FeatureModel) -> None:
    good = view(1)
    assert model.noise(good) == pytest.approx(0.053)
    assert model.noise(replace(good, side=80.0)) == pytest.approx(0.053 * 3)  # one halving of 160
    assert model.noise(replace(good, truncated=0.5)) == pytest.approx(0.053 * 2.5)
    assert model.noise(replace(good, off_centre=1.0)) == pytest.approx(0.053 * 1.5)
    assert model.noise(replace(good, blur=100.0)) == pytest.approx(0.053 * 2)  # blurred over half its side


def test_smaller_views_of_a_thing_differ_more_from_one_another(model: FeatureModel) -> None:
    def spread(side: float) -> float:
        features = model.image([view(5, frame, side) for frame in range(40)], TRUTH)
        return float((features @ features.T)[np.triu_indices(40, 1)].mean())

    assert spread(200) > spread(60) + 0.05 > spread(20) + 0.1


def test_a_crop_of_a_mug_contains_the_table(model: FeatureModel) -> None:
    mug, table = 1 + PER_CLASS * CLASSES.index("mug"), 1 + PER_CLASS * CLASSES.index("table")
    table_text = model.text(["table"])[0]
    alone = [replace(view(mug, frame), around={}) for frame in range(30)]
    shares = []
    for inside, around in (({mug: 100}, {}), ({mug: 100}, {table: 300}), ({mug: 100, table: 300}, {})):
        views = [replace(v, inside=inside, around=around) for v in alone]
        shares.append(float((model.image(views, TRUTH) @ table_text).mean()))
    assert shares[0] + 0.01 < shares[1] < shares[2] - 0.005


def test_views_from_nearby_are_more_alike_than_views_from_opposite_sides(model: FeatureModel) -> None:
    turned = {name: np.array([np.cos(a), np.sin(a), 0]) for name, a in (("near", 0.2), ("far", np.pi))}
    first = model.image([view(9)], TRUTH)[0]
    seen = {
        name: float(
            np.mean([model.image([replace(view(9, f), direction=d)], TRUTH)[0] @ first for f in range(1, 20)])
        )
        for name, d in turned.items()
    }
    assert seen["near"] > seen["far"] + 0.05


def test_a_phrase_is_its_class_with_attributes(model: FeatureModel) -> None:
    red, green, plain = model.text(["red mug", "green mug", "mug"])
    assert red @ plain > red @ green
    assert red @ plain > red @ model.text(["red bowl"])[0]
    truth = truth_of([Thing(1, "mug", ("red",)), Thing(2, "mug", ("green",))])
    views = [replace(view(1, frame), around={}) for frame in range(20)]
    fused = model.image(views, truth).mean(axis=0)
    assert fused @ red > fused @ green


def test_prompts_and_plurals_give_the_label_s_feature(model: FeatureModel) -> None:
    same = model.text(["mug", "A photo of a mug.", "an image of mug", "Mugs"])
    assert np.array_equal(same, np.repeat(same[:1], 4, axis=0))


def test_a_word_s_feature_does_not_depend_on_the_other_labels(model: FeatureModel) -> None:
    assert np.array_equal(FeatureModel(["mug"]).text(["mug", "sofa"]), model.text(["mug", "sofa"]))


def test_a_label_beyond_the_table_of_kin_may_have_several_words() -> None:
    model = FeatureModel(["zorblax holder"])
    together, apart = model.text(["big zorblax holder"])[0], FeatureModel([]).text(["big zorblax holder"])[0]
    own = model.text(["zorblax holder"])[0]
    assert own @ together > own @ apart + 0.1


@settings(max_examples=20, deadline=None)
@given(st.permutations(list(range(8))), st.integers(0, 5))
def test_features_do_not_depend_on_order_or_company(order: list[int], frame: int) -> None:
    model = FeatureModel(CLASSES)
    alone = np.stack([FeatureModel(CLASSES).image([view(1 + i, frame)], TRUTH)[0] for i in order])
    assert np.array_equal(model.image([view(1 + i, frame) for i in order], TRUTH), alone)


def test_scenes_share_texts_but_not_the_look_of_their_things(model: FeatureModel) -> None:
    here, there = model.image([view(3)], TRUTH, seed=0)[0], model.image([view(3)], TRUTH, seed=1)[0]
    assert 0.7 < here @ there < 0.87


def test_a_view_of_nothing_known_is_still_a_feature(model: FeatureModel) -> None:
    nothing = View(0, 0, {}, {}, 50.0, 0.0, 0.0, 0.0, AHEAD)
    assert np.linalg.norm(model.image([nothing], TRUTH)[0]) == pytest.approx(1, abs=1e-6)


def test_any_dimension_from_32_on_will_do() -> None:
    assert FeatureModel(CLASSES, dimension=64).text(["mug"]).shape == (1, 64)
    with pytest.raises(InvalidInput, match="at least 32"):
        FeatureModel(CLASSES, dimension=16)


def test_levels_of_a_good_view_sum_to_about_one() -> None:
    p = FeatureParams()
    assert p.common + p.aligned**2 + p.looks + p.instance + p.aspect + p.noise == pytest.approx(
        0.96, abs=0.05
    )
