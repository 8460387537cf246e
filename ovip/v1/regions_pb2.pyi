from ovip.v1 import types_pb2 as _types_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class RegionEdgeKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    REGION_EDGE_KIND_UNSPECIFIED: _ClassVar[RegionEdgeKind]
    REGION_EDGE_KIND_OPENING: _ClassVar[RegionEdgeKind]
    REGION_EDGE_KIND_DOORWAY: _ClassVar[RegionEdgeKind]
    REGION_EDGE_KIND_STAIRS: _ClassVar[RegionEdgeKind]

class RegionEventKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    REGION_EVENT_KIND_UNSPECIFIED: _ClassVar[RegionEventKind]
    REGION_EVENT_KIND_APPEARED: _ClassVar[RegionEventKind]
    REGION_EVENT_KIND_VANISHED: _ClassVar[RegionEventKind]
    REGION_EVENT_KIND_RETYPED: _ClassVar[RegionEventKind]
    REGION_EVENT_KIND_RESHAPED: _ClassVar[RegionEventKind]
REGION_EDGE_KIND_UNSPECIFIED: RegionEdgeKind
REGION_EDGE_KIND_OPENING: RegionEdgeKind
REGION_EDGE_KIND_DOORWAY: RegionEdgeKind
REGION_EDGE_KIND_STAIRS: RegionEdgeKind
REGION_EVENT_KIND_UNSPECIFIED: RegionEventKind
REGION_EVENT_KIND_APPEARED: RegionEventKind
REGION_EVENT_KIND_VANISHED: RegionEventKind
REGION_EVENT_KIND_RETYPED: RegionEventKind
REGION_EVENT_KIND_RESHAPED: RegionEventKind

class Region(_message.Message):
    __slots__ = ("region_id", "floor", "function", "display_name", "area", "centroid", "outlines", "holes", "object_ids", "frame_ids", "seen_by")
    REGION_ID_FIELD_NUMBER: _ClassVar[int]
    FLOOR_FIELD_NUMBER: _ClassVar[int]
    FUNCTION_FIELD_NUMBER: _ClassVar[int]
    DISPLAY_NAME_FIELD_NUMBER: _ClassVar[int]
    AREA_FIELD_NUMBER: _ClassVar[int]
    CENTROID_FIELD_NUMBER: _ClassVar[int]
    OUTLINES_FIELD_NUMBER: _ClassVar[int]
    HOLES_FIELD_NUMBER: _ClassVar[int]
    OBJECT_IDS_FIELD_NUMBER: _ClassVar[int]
    FRAME_IDS_FIELD_NUMBER: _ClassVar[int]
    SEEN_BY_FIELD_NUMBER: _ClassVar[int]
    region_id: str
    floor: int
    function: str
    display_name: str
    area: float
    centroid: _types_pb2.Vector3
    outlines: _containers.RepeatedCompositeFieldContainer[_types_pb2.Polygon]
    holes: _containers.RepeatedCompositeFieldContainer[_types_pb2.Polygon]
    object_ids: _containers.RepeatedScalarFieldContainer[str]
    frame_ids: _containers.RepeatedScalarFieldContainer[str]
    seen_by: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, region_id: _Optional[str] = ..., floor: _Optional[int] = ..., function: _Optional[str] = ..., display_name: _Optional[str] = ..., area: _Optional[float] = ..., centroid: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., outlines: _Optional[_Iterable[_Union[_types_pb2.Polygon, _Mapping]]] = ..., holes: _Optional[_Iterable[_Union[_types_pb2.Polygon, _Mapping]]] = ..., object_ids: _Optional[_Iterable[str]] = ..., frame_ids: _Optional[_Iterable[str]] = ..., seen_by: _Optional[_Iterable[str]] = ...) -> None: ...

class RegionEdge(_message.Message):
    __slots__ = ("a", "b", "width", "position", "kind", "upper")
    A_FIELD_NUMBER: _ClassVar[int]
    B_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    KIND_FIELD_NUMBER: _ClassVar[int]
    UPPER_FIELD_NUMBER: _ClassVar[int]
    a: str
    b: str
    width: float
    position: _types_pb2.Vector3
    kind: RegionEdgeKind
    upper: _types_pb2.Vector3
    def __init__(self, a: _Optional[str] = ..., b: _Optional[str] = ..., width: _Optional[float] = ..., position: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., kind: _Optional[_Union[RegionEdgeKind, str]] = ..., upper: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ...) -> None: ...

class Frontier(_message.Message):
    __slots__ = ("floor", "region_id", "position", "width")
    FLOOR_FIELD_NUMBER: _ClassVar[int]
    REGION_ID_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    floor: int
    region_id: str
    position: _types_pb2.Vector3
    width: float
    def __init__(self, floor: _Optional[int] = ..., region_id: _Optional[str] = ..., position: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., width: _Optional[float] = ...) -> None: ...

