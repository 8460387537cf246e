import dataclasses
from pathlib import Path

import numpy as np
import pytest

from lab.evaluation.mapping.diagnosis import diagnosed
from lab.evaluation.mapping.places import Place, Storey, load_place, save_place
from lab.evaluation.mapping.scoring import (
    Mapped,
    Transfer,
    class_of_words,
    detected_classes,
    instance_columns,
    judged,
    label_recall,
    mapped,
    semantic_scores,
    transfer,
)
from lab.evaluation.scores.instance import NOTHING
from services.mapper.domain.params import MapParams
from tests.builders import axis, batch, detection, same
from tests.unit.lab.evaluation.tabletop import (
    MUG,
    MUG_ID,
    MUG_POINTS,
    TABLE,
    TABLE_ID,
    TABLE_TOP,
    VASE,
    VASE_ID,
    VASE_POINTS,
    seen_well,
    tabletop,
)


@pytest.fixture(scope="module")
def place() -> Place:
    return tabletop()


def test_a_map_of_everything_scores_full_marks(place: Place) -> None:
    scene = mapped(seen_well(), MapParams())
    compat, strict = semantic_scores(place, scene, judged(place, scene))
    assert compat.columns == strict.columns == {"mAcc": 100, "F-mIoU": 100, "mIoU": 100}
    columns = instance_columns(place, transfer(scene, place.points).strict)
    assert columns == pytest.approx(
        {"PQ": 1, "SQ": 1, "RQ": 1, "recall_small": 1, "recall_medium": 1, "recall_large": 1}
    )


def test_floor_takes_the_nearest_object_in_compat_and_counts_only_where_it_is_not_excluded(
    place: Place,
) -> None:
    scene = mapped(seen_well(), MapParams())
    compat, strict = semantic_scores(place, scene, judged(place, scene, 1))
    # four classes kept; the floor's points are all called table (compat) or are unmapped (strict)
    assert compat.accuracy == strict.accuracy == 75
    assert compat.iou < strict.iou == 75
    assert semantic_scores(place, scene, judged(place, scene, 4))[0].points == len(place.points)


def test_strict_does_not_lend_an_unmapped_thing_its_neighbours_object(place: Place) -> None:
    # the mug was never detected: the table's points are nearest, 2 to 12 cm away
    batches = [batch(n, detection("table", feature=axis(TABLE), points=TABLE_TOP)) for n in range(1, 5)]
    seen = transfer(mapped(batches, MapParams()), MUG_POINTS)
    assert (seen.compat == 0).all()
    above = MUG_POINTS[:, 2] - 0.74  # metres over the table's surface
    assert (seen.strict[above < 0.08] == 0).all()
    assert (seen.strict[above > 0.11] == NOTHING).all()
    assert (above > 0.11).any()


def test_an_empty_map_scores_nothing(place: Place) -> None:
    scene = mapped([], MapParams())
    assert [score.accuracy for score in semantic_scores(place, scene, judged(place, scene))] == [0, 0]
    assert instance_columns(place, transfer(scene, place.points).compat)["PQ"] == 0


def test_labels_mixed_in_classify_an_object_whose_feature_is_off(place: Place) -> None:
    off = (0.6 * axis(MUG) + 0.8 * axis(VASE)).astype(np.float32)  # a cup that looks like a vase
    batches = [batch(n, detection("cup", feature=off, points=MUG_POINTS)) for n in range(1, 5)]
    scene = mapped(batches, MapParams())
    points = judged(place, scene)
    recalls = [semantic_scores(place, scene, points, lam)[1].accuracy for lam in (0.0, 1.0)]
    assert recalls[0] == 0  # strict: the mug is called a vase
    assert recalls[1] == pytest.approx(100 / 3)


def test_a_word_means_the_class_of_its_name_or_the_nearest_by_feature_and_structure_none(
    place: Place,
) -> None:
    means = class_of_words(place, ["cup", "mug", "table", "floor"])
    assert means == {"cup": MUG, "mug": MUG, "table": TABLE, "floor": NOTHING}


def test_a_class_is_detected_from_three_detections_on(place: Place) -> None:
    assert detected_classes(place, seen_well(3)).tolist() == [False, True, True, True]
    assert not detected_classes(place, seen_well(2)).any()


def test_label_area_recall_of_a_mug_that_became_part_of_a_table(place: Place) -> None:
    swallowed = np.concatenate([TABLE_TOP, MUG_POINTS])
    batches = [
        batch(
            n,
            detection("table", feature=axis(TABLE), points=swallowed),
            detection("vase", feature=axis(VASE), points=VASE_POINTS),
        )
        for n in range(1, 5)
    ]
    scene = mapped(batches, MapParams())
    recall = label_recall(place, scene, transfer(scene, place.points).compat)
    assert recall[[MUG, TABLE, VASE]].tolist() == [0, 1, 1]


def test_diagnosis_names_duplicates_and_objects_of_nothing(place: Place) -> None:
    scene = mapped(seen_well(), MapParams())
    names = {o.label: o for o in scene.objects}
    left = MUG_POINTS[:, 0] < 0.25
    clouds = [TABLE_TOP, MUG_POINTS[left], MUG_POINTS[~left], VASE_POINTS + np.float32(5)]
    broken = Mapped(
        objects=(names["table"], names["cup"], names["cup"], names["vase"]),
        points=np.concatenate(clouds),
        owners=np.repeat(np.arange(4), [len(cloud) for cloud in clouds]),
    )
    found = diagnosed(place, broken)
    assert found.instance_of.tolist() == [TABLE_ID, MUG_ID, MUG_ID, NOTHING]
    assert (found.found, found.duplicates, found.spurious) == pytest.approx((2 / 3, 1 / 3, 1 / 4))
    whole = diagnosed(place, scene)
    assert sorted(whole.instance_of.tolist()) == [TABLE_ID, MUG_ID, VASE_ID]
    assert (whole.found, whole.duplicates, whole.spurious) == (1, 0, 0)


def test_a_place_reads_back_as_it_was_saved(tmp_path: Path) -> None:
    storey = Storey("floor 0", 0.0, 2.5, (("kitchen", ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))),))
    made = dataclasses.replace(tabletop(tmp_path / "detections.cache"), storeys=(storey,))
    assert load_place(tmp_path) is None
    save_place(tmp_path, made)
    found = load_place(tmp_path)
    assert found is not None
    assert same(found, made)


def test_a_transfer_is_the_same_wherever_the_map_is_full(place: Place) -> None:
    seen: Transfer = transfer(mapped(seen_well(), MapParams()), place.points)
    assert (seen.compat == seen.strict).all()
