from __future__ import annotations

import numpy as np
import pytest

from services.retrieval.domain.names import TextFeatures
from services.retrieval.domain.places import matching_regions
from services.retrieval.domain.priors import function_of, table_priors
from services.retrieval.domain.vocabulary import ROOM_FUNCTIONS, ROOMS_OF
from tests.unit.services.retrieval.builders import region

ROOMS = {"r1": "kitchen", "r2": "bathroom", "r3": "unknown"}


def test_often_sometimes_never_and_unknown() -> None:
    priors = table_priors("mug", {**ROOMS, "r4": "office"}).by_region
    assert priors == {"r1": 0.8, "r2": 0.05, "r3": 0.3, "r4": 0.4}


def test_an_unknown_word_takes_the_mean_of_its_nearest_table_words_by_cosine() -> None:
    def at(cosine: float) -> np.ndarray:
        return np.array([cosine, np.sqrt(1 - cosine**2)], np.float32)

    texts = TextFeatures("minilm", {"gizmo": at(1.0), "toaster": at(0.8), "toilet": at(0.4), "bed": at(0.1)})
    priors = table_priors("gizmo", ROOMS, texts)
    # kitchen: toaster .8 often, toilet .4 never -> (.8*.8 + .4*.05) / 1.2
    assert priors.by_region["r1"] == pytest.approx((0.8 * 0.8 + 0.4 * 0.05) / 1.2, abs=1e-6)
    assert "toaster" in priors.why
    assert "bed" not in priors.why


def test_a_word_without_a_row_or_a_neighbour_is_as_likely_everywhere() -> None:
    assert set(table_priors("gizmo", ROOMS).by_region.values()) == {0.3}
    assert table_priors("gizmo", {}).by_region == {}


@pytest.mark.parametrize(
    ("name", "function"),
    [
        ("Kitchen", "kitchen"),
        ("lounge", "living room"),
        ("dining area", "dining room"),
        ("storage", "garage"),
        ("kitchen 2", "kitchen"),
        ("moon base", ""),
    ],
)
def test_room_names_lead_to_functions(name: str, function: str) -> None:
    assert function_of(name) == function


def test_every_row_of_the_table_is_well_formed() -> None:
    assert len(ROOMS_OF) > 200
    assert all(
        set(rooms) <= set(ROOM_FUNCTIONS) and set(rooms.values()) <= {0.0, 1.0, 2.0}
        for rooms in ROOMS_OF.values()
    )


def test_a_spoken_place_means_regions_by_name_by_function_or_by_alias() -> None:
    regions = (region("r1", "kitchen"), region("r2", "living room"), region("r3", "kitchen"))
    assert [r.region_id for r in matching_regions("the kitchen".removeprefix("the "), regions)] == [
        "r1",
        "r3",
    ]
    assert [r.region_id for r in matching_regions("lounge", regions)] == ["r2"]
    assert matching_regions("table", regions) == ()
    assert matching_regions("", regions) == ()
