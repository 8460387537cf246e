"""What the REST interface takes and gives, as pydantic models: the OpenAPI document is made of these.

Metres, radians, nanoseconds since the epoch. `frame` names the frame of reference of all positions in a body:
"world" (z up) or "source" (the recording's own).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

Point = Annotated[list[float], Field(min_length=3, max_length=3, description="x, y, z, metres")]
Ring = Annotated[
    list[list[float]], Field(description="closed polygon: x, y (world) or x, y, z (source), metres")
]
BoxList = Annotated[
    list[float],
    Field(
        min_length=6,
        max_length=6,
        description="low corner, then high corner, metres; in the source frame bounds of the turned box",
    ),
]
Box2List = Annotated[
    list[float], Field(min_length=4, max_length=4, description="x0, y0, x1, y1, pixels, half-open")
]
Matrix4 = Annotated[
    list[Annotated[list[float], Field(min_length=4, max_length=4)]], Field(min_length=4, max_length=4)
]
FrameOfReference = Literal["world", "source"]


class _Body(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Problem(BaseModel):
    """RFC 9457 problem details."""

    type: str = Field(description="urn:ovip:problem:SLUG")
    title: str
    status: int
    detail: str = Field(description="what was wrong and what was expected")


class Health(_Body):
    status: Literal["ok"] = "ok"


class Ready(_Body):
    status: Literal["ready"] = "ready"
    services: dict[str, bool]


class VlmStatus(_Body):
    configured: bool
    routes: list[str]
    calls: int
    cache_hits: int
    refused: int


class SystemStatus(_Body):
    services: dict[str, bool] = Field(description="service -> whether it can be reached now")
    vlm: VlmStatus | None = Field(description="null where the gateway cannot be reached")


class Scene(_Body):
    scene: str
    map_version: int
    objects: int
    frames: int
    detections: int


class SceneList(_Body):
    scenes: list[Scene]


class SceneDetail(Scene):
    frames_durable: int = Field(description="frames received for good")
    frames_processed: int
    frames_skipped: int
    vocabulary: list[str] = Field(description="words admitted by the gate")
    backend: str = Field(description="the models in use")
    feature_space: str
    world_from_source: Matrix4 = Field(description="4x4: took the recording's own frame to the z-up world")
    regions_revision: int
    regions: int
    floors: int


class ObjectRelation(_Body):
    kind: Literal["on", "in", "next_to", "attached_to"]
    object_id: str = Field(description="the other object")
    evidence: dict[str, float | None] = Field(description="what was measured, by name: metres or shares")


class ObjectMove(_Body):
    timestamp_ns: int
    position: Point


class MappedObject(_Body):
    id: str
    label: str
    position: Point
    box: BoxList
    label_counts: dict[str, int] = Field(
        description="label -> how often it was merged in, most frequent first"
    )
    observations: int
    frames: int
    first_seen_ns: int
    last_seen_ns: int
    voxels: int
    mean_color: list[float] = Field(description="red, green, blue, 0..255")
    view_weight: float | None
    frame_id: str | None = Field(description="the frame that saw it best")
    box2: Box2List | None = Field(description="where it is in that frame")
    version: int = Field(description="map version of its last change")
    revision: int = Field(description="map version at which it was last born, moved, given up or edited")
    presence: Literal["present", "moved_or_removed"] = Field(
        description="moved_or_removed: later depth saw through the place where it was"
    )
    pinned: bool = Field(description="upkeep neither merges it away nor gives it up")
    label_given: bool = Field(description="the label is an operator's")
    relations: list[ObjectRelation]
    moves: list[ObjectMove] = Field(
        description="where it was before it was recognised elsewhere, oldest first"
    )


class ObjectPage(_Body):
    map_version: int
    frame: FrameOfReference
    objects: list[MappedObject]
    next_cursor: str | None = Field(description="null on the last page")


class ObjectReply(_Body):
    frame: FrameOfReference
    object: MappedObject


class Floor(_Body):
    floor: int
    z: float | None
    ceiling_z: float | None = Field(description="null where no ceiling was seen")
    area: float | None


class Region(_Body):
    region_id: str
    floor: int
    function: str
    display_name: str
    area: float | None = Field(description="square metres of floor")
    centroid: Point
    outlines: list[Ring]
    holes: list[Ring]
    object_ids: list[str]
    frames: int = Field(description="how many frames were taken from it")
    seen_by: list[str] = Field(description="ids of the frames that see most of its floor, best first")
    color: str = Field(description="a colour to draw it in, #rrggbb; all pictures of the api use the same")


class RegionEdge(_Body):
    """How two regions are joined; stairs by `position`, their foot, in a, and `upper`, their head, in b."""

    a: str
    b: str
    kind: Literal["opening", "doorway", "stairs"] = Field(
        description="a border without a wall, a passage as narrow as a door, or stairs"
    )
    width: float | None
    position: Point
    upper: Point | None = Field(description="stairs only: their head")


class Frontier(_Body):
    """Where the floor that was seen ends at what never was."""

    floor: int
    region_id: str | None
    position: Point
    width: float | None = Field(description="metres along it")


class RegionEvent(_Body):
    kind: Literal["appeared", "vanished", "retyped", "reshaped"]
    region_id: str
    floor: int
    display_name: str = Field(description="now; of a vanished region, its last")
    other: str = Field(
        description="appeared: the region that most of its floor was; vanished: what most of it is now"
    )


class RegionList(_Body):
    map_version: int = Field(description="the map version the regions were cut from")
    regions_revision: int = Field(description="0 before the first partition")
    frame: FrameOfReference
    floors: list[Floor]
    regions: list[Region]
    edges: list[RegionEdge]
    frontiers: list[Frontier]
    events: list[RegionEvent] = Field(description="what changed since the revision before")
    fallbacks: list[str]


class GraphObject(_Body):
    id: str
    label: str
    position: Point
    box: BoxList


class GraphRegion(_Body):
    region_id: str
    floor: int
    function: str
    display_name: str
    area: float | None
    centroid: Point
    outlines: list[Ring]
    holes: list[Ring]
    frames: int
    seen_by: list[str]
    color: str
    objects: list[GraphObject]


class GraphFloor(Floor):
    regions: list[GraphRegion]


class Graph(_Body):
    map_version: int
    regions_revision: int
    frame: FrameOfReference
    floors: list[GraphFloor]
    edges: list[RegionEdge]
    frontiers: list[Frontier]
    events: list[RegionEvent] = Field(description="what changed since the revision before")
    unplaced: list[GraphObject] = Field(description="objects that no region holds")
    fallbacks: list[str]


class ExportedObject(MappedObject):
    region_id: str | None
    floor: int | None


class SceneGraph(_Body):
    format: Literal["ovip-scene-graph"]
    format_version: Literal[1]
    scene: str
    state_hash: str
    map_version: int
    regions_map_version: int
    regions_revision: int
    frame: FrameOfReference
    floors: list[Floor]
    regions: list[Region]
    edges: list[RegionEdge]
    frontiers: list[Frontier]
    events: list[RegionEvent] = Field(description="what changed since the revision before")
    fallbacks: list[str]
    objects: list[ExportedObject]


class MultiPolygon(_Body):
    type: Literal["MultiPolygon"]
    coordinates: list[list[list[list[float]]]] = Field(
        description="polygons of closed rings of x, y in metres: the outline counter-clockwise, then holes clockwise"
    )


class PolygonProperties(_Body):
    id: str
    floor: int
    z: float | None = Field(description="height of the floor, metres")
    function: str
    display_name: str
    area: float | None = Field(description="square metres")
    object_ids: list[str]
    color: str


class PolygonFeature(_Body):
    type: Literal["Feature"]
    id: str
    geometry: MultiPolygon
    properties: PolygonProperties


class FloorHeight(_Body):
    floor: int
    z: float | None


class RegionPolygons(_Body):
    """Laid out as GeoJSON, but in metres of the scene's world."""

    type: Literal["FeatureCollection"]
    scene: str
    map_version: int
    regions_revision: int
    frame: Literal["world"]
    unit: Literal["metre"]
    floors: list[FloorHeight]
    features: list[PolygonFeature]


