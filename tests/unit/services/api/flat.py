"""A flat of three rooms held in memory, answering as the real clients do: what the api is tested against."""

from __future__ import annotations

import asyncio
import io
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ovip.errors import InvalidInput, NotFound, OvipError
from ovip.scene.answers import (
    Answer,
    Candidate,
    Coverage,
    FrameRecord,
    GatewayStatus,
    Goal,
    Outcome,
    PerceptionStatus,
    Query,
    RegionCoverage,
    SceneSummary,
    SearchEvent,
    TierReport,
    TierResult,
    TierStarted,
)
from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.navigation import Route, plan_route
from ovip.scene.route_graph import RouteGraph, route_graph
from ovip.scene.types import (
    F32,
    F64,
    U8,
    Box2,
    EdgeKind,
    Floor,
    Frontier,
    Intrinsics,
    MapDelta,
    MapObject,
    Partition,
    Region,
    RegionEdge,
    RegionEvent,
    SceneMap,
)
from services.api.ports import Backends

SCENE = "flat"
CAMERA = Intrinsics(585.0, 585.0, 320.0, 240.0, 640, 480)
Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0.5], [0, 0, 0, 1]])
"""world_from_source of a recording whose y points up, half a metre below the world's origin."""

_ROOMS = {
    "r-living": ("living room", "living room", (0.0, 0.0, 4.9, 6.0)),
    "r-kitchen": ("kitchen", "kitchen", (5.0, 3.0, 8.0, 6.0)),
    "r-bath": ("bathroom", "bathroom", (5.0, 0.0, 8.0, 2.9)),
}
_THINGS = [
    ("sofa", "r-living", (1.0, 0.4, 0.0, 3.2, 1.3, 0.8), (96, 124, 110)),
    ("coffee table", "r-living", (1.5, 2.0, 0.0, 2.7, 2.7, 0.45), (150, 110, 70)),
    ("book", "r-living", (1.7, 2.2, 0.45, 1.95, 2.4, 0.5), (60, 80, 160)),
    ("remote", "r-living", (2.3, 2.3, 0.45, 2.5, 2.36, 0.48), (40, 40, 44)),
    ("television", "r-living", (1.3, 5.75, 0.6, 2.9, 5.9, 1.5), (30, 32, 36)),
    ("plant", "r-living", (0.2, 5.1, 0.0, 0.8, 5.7, 1.3), (70, 140, 70)),
    ("armchair", "r-living", (3.7, 2.2, 0.0, 4.5, 3.0, 0.9), (170, 90, 70)),
    ("dining table", "r-kitchen", (5.9, 3.7, 0.0, 7.1, 4.6, 0.75), (176, 140, 96)),
    ("chair", "r-kitchen", (5.4, 3.9, 0.0, 5.8, 4.4, 0.9), (110, 84, 60)),
    ("chair", "r-kitchen", (7.2, 3.9, 0.0, 7.6, 4.4, 0.9), (112, 86, 60)),
    ("mug", "r-kitchen", (6.2, 4.0, 0.75, 6.3, 4.1, 0.86), (236, 236, 232)),
    ("mug", "r-kitchen", (6.7, 4.2, 0.75, 6.8, 4.3, 0.86), (190, 60, 52)),
    ("bowl", "r-kitchen", (6.45, 4.3, 0.75, 6.65, 4.5, 0.84), (220, 190, 90)),
    ("refrigerator", "r-kitchen", (7.3, 5.2, 0.0, 7.95, 5.9, 1.8), (210, 214, 216)),
    ("sink", "r-bath", (5.3, 0.1, 0.6, 5.9, 0.6, 0.9), (230, 232, 236)),
    ("toilet", "r-bath", (7.3, 0.3, 0.0, 7.9, 0.9, 0.8), (238, 238, 238)),
    ("towel", "r-bath", (6.4, 2.75, 0.9, 6.9, 2.85, 1.5), (120, 150, 200)),
]


