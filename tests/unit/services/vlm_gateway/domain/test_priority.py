"""The order of the queue."""

from __future__ import annotations

from services.vlm_gateway.domain.priority import Place, share_of
from services.vlm_gateway.domain.question import Purpose


def test_search_goes_before_enumeration_before_grouping_then_by_arrival() -> None:
    asked = [Purpose.GROUP, Purpose.ENUMERATE, Purpose.SEARCH, Purpose.ENUMERATE, Purpose.SEARCH]
    places = sorted(Place.of(purpose, arrival) for arrival, purpose in enumerate(asked))
    assert [place.arrival for place in places] == [2, 4, 1, 3, 0]


def test_routes_share_the_time_left() -> None:
    assert share_of(60.0, 3) == 20.0
    assert share_of(40.0, 1) == 40.0