class RegionEvent(_message.Message):
    __slots__ = ("kind", "region_id", "floor", "display_name", "other")
    KIND_FIELD_NUMBER: _ClassVar[int]
    REGION_ID_FIELD_NUMBER: _ClassVar[int]
    FLOOR_FIELD_NUMBER: _ClassVar[int]
    DISPLAY_NAME_FIELD_NUMBER: _ClassVar[int]
    OTHER_FIELD_NUMBER: _ClassVar[int]
    kind: RegionEventKind
    region_id: str
    floor: int
    display_name: str
    other: str
    def __init__(self, kind: _Optional[_Union[RegionEventKind, str]] = ..., region_id: _Optional[str] = ..., floor: _Optional[int] = ..., display_name: _Optional[str] = ..., other: _Optional[str] = ...) -> None: ...

class FloorSummary(_message.Message):
    __slots__ = ("floor", "z", "ceiling_z", "area")
    FLOOR_FIELD_NUMBER: _ClassVar[int]
    Z_FIELD_NUMBER: _ClassVar[int]
    CEILING_Z_FIELD_NUMBER: _ClassVar[int]
    AREA_FIELD_NUMBER: _ClassVar[int]
    floor: int
    z: float
    ceiling_z: float
    area: float
    def __init__(self, floor: _Optional[int] = ..., z: _Optional[float] = ..., ceiling_z: _Optional[float] = ..., area: _Optional[float] = ...) -> None: ...

class Partition(_message.Message):
    __slots__ = ("map_version", "revision", "floors", "regions", "edges", "fallbacks", "frontiers", "events")
    MAP_VERSION_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    FLOORS_FIELD_NUMBER: _ClassVar[int]
    REGIONS_FIELD_NUMBER: _ClassVar[int]
    EDGES_FIELD_NUMBER: _ClassVar[int]
    FALLBACKS_FIELD_NUMBER: _ClassVar[int]
    FRONTIERS_FIELD_NUMBER: _ClassVar[int]
    EVENTS_FIELD_NUMBER: _ClassVar[int]
    map_version: int
    revision: int
    floors: _containers.RepeatedCompositeFieldContainer[FloorSummary]
    regions: _containers.RepeatedCompositeFieldContainer[Region]
    edges: _containers.RepeatedCompositeFieldContainer[RegionEdge]
    fallbacks: _containers.RepeatedScalarFieldContainer[str]
    frontiers: _containers.RepeatedCompositeFieldContainer[Frontier]
    events: _containers.RepeatedCompositeFieldContainer[RegionEvent]
    def __init__(self, map_version: _Optional[int] = ..., revision: _Optional[int] = ..., floors: _Optional[_Iterable[_Union[FloorSummary, _Mapping]]] = ..., regions: _Optional[_Iterable[_Union[Region, _Mapping]]] = ..., edges: _Optional[_Iterable[_Union[RegionEdge, _Mapping]]] = ..., fallbacks: _Optional[_Iterable[str]] = ..., frontiers: _Optional[_Iterable[_Union[Frontier, _Mapping]]] = ..., events: _Optional[_Iterable[_Union[RegionEvent, _Mapping]]] = ...) -> None: ...

class GetRegionsRequest(_message.Message):
    __slots__ = ("scene",)
    SCENE_FIELD_NUMBER: _ClassVar[int]
    scene: str
    def __init__(self, scene: _Optional[str] = ...) -> None: ...

class GetRegionsResponse(_message.Message):
    __slots__ = ("partition",)
    PARTITION_FIELD_NUMBER: _ClassVar[int]
    partition: Partition
    def __init__(self, partition: _Optional[_Union[Partition, _Mapping]] = ...) -> None: ...

class RecomputeRequest(_message.Message):
    __slots__ = ("scene",)
    SCENE_FIELD_NUMBER: _ClassVar[int]
    scene: str
    def __init__(self, scene: _Optional[str] = ...) -> None: ...

class RecomputeResponse(_message.Message):
    __slots__ = ("partition",)
    PARTITION_FIELD_NUMBER: _ClassVar[int]
    partition: Partition
    def __init__(self, partition: _Optional[_Union[Partition, _Mapping]] = ...) -> None: ...

class WatchRegionsRequest(_message.Message):
    __slots__ = ("scene", "after_revision")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    AFTER_REVISION_FIELD_NUMBER: _ClassVar[int]
    scene: str
    after_revision: int
    def __init__(self, scene: _Optional[str] = ..., after_revision: _Optional[int] = ...) -> None: ...

class WatchRegionsResponse(_message.Message):
    __slots__ = ("partition",)
    PARTITION_FIELD_NUMBER: _ClassVar[int]
    partition: Partition
    def __init__(self, partition: _Optional[_Union[Partition, _Mapping]] = ...) -> None: ...

class GetFloorGridRequest(_message.Message):
    __slots__ = ("scene", "floor", "robot_radius")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    FLOOR_FIELD_NUMBER: _ClassVar[int]
    ROBOT_RADIUS_FIELD_NUMBER: _ClassVar[int]
    scene: str
    floor: int
    robot_radius: float
    def __init__(self, scene: _Optional[str] = ..., floor: _Optional[int] = ..., robot_radius: _Optional[float] = ...) -> None: ...

