"""Searches in the store: compare-and-set documents of kind "search", as versioned JSON."""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np

from ovip.codec import decode_answer, encode_answer
from ovip.errors import Corrupt, NotFound
from ovip.jsonable import to_json
from ovip.scene.answers import Answer, Query
from ovip.scene.types import F64, Box2
from ovip.store import Store
from services.retrieval.domain.coverage import View
from services.retrieval.domain.search import Phase, Search, Waypoint
from services.retrieval.domain.votes import Sighting
from services.retrieval.ports import StoredSearch

FORMAT = 1
_KIND = "search"


class StoredSearches:
    """Keeps searches with a robot as documents, and plain questions' answers in the cache for a while."""

    def __init__(self, store: Store, keep_answers_s: float) -> None:
        self._store = store
        self._keep_answers_s = keep_answers_s

    async def load(self, scene: str, search_id: str) -> StoredSearch:
        """A stored search; NotFound where there is none."""
        document = await self._store.load_document(scene, _KIND, search_id)
        if document is None:
            raise NotFound(f"search {search_id!r}: scene {scene!r} has no such search")
        return StoredSearch(scene, decode_search(document.data), document.revision)

    async def save(self, stored: StoredSearch) -> StoredSearch:
        """Compare-and-set; Conflict where the stored one has moved on."""
        data = encode_search(stored.search)
        revision = await self._store.save_document(
            stored.scene, _KIND, stored.search.search_id, data, stored.revision
        )
        return StoredSearch(stored.scene, stored.search, revision)

    async def remember(self, scene: str, search_id: str, text: str, answer: Answer) -> None:
        """Keeps a plain question's answer for a while."""
        data = json.dumps({"format": FORMAT, "text": text, "answer": _packed(answer)}).encode()
        await self._store.cache_put(_cache_key(scene, search_id), data, self._keep_answers_s)

    async def recall(self, scene: str, search_id: str) -> tuple[str, Answer] | None:
        """What `remember` kept, or None."""
        data = await self._store.cache_get(_cache_key(scene, search_id))
        if data is None:
            return None
        record = json.loads(data)
        return record["text"], _unpacked(record["answer"])


def encode_search(search: Search) -> bytes:
    """JSON of the whole search; answers inside as base64 of their wire form, features as base64 float32."""
    record = {
        "format": FORMAT,
        "search_id": search.search_id,
        "query": to_json(search.query),
        "phase": search.phase.value,
        "account": _packed(search.account),
        "vlm_calls": search.vlm_calls,
        "priors": dict(search.priors or {}),
        "waypoints": [[w.waypoint_id, w.region_id, w.floor, *w.position.tolist()] for w in search.waypoints],
        "seen": list((search.seen or {}).items()),
        "unreachable": sorted(search.unreachable),
        "views": [[v.floor, v.x, v.y, v.yaw, v.field_of_view] for v in search.views],
        "sightings": [_sighting_record(sighting) for sighting in search.sightings],
        "blind": search.blind,
        "place": None if search.place is None else search.place.tolist(),
        "floor": search.floor,
        "budget": search.budget,
    }
    return json.dumps(record, separators=(",", ":")).encode()


def decode_search(data: bytes) -> Search:
    """The search; Corrupt where it was written in a format that this version does not read."""
    record = json.loads(data)
    if record.get("format") != FORMAT:
        raise Corrupt(f"stored search: expected format {FORMAT}, got {record.get('format')}")
    return Search(
        search_id=record["search_id"],
        query=_query(record["query"]),
        phase=Phase(record["phase"]),
        account=_unpacked(record["account"]),
        vlm_calls=record["vlm_calls"],
        priors=record["priors"],
        waypoints=tuple(Waypoint(w[0], w[1], w[2], np.array(w[3:])) for w in record["waypoints"]),
        seen=dict(record["seen"]),
        unreachable=frozenset(record["unreachable"]),
        views=tuple(View(*view) for view in record["views"]),
        sightings=tuple(_sighting(item) for item in record["sightings"]),
        blind=record["blind"],
        place=_array(record["place"]),
        floor=record["floor"],
        budget=record["budget"],
    )


def _cache_key(scene: str, search_id: str) -> str:
    return f"retrieval/{scene}/{search_id}"


def _packed(answer: Answer) -> str:
    return base64.b64encode(encode_answer(answer)).decode()


def _unpacked(text: str) -> Answer:
    return decode_answer(base64.b64decode(text))


def _array(values: list[float] | None) -> F64 | None:
    return None if values is None else np.array(values, dtype=np.float64)


def _query(record: dict[str, Any]) -> Query:
    return Query(**{**record, "robot_pose": _array(record["robot_pose"])})


def _sighting_record(sighting: Sighting) -> list[Any]:
    feature = base64.b64encode(np.ascontiguousarray(sighting.feature, "<f4").tobytes()).decode()
    box2 = sighting.box2
    return [
        sighting.frame_id,
        sighting.label,
        sighting.score,
        sighting.center.tolist(),
        sighting.box.tolist(),
        [box2.x0, box2.y0, box2.x1, box2.y1],
        sighting.mean_color.tolist(),
        feature,
        [list(voxel) for voxel in sighting.voxels],
    ]


def _sighting(item: list[Any]) -> Sighting:
    frame_id, label, score, center, box, box2, mean_color, feature, voxels = item
    return Sighting(
        frame_id=frame_id,
        label=label,
        score=score,
        center=np.array(center),
        box=np.array(box),
        box2=Box2(*box2),
        mean_color=np.array(mean_color),
        feature=np.frombuffer(base64.b64decode(feature), dtype="<f4").astype(np.float32),
        voxels=tuple((v[0], v[1], v[2]) for v in voxels),
    )