@dataclass
class Flat:
    """The flat's whole state; tests change it and see the api follow."""

    version: int = 12
    revision: int = 3
    events: tuple[RegionEvent, ...] = ()
    frontiers: tuple[Frontier, ...] = ()
    upstairs: bool = False
    objects: list[MapObject] = field(default_factory=list)
    regions: list[Region] = field(default_factory=list)
    records: list[FrameRecord] = field(default_factory=list)
    deltas: list[MapDelta] = field(default_factory=list)
    aliases: dict[str, str] = field(default_factory=dict)
    reachable: dict[str, bool] = field(
        default_factory=lambda: dict.fromkeys(
            ("perception", "mapper", "regions", "retrieval", "vlm_gateway"), True
        )
    )
    broken: OvipError | None = None
    tier_pause_s: float = 0.0
    points_asked: list[tuple[str, ...]] = field(default_factory=list)
    queries: list[Query] = field(default_factory=list)
    empty: bool = False
    _changed: asyncio.Event = field(default_factory=asyncio.Event)

    def grow(self, label: str, box: Sequence[float], region_id: str) -> MapObject:
        """A new object, one map version later."""
        self.version += 1
        obj = thing(f"o-{len(self.objects) + 1:03d}", label, box, (80, 60, 140), self.version)
        self.objects.append(obj)
        self.regions = [
            replace(region, object_ids=(*region.object_ids, obj.object_id))
            if region.region_id == region_id
            else region
            for region in self.regions
        ]
        self.deltas.append(
            MapDelta(
                self.version,
                self.records[-1].frame_id,
                created=(obj.object_id,),
                updated=("o-001",),
                aliases={"o-900": "o-001"},
            )
        )
        self._changed.set()
        self._changed = asyncio.Event()
        return obj

    def cut_anew(self, *events: RegionEvent) -> None:
        """The next revision of the regions, as they are now, with what changed."""
        self.revision += 1
        self.events = events
        self._changed.set()
        self._changed = asyncio.Event()

    def fail(self, error: OvipError) -> None:
        """From now on every service answers with `error`, and streams end in it."""
        self.broken = error
        self._changed.set()
        self._changed = asyncio.Event()

    def partition(self) -> Partition:
        """As regions would answer: revision 0 and nothing in it where there are no regions."""
        if not self.regions:
            return Partition(0, 0)
        door = RegionEdge("r-kitchen", "r-living", 0.9, np.array([4.95, 4.05, 0.0]), EdgeKind.DOORWAY)
        stairs = RegionEdge(
            "r-living", "r-attic", 0.8, np.array([0.6, 3.2, 0.0]), EdgeKind.STAIRS, np.array([3.0, 3.2, 2.7])
        )
        ground, above = Floor(0, 0.0, 2.5, 47.1), Floor(1, 2.7, None, 20.0)
        return Partition(
            11,
            self.revision,
            (ground, above) if self.upstairs else (ground,),
            (*self.regions, attic()) if self.upstairs else tuple(self.regions),
            (door, stairs) if self.upstairs else (door,),
            ("grouping: function table, no VLM configured",),
            self.frontiers,
            self.events,
        )

    async def change(self) -> None:
        """Returns when the map grows."""
        await self._changed.wait()

    def check(self, scene: str) -> None:
        if self.broken:
            raise self.broken
        if scene != SCENE:
            raise NotFound(f"scene {scene!r}: no such scene")


def flat() -> Flat:
    """The flat as it stands when a test begins."""
    objects = [thing(f"o-{i + 1:03d}", *_thing_args(row)) for i, row in enumerate(_THINGS)]
    regions = [
        Region(
            region_id=region_id,
            floor=0,
            function=function,
            display_name=name,
            area=(x1 - x0) * (y1 - y0),
            centroid=np.array([(x0 + x1) / 2, (y0 + y1) / 2, 0.0]),
            outlines=(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]),),
            holes=(),
            object_ids=tuple(
                o.object_id for o, row in zip(objects, _THINGS, strict=True) if row[1] == region_id
            ),
            frame_ids=("robot.walk.1",),
        )
        for region_id, (function, name, (x0, y0, x1, y1)) in _ROOMS.items()
    ]
    return Flat(
        objects=objects,
        regions=regions,
        records=[frame_record(i) for i in range(1, 13)],
        deltas=[MapDelta(v, f"robot.walk.{v}", updated=("o-001",)) for v in range(1, 13)],
    )


def attic() -> Region:
    """The one region of the floor above, where there is one."""
    ring = np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0]])
    middle = np.array([2.5, 2.0, 2.7])
    return Region("r-attic", 1, "storage", "storage", 20.0, middle, (ring,), (), (), (), ("robot.walk.2",))


def attic_grid() -> FloorGrid:
    """5 m by 4 m of free floor with a wall around."""
    occupancy = np.full((84, 104), OCCUPIED, np.uint8)
    labels = np.zeros(occupancy.shape, np.uint16)
    occupancy[2:-2, 2:-2] = FREE
    labels[2:-2, 2:-2] = 1
    return FloorGrid(1, (-0.1, -0.1), 0.05, occupancy, labels, ("r-attic",), 3)