class GetFloorGridResponse(_message.Message):
    __slots__ = ("floor", "origin_x", "origin_y", "resolution", "rows", "columns", "occupancy", "regions", "region_ids", "revision")
    FLOOR_FIELD_NUMBER: _ClassVar[int]
    ORIGIN_X_FIELD_NUMBER: _ClassVar[int]
    ORIGIN_Y_FIELD_NUMBER: _ClassVar[int]
    RESOLUTION_FIELD_NUMBER: _ClassVar[int]
    ROWS_FIELD_NUMBER: _ClassVar[int]
    COLUMNS_FIELD_NUMBER: _ClassVar[int]
    OCCUPANCY_FIELD_NUMBER: _ClassVar[int]
    REGIONS_FIELD_NUMBER: _ClassVar[int]
    REGION_IDS_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    floor: int
    origin_x: float
    origin_y: float
    resolution: float
    rows: int
    columns: int
    occupancy: bytes
    regions: bytes
    region_ids: _containers.RepeatedScalarFieldContainer[str]
    revision: int
    def __init__(self, floor: _Optional[int] = ..., origin_x: _Optional[float] = ..., origin_y: _Optional[float] = ..., resolution: _Optional[float] = ..., rows: _Optional[int] = ..., columns: _Optional[int] = ..., occupancy: _Optional[bytes] = ..., regions: _Optional[bytes] = ..., region_ids: _Optional[_Iterable[str]] = ..., revision: _Optional[int] = ...) -> None: ...

class PlanRouteRequest(_message.Message):
    __slots__ = ("scene", "start", "goal", "robot_radius")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    START_FIELD_NUMBER: _ClassVar[int]
    GOAL_FIELD_NUMBER: _ClassVar[int]
    ROBOT_RADIUS_FIELD_NUMBER: _ClassVar[int]
    scene: str
    start: _types_pb2.Vector3
    goal: _types_pb2.Vector3
    robot_radius: float
    def __init__(self, scene: _Optional[str] = ..., start: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., goal: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., robot_radius: _Optional[float] = ...) -> None: ...

class PlanRouteResponse(_message.Message):
    __slots__ = ("path", "length", "region_ids", "passages", "why", "revision")
    PATH_FIELD_NUMBER: _ClassVar[int]
    LENGTH_FIELD_NUMBER: _ClassVar[int]
    REGION_IDS_FIELD_NUMBER: _ClassVar[int]
    PASSAGES_FIELD_NUMBER: _ClassVar[int]
    WHY_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    path: _containers.RepeatedCompositeFieldContainer[_types_pb2.Vector3]
    length: float
    region_ids: _containers.RepeatedScalarFieldContainer[str]
    passages: _containers.RepeatedCompositeFieldContainer[RegionEdge]
    why: str
    revision: int
    def __init__(self, path: _Optional[_Iterable[_Union[_types_pb2.Vector3, _Mapping]]] = ..., length: _Optional[float] = ..., region_ids: _Optional[_Iterable[str]] = ..., passages: _Optional[_Iterable[_Union[RegionEdge, _Mapping]]] = ..., why: _Optional[str] = ..., revision: _Optional[int] = ...) -> None: ...

class GetRouteGraphRequest(_message.Message):
    __slots__ = ("scene", "robot_radius")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    ROBOT_RADIUS_FIELD_NUMBER: _ClassVar[int]
    scene: str
    robot_radius: float
    def __init__(self, scene: _Optional[str] = ..., robot_radius: _Optional[float] = ...) -> None: ...

class RouteNode(_message.Message):
    __slots__ = ("node", "passage", "floor", "position")
    NODE_FIELD_NUMBER: _ClassVar[int]
    PASSAGE_FIELD_NUMBER: _ClassVar[int]
    FLOOR_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    node: int
    passage: RegionEdge
    floor: int
    position: _types_pb2.Vector3
    def __init__(self, node: _Optional[int] = ..., passage: _Optional[_Union[RegionEdge, _Mapping]] = ..., floor: _Optional[int] = ..., position: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ...) -> None: ...

class RouteLink(_message.Message):
    __slots__ = ("a", "b", "region_id", "length")
    A_FIELD_NUMBER: _ClassVar[int]
    B_FIELD_NUMBER: _ClassVar[int]
    REGION_ID_FIELD_NUMBER: _ClassVar[int]
    LENGTH_FIELD_NUMBER: _ClassVar[int]
    a: int
    b: int
    region_id: str
    length: float
    def __init__(self, a: _Optional[int] = ..., b: _Optional[int] = ..., region_id: _Optional[str] = ..., length: _Optional[float] = ...) -> None: ...

class GetRouteGraphResponse(_message.Message):
    __slots__ = ("nodes", "links", "revision")
    NODES_FIELD_NUMBER: _ClassVar[int]
    LINKS_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    nodes: _containers.RepeatedCompositeFieldContainer[RouteNode]
    links: _containers.RepeatedCompositeFieldContainer[RouteLink]
    revision: int
    def __init__(self, nodes: _Optional[_Iterable[_Union[RouteNode, _Mapping]]] = ..., links: _Optional[_Iterable[_Union[RouteLink, _Mapping]]] = ..., revision: _Optional[int] = ...) -> None: ...
