import pytest

from lab.evaluation.rows import scene_means

SCENES = ("room0", "room1", "room2", "office0", "office2", "office3")

# the paper's tables per scene (mAcc of four methods; base and AWF, mAcc and F-mIoU), and the means it prints
PER_SCENE = {
    "ConceptFusion": ((41.24, 50.62, 38.29, 32.17, 28.39, 23.05), 35.63),
    "HOV-SG": ((49.14, 49.11, 36.19, 37.93, 41.19, 32.30), 40.98),
    "ConceptGraphs": ((51.61, 50.90, 51.14, 37.63, 41.57, 37.17), 45.00),
    "OVIP-SG": ((58.22, 63.25, 47.25, 42.62, 47.30, 49.22), 51.31),
    "base mAcc": ((53.59, 58.67, 51.93, 43.71, 48.42, 45.80), 50.35),
    "base F-mIoU": ((58.86, 44.80, 71.98, 37.98, 22.63, 64.27), 50.09),
    "AWF F-mIoU": ((79.93, 53.11, 72.22, 37.55, 55.36, 70.52), 61.45),
}


@pytest.mark.parametrize("method", PER_SCENE)
def test_the_papers_means_follow_from_its_scenes(method: str) -> None:
    values, mean = PER_SCENE[method]
    rows = [{"config": method, "scene": s, "mAcc": v} for s, v in zip(SCENES, values, strict=True)]
    assert scene_means(rows) == [{"config": method, "mAcc": pytest.approx(mean, abs=0.0051)}]


def test_counts_add_up_and_a_scene_without_a_value_does_not_count() -> None:
    rows = [
        {
            "config": "a",
            "scene": "x",
            "PQ": 0.2,
            "swallowed_recall": None,
            "objects": 10,
            "strict": {"PQ": 0.1},
        },
        {
            "config": "b",
            "scene": "x",
            "PQ": 0.9,
            "swallowed_recall": None,
            "objects": 1,
            "strict": {"PQ": 0.8},
        },
        {
            "config": "a",
            "scene": "y",
            "PQ": 0.4,
            "swallowed_recall": 0.5,
            "objects": 20,
            "strict": {"PQ": 0.3},
        },
    ]
    a, b = scene_means(rows)
    assert a == {
        "config": "a",
        "PQ": pytest.approx(0.3),
        "swallowed_recall": 0.5,
        "objects": 30,
        "strict": {"PQ": pytest.approx(0.2)},
    }
    assert b["config"] == "b"
    assert b["swallowed_recall"] is None