def thing(
    object_id: str, label: str, box: Sequence[float], color: tuple[int, int, int], version: int = 12
) -> MapObject:
    """A mapped object that fills its box."""
    bounds = np.array(box, dtype=np.float64)
    return MapObject(
        object_id=object_id,
        label=label,
        label_counts={label: 9, "thing": 2},
        centroid=(bounds[:3] + bounds[3:]) / 2,
        box=bounds,
        feature=np.array([1.0, 0.0], dtype=np.float32),
        view_weight=4.5,
        observations=11,
        frames=9,
        first_seen_ns=1_700_000_000_000_000_000,
        last_seen_ns=1_700_000_009_000_000_000,
        voxels=120,
        mean_color=np.array(color, dtype=np.float64),
        best_frame_id="robot.walk.3",
        best_box2=Box2(240.0, 180.0, 380.0, 320.0),
        version=version,
    )


def frame_record(sequence: int) -> FrameRecord:
    """A camera on a walk through the living room into the kitchen, 1.2 m above the floor."""
    t = (sequence - 1) / 11
    yaw = 0.5 * np.sin(3 * t)
    forward, right = np.array([np.cos(yaw), np.sin(yaw), 0.0]), np.array([np.sin(yaw), -np.cos(yaw), 0.0])
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, [0, 0, -1.0], forward])
    pose[:3, 3] = [0.8 + 4.6 * t, 3.6 + 0.5 * np.sin(4 * t), 1.2]
    return FrameRecord(
        f"robot.walk.{sequence}",
        1_700_000_000_000_000_000 + sequence,
        pose,
        CAMERA,
        ("mug",),
        True,
        f"{sequence}-0",
    )


def frame_image(frame_id: str) -> bytes:
    """A JPEG that shows which frame it is and where the boxes of the objects lie."""
    ramp = np.linspace(90, 200, CAMERA.width, dtype=np.uint8)
    picture = Image.fromarray(np.dstack([np.tile(ramp, (CAMERA.height, 1))] * 3))
    draw = ImageDraw.Draw(picture)
    draw.ellipse((250, 190, 370, 310), fill=(236, 236, 232), outline=(60, 60, 60), width=4)
    draw.text((20, 20), frame_id, font=ImageFont.load_default(24), fill=(255, 255, 255))
    stream = io.BytesIO()
    picture.save(stream, format="JPEG")
    return stream.getvalue()


def cloud_of(obj: MapObject) -> tuple[F32, U8]:
    """Points on the faces of the object's box, one a voxel, and its colour with some noise."""
    rng = np.random.default_rng(int(obj.object_id[2:]))
    points = rng.uniform(obj.box[:3], obj.box[3:], (obj.voxels, 3))
    axis = rng.integers(0, 3, obj.voxels)
    side = np.where(rng.random(obj.voxels) < 0.5, obj.box[:3][axis], obj.box[3:][axis])
    points[np.arange(obj.voxels), axis] = side
    colors = np.clip(obj.mean_color + rng.normal(0, 10, (obj.voxels, 3)), 0, 255)
    return points.astype(np.float32), colors.astype(np.uint8)


def grid() -> FloorGrid:
    """Three rooms with walls between them, doors at x = 5, furniture as occupied cells."""
    resolution, origin = 0.05, (-0.5, -0.5)
    occupancy = np.zeros((140, 180), dtype=np.uint8)
    labels = np.zeros(occupancy.shape, dtype=np.uint16)

    def cells(x0: float, y0: float, x1: float, y1: float) -> tuple[slice, slice]:
        return (
            slice(round((y0 - origin[1]) / resolution), round((y1 - origin[1]) / resolution)),
            slice(round((x0 - origin[0]) / resolution), round((x1 - origin[0]) / resolution)),
        )

    occupancy[cells(-0.1, -0.1, 8.1, 6.1)] = OCCUPIED
    for index, (_, _, room) in enumerate(_ROOMS.values()):
        occupancy[cells(*room)] = FREE
        labels[cells(*room)] = index + 1
    for y in (1.2, 3.6):
        occupancy[cells(4.9, y, 5.0, y + 0.9)] = FREE
    for _, _, box, _ in _THINGS:
        if box[2] < 0.3:
            occupancy[cells(box[0], box[1], box[3], box[4])] = OCCUPIED
    return FloorGrid(0, origin, resolution, occupancy, labels, tuple(_ROOMS), 3)