class Camera(_Body):
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int


class FrameItem(_Body):
    frame_id: str
    timestamp_ns: int
    position: Point = Field(description="of the camera")
    region_id: str | None = Field(description="taken in this region; null before it is placed")
    pose: Matrix4 = Field(description="4x4 that takes camera coordinates to `frame`")
    intrinsics: Camera
    tags: list[str]
    processed: bool


class FramePage(_Body):
    frame: FrameOfReference
    frames: list[FrameItem] = Field(description="in order of arrival, oldest first")
    next_cursor: str | None = Field(description="null on the last page")
    end_cursor: str | None = Field(
        description="where this page ends: asked for later, it gives what came since"
    )


class Grid(_Body):
    floor: int
    origin: list[float] = Field(description="world x, y of the outer corner of cell (0, 0)")
    resolution: float = Field(description="side of a cell, metres")
    rows: int = Field(description="rows grow with y")
    columns: int = Field(description="columns grow with x")
    revision: int
    region_ids: list[str] = Field(description="value v > 0 in the regions image is region_ids[v - 1]")
    occupancy_png: str = Field(description="path of an 8-bit grey PNG, first row = row 0")
    occupancy_values: dict[str, int] = Field(description="what its grey values mean")
    regions_png: str = Field(description="path of a 16-bit grey PNG, first row = row 0")


