from ovip.v1 import types_pb2 as _types_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class SceneSummary(_message.Message):
    __slots__ = ("scene", "map_version", "objects", "frames", "detections")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    MAP_VERSION_FIELD_NUMBER: _ClassVar[int]
    OBJECTS_FIELD_NUMBER: _ClassVar[int]
    FRAMES_FIELD_NUMBER: _ClassVar[int]
    DETECTIONS_FIELD_NUMBER: _ClassVar[int]
    scene: str
    map_version: int
    objects: int
    frames: int
    detections: int
    def __init__(self, scene: _Optional[str] = ..., map_version: _Optional[int] = ..., objects: _Optional[int] = ..., frames: _Optional[int] = ..., detections: _Optional[int] = ...) -> None: ...

class ListScenesRequest(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class ListScenesResponse(_message.Message):
    __slots__ = ("scenes",)
    SCENES_FIELD_NUMBER: _ClassVar[int]
    scenes: _containers.RepeatedCompositeFieldContainer[SceneSummary]
    def __init__(self, scenes: _Optional[_Iterable[_Union[SceneSummary, _Mapping]]] = ...) -> None: ...

class GetMapRequest(_message.Message):
    __slots__ = ("scene", "include_unconfirmed")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    INCLUDE_UNCONFIRMED_FIELD_NUMBER: _ClassVar[int]
    scene: str
    include_unconfirmed: bool
    def __init__(self, scene: _Optional[str] = ..., include_unconfirmed: bool = ...) -> None: ...

class GetMapResponse(_message.Message):
    __slots__ = ("scene", "version", "objects", "state_hash", "frames", "detections", "applied_log_id")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    VERSION_FIELD_NUMBER: _ClassVar[int]
    OBJECTS_FIELD_NUMBER: _ClassVar[int]
    STATE_HASH_FIELD_NUMBER: _ClassVar[int]
    FRAMES_FIELD_NUMBER: _ClassVar[int]
    DETECTIONS_FIELD_NUMBER: _ClassVar[int]
    APPLIED_LOG_ID_FIELD_NUMBER: _ClassVar[int]
    scene: str
    version: int
    objects: _containers.RepeatedCompositeFieldContainer[_types_pb2.MapObject]
    state_hash: str
    frames: int
    detections: int
    applied_log_id: str
    def __init__(self, scene: _Optional[str] = ..., version: _Optional[int] = ..., objects: _Optional[_Iterable[_Union[_types_pb2.MapObject, _Mapping]]] = ..., state_hash: _Optional[str] = ..., frames: _Optional[int] = ..., detections: _Optional[int] = ..., applied_log_id: _Optional[str] = ...) -> None: ...

class GetObjectRequest(_message.Message):
    __slots__ = ("scene", "object_id")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    scene: str
    object_id: str
    def __init__(self, scene: _Optional[str] = ..., object_id: _Optional[str] = ...) -> None: ...

class GetObjectResponse(_message.Message):
    __slots__ = ("object", "version")
    OBJECT_FIELD_NUMBER: _ClassVar[int]
    VERSION_FIELD_NUMBER: _ClassVar[int]
    object: _types_pb2.MapObject
    version: int
    def __init__(self, object: _Optional[_Union[_types_pb2.MapObject, _Mapping]] = ..., version: _Optional[int] = ...) -> None: ...

class GetObjectPointsRequest(_message.Message):
    __slots__ = ("scene", "object_ids", "max_points")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    OBJECT_IDS_FIELD_NUMBER: _ClassVar[int]
    MAX_POINTS_FIELD_NUMBER: _ClassVar[int]
    scene: str
    object_ids: _containers.RepeatedScalarFieldContainer[str]
    max_points: int
    def __init__(self, scene: _Optional[str] = ..., object_ids: _Optional[_Iterable[str]] = ..., max_points: _Optional[int] = ...) -> None: ...

class ObjectPoints(_message.Message):
    __slots__ = ("object_id", "points", "colors")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    POINTS_FIELD_NUMBER: _ClassVar[int]
    COLORS_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    points: bytes
    colors: bytes
    def __init__(self, object_id: _Optional[str] = ..., points: _Optional[bytes] = ..., colors: _Optional[bytes] = ...) -> None: ...

class GetObjectPointsResponse(_message.Message):
    __slots__ = ("version", "objects")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    OBJECTS_FIELD_NUMBER: _ClassVar[int]
    version: int
    objects: _containers.RepeatedCompositeFieldContainer[ObjectPoints]
    def __init__(self, version: _Optional[int] = ..., objects: _Optional[_Iterable[_Union[ObjectPoints, _Mapping]]] = ...) -> None: ...

class WatchMapRequest(_message.Message):
    __slots__ = ("scene", "after_version")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    AFTER_VERSION_FIELD_NUMBER: _ClassVar[int]
    scene: str
    after_version: int
    def __init__(self, scene: _Optional[str] = ..., after_version: _Optional[int] = ...) -> None: ...

class MapDelta(_message.Message):
    __slots__ = ("version", "frame_id", "created", "updated", "removed", "aliases")
    class AliasesEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: str
        def __init__(self, key: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...
    VERSION_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    CREATED_FIELD_NUMBER: _ClassVar[int]
    UPDATED_FIELD_NUMBER: _ClassVar[int]
    REMOVED_FIELD_NUMBER: _ClassVar[int]
    ALIASES_FIELD_NUMBER: _ClassVar[int]
    version: int
    frame_id: str
    created: _containers.RepeatedScalarFieldContainer[str]
    updated: _containers.RepeatedScalarFieldContainer[str]
    removed: _containers.RepeatedScalarFieldContainer[str]
    aliases: _containers.ScalarMap[str, str]
    def __init__(self, version: _Optional[int] = ..., frame_id: _Optional[str] = ..., created: _Optional[_Iterable[str]] = ..., updated: _Optional[_Iterable[str]] = ..., removed: _Optional[_Iterable[str]] = ..., aliases: _Optional[_Mapping[str, str]] = ...) -> None: ...

class WatchMapResponse(_message.Message):
    __slots__ = ("delta",)
    DELTA_FIELD_NUMBER: _ClassVar[int]
    delta: MapDelta
    def __init__(self, delta: _Optional[_Union[MapDelta, _Mapping]] = ...) -> None: ...