def backends_of(state: Flat) -> Backends:
    """The flat behind the api's ports."""
    mapper = _Mapper(state)
    return Backends(
        frames=_Perception(state),
        objects=mapper,
        map_log=mapper,
        regions=_Regions(state),
        searches=_Retrieval(state),
        gateway=_Gateway(),
        readiness=_Reachable(state),
    )


class _Perception:
    def __init__(self, state: Flat) -> None:
        self._state = state

    async def list_frames(
        self, scene: str, after: str = "", limit: int = 0
    ) -> tuple[list[FrameRecord], dict[str, F32]]:
        self._state.check(scene)
        start = int(after.split("-")[0]) if after else 0
        later = [record for record in self._state.records if int(record.log_id.split("-")[0]) > start]
        return later[: limit or 1000], {}

    async def get_rgb(self, scene: str, frame_id: str) -> bytes:
        self._state.check(scene)
        if frame_id not in {record.frame_id for record in self._state.records}:
            raise NotFound(f"frame {frame_id!r}: no such frame")
        return frame_image(frame_id)

    async def status(self, scene: str) -> PerceptionStatus:
        self._state.check(scene)
        return PerceptionStatus(12, 12, 0, ("mug", "sofa"), Y_UP, "embedded", "minilm-384", 140)


class _Mapper:
    def __init__(self, state: Flat) -> None:
        self._state = state

    async def list_scenes(self) -> list[SceneSummary]:
        state = self._state
        if state.broken:
            raise state.broken
        if state.empty:
            return []
        return [SceneSummary(SCENE, state.version, len(state.objects), len(state.records), 140)]

    async def get_map(self, scene: str, include_unconfirmed: bool = False) -> SceneMap:
        self._state.check(scene)
        return SceneMap(SCENE, self._state.version, tuple(self._state.objects), "ab" * 32, 12, 140, "12-0")

    async def get_object(self, scene: str, object_id: str) -> MapObject:
        self._state.check(scene)
        survivor = self._state.aliases.get(object_id, object_id)
        for obj in self._state.objects:
            if obj.object_id == survivor:
                return obj
        raise NotFound(f"object {object_id!r}: no such object in {scene}")

    async def get_points(
        self, scene: str, object_ids: Sequence[str] = (), max_points: int = 0
    ) -> dict[str, tuple[F32, U8]]:
        self._state.check(scene)
        self._state.points_asked.append(tuple(object_ids))
        wanted = [obj for obj in self._state.objects if not object_ids or obj.object_id in object_ids]
        clouds = {obj.object_id: cloud_of(obj) for obj in wanted}
        total = sum(len(points) for points, _ in clouds.values())
        step = -(-total // max_points) if max_points else 1
        return {name: (points[::step], colors[::step]) for name, (points, colors) in clouds.items()}

    async def watch(self, scene: str, after_version: int) -> AsyncIterator[MapDelta]:
        self._state.check(scene)
        while True:
            changed = asyncio.create_task(self._state.change())
            try:
                for delta in self._state.deltas:
                    if delta.version > after_version:
                        after_version = delta.version
                        yield delta
                await changed
            finally:
                changed.cancel()


class _Regions:
    def __init__(self, state: Flat) -> None:
        self._state = state

    async def get_partition(self, scene: str) -> Partition:
        self._state.check(scene)
        return self._state.partition()

    async def watch(self, scene: str, after_revision: int = 0) -> AsyncIterator[Partition]:
        while True:
            self._state.check(scene)
            changed = asyncio.create_task(self._state.change())
            try:
                if self._state.revision > after_revision and self._state.regions:
                    after_revision = self._state.revision
                    yield self._state.partition()
                await changed
            finally:
                changed.cancel()

    async def get_floor_grid(self, scene: str, floor: int) -> FloorGrid:
        self._state.check(scene)
        if floor == 1 and self._state.upstairs:
            return attic_grid()
        if floor != 0:
            raise NotFound(f"floor {floor}: expected one of 0")
        return grid()

    async def plan_route(self, scene: str, start: F64, goal: F64, robot_radius: float = 0.0) -> Route:
        self._state.check(scene)
        return plan_route(self._state.partition(), {0: grid()}, start, goal, robot_radius or 0.25)

    async def get_route_graph(self, scene: str, robot_radius: float = 0.0) -> RouteGraph:
        self._state.check(scene)
        return route_graph(self._state.partition(), {0: grid()}, robot_radius or 0.25)


class _Retrieval:
    """Says of each word what the test needs: the real cascade has its own tests."""

    def __init__(self, state: Flat) -> None:
        self._state = state
        self._done: dict[str, tuple[str, Answer]] = {}

    async def find(self, query: Query) -> AsyncIterator[tuple[str, SearchEvent]]:
        self._state.check(query.scene)
        self._state.queries.append(query)
        if query.text == "refuse":
            raise InvalidInput("text: expected a thing to look for")
        answer = self._answer(query.text)
        for report in answer.tiers:
            yield "s-1", TierStarted(report.tier)
            await asyncio.sleep(self._state.tier_pause_s)
            yield "s-1", report
        if query.text == "silence":
            return
        self._done["s-1"] = (query.text, answer)
        yield "s-1", answer

    async def get_search(self, scene: str, search_id: str) -> tuple[str, bool, Answer | None]:
        self._state.check(scene)
        if search_id not in self._done:
            raise NotFound(f"search {search_id!r}: no such search")
        text, answer = self._done[search_id]
        return text, True, answer

    def _answer(self, text: str) -> Answer:
        word = text.split()[-1]
        matches = [obj for obj in self._state.objects if obj.label == word]
        if not matches:
            return _unresolved()
        if len(matches) == 1:
            return _found(matches, 1)
        return _found(matches, 2)


def _found(matches: list[MapObject], tier: int) -> Answer:
    best, *others = [_candidate(obj, 0.93 - 0.3 * i) for i, obj in enumerate(matches)]
    tiers = [TierReport(1, TierResult.FOUND, f"one object is called {best.label}", 0, 0.8)]
    if tier == 2:
        tiers = [
            TierReport(1, TierResult.AMBIGUOUS, f"{len(matches)} objects are called {best.label}", 0, 0.8),
            TierReport(2, TierResult.FOUND, "its mapped colour is nearest to white", 0, 12.4),
        ]
    stand = best.position - [0.0, 0.9, 0.0]
    path = np.array([[5.4, 3.2, 0.0], [5.6, 3.3, 0.0], [float(stand[0]), 3.3, 0.0]])
    return Answer(
        outcome=Outcome.FOUND,
        tier=tier,
        object=best,
        goal=Goal(np.array([float(stand[0]), 3.3, 0.0]), np.pi / 2),
        path=path,
        tiers=tuple(tiers),
        candidates=tuple(others),
        fallbacks=("attributes: mapped colour, no VLM configured",) if tier == 2 else (),
        map_version=12,
        regions_revision=3,
    )


def _unresolved() -> Answer:
    tiers = tuple(
        TierReport(tier, result, why, 0, 3.0 * tier)
        for tier, result, why in (
            (1, TierResult.MISSING, "no mapped object has this name or looks like it"),
            (2, TierResult.MISSING, "no frame has a tag close to it (best 0.21, needed 0.6)"),
            (3, TierResult.MISSING, "the detector has no such word"),
            (4, TierResult.WAITING, "18 viewpoints planned in 3 regions"),
        )
    )
    regions = tuple(
        RegionCoverage(region_id, name, 20.0, 0.0, prior)
        for (region_id, (_, name, _)), prior in zip(_ROOMS.items(), (0.6, 0.2, 0.05), strict=True)
    )
    return Answer(
        outcome=Outcome.UNRESOLVED,
        tier=4,
        object=None,
        goal=None,
        path=np.zeros((0, 3)),
        tiers=tiers,
        rejected=(Candidate("television", np.array([2.1, 5.8, 1.0]), 0.31, "looks like a television"),),
        fallbacks=("prior: function table, no VLM configured",),
        map_version=12,
        regions_revision=3,
        coverage=Coverage(18, 0, 0, regions, 0.38, False),
        needs="a robot that visits 18 viewpoints, living room first",
    )


def _candidate(obj: MapObject, score: float) -> Candidate:
    return Candidate(
        obj.label, obj.centroid, score, "same name", obj.object_id, obj.box, obj.best_frame_id, obj.best_box2
    )


class _Gateway:
    async def status(self) -> GatewayStatus:
        return GatewayStatus(False)


class _Reachable:
    def __init__(self, state: Flat) -> None:
        self._state = state

    async def reachable(self) -> Mapping[str, bool]:
        return self._state.reachable


def _thing_args(
    row: tuple[str, str, tuple[float, ...], tuple[int, int, int]],
) -> tuple[str, Sequence[float], tuple[int, int, int]]:
    label, _, box, color = row
    return label, box, color