class RobotBody(_Body):
    """The robot that asks. Its pose is in the frame of reference that the request names."""

    pose: Matrix4 | None = Field(
        None, description="4x4 that takes camera coordinates to `frame`; null: that of the newest frame"
    )
    radius: float | None = Field(None, gt=0, le=5, description="metres; null: the service's default")


class QueryBody(_Body):
    """A question about where something is."""

    text: Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=500)] = Field(
        examples=["white mug", "something to charge my phone"]
    )
    robot: RobotBody | None = None
    region_hint: str = Field(
        "", max_length=200, description="narrows the search to regions that match, e.g. kitchen"
    )
    min_tier: int | None = Field(
        None, ge=1, le=4, description="lowest tier to run; 4 forces the active search"
    )
    max_tier: int | None = Field(None, ge=1, le=4, description="highest tier to run")
    max_vlm_calls: int | None = Field(None, ge=1, le=10_000)
    max_viewpoints: int | None = Field(None, ge=1, le=100_000)


class TierReport(_Body):
    tier: int
    result: Literal["found", "ambiguous", "missing", "rejected", "skipped", "waiting", "exhausted"]
    why: str
    vlm_calls: int
    ms: float


class Candidate(_Body):
    id: str | None = Field(description="null where it is not a mapped object")
    label: str
    position: Point
    box: BoxList | None
    score: float | None
    why: str = Field(description="what spoke for or against it")
    frame_id: str | None = Field(description="where it is best seen")
    box2: Box2List | None


class Goal(_Body):
    position: Point = Field(description="standoff position on the floor")
    yaw: float | None = Field(description="radians about the world's z; null in the source frame")
    facing: Point = Field(description="unit vector to face")


class RegionCoverage(_Body):
    region_id: str
    display_name: str
    area: float | None
    seen: float | None = Field(description="share of its floor seen, 0..1")
    prior: float | None = Field(description="S(goal | region), 0..1")


class Coverage(_Body):
    planned: int
    visited: int
    unreachable: int
    regions: list[RegionCoverage]
    posterior_present: float | None = Field(description="P(present | everything seen)")
    complete: bool = Field(description="every planned viewpoint was visited")


class Answer(_Body):
    outcome: Literal["found", "absent", "unresolved"]
    tier: int = Field(description="the tier that decided")
    object: Candidate | None
    goal: Goal | None
    path: list[Point] = Field(description="floor positions from the robot to the goal; may be empty")
    tiers: list[TierReport]
    candidates: list[Candidate] = Field(description="ranked, best first")
    rejected: list[Candidate]
    fallbacks: list[str] = Field(description="what stood in for a VLM that is not configured")
    map_version: int
    regions_revision: int
    coverage: Coverage | None
    needs: str = Field(
        description="what would decide an unresolved query; of an absent one, what in reach nobody has seen"
    )
    search_id: str
    frame: FrameOfReference


class Search(_Body):
    search_id: str
    text: str
    done: bool
    answer: Answer | None


class Passage(_Body):
    kind: Literal["opening", "doorway", "stairs"]
    a: str = Field(description="region; of stairs, the lower one")
    b: str = Field(description="region; of stairs, the upper one")
    width: float | None = Field(description="metres")
    position: Point = Field(description="the middle of the opening; of stairs, their foot")
    upper: Point | None = Field(description="the head of stairs; null for what is none")


class Route(_Body):
    frame: FrameOfReference
    path: list[Point] = Field(description="corners of the way on the floor; none where there is no way")
    length: float | None = Field(description="metres walked")
    region_ids: list[str] = Field(description="in the order they are walked through")
    passages: list[Passage] = Field(description="in the order they are passed")
    why: str = Field(description="why there is no way; empty where there is one")
    regions_revision: int


class RouteNode(_Body):
    node: int
    floor: int
    position: Point = Field(description="where the robot can stand in the passage")
    passage: Passage


class RouteLink(_Body):
    a: int = Field(description="number of a node")
    b: int
    region_id: str | None = Field(description="the region that is walked through; null for stairs")
    length: float | None = Field(description="metres walked")


class RouteGraph(_Body):
    frame: FrameOfReference
    nodes: list[RouteNode] = Field(description="stairs have one on each of their two floors")
    links: list[RouteLink]
    regions_revision: int
