from ovip.v1 import types_pb2 as _types_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class StepKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    STEP_KIND_UNSPECIFIED: _ClassVar[StepKind]
    STEP_KIND_FRAME: _ClassVar[StepKind]
    STEP_KIND_UPKEEP: _ClassVar[StepKind]
    STEP_KIND_EDIT: _ClassVar[StepKind]
    STEP_KIND_JOIN: _ClassVar[StepKind]
    STEP_KIND_SETTINGS: _ClassVar[StepKind]
STEP_KIND_UNSPECIFIED: StepKind
STEP_KIND_FRAME: StepKind
STEP_KIND_UPKEEP: StepKind
STEP_KIND_EDIT: StepKind
STEP_KIND_JOIN: StepKind
STEP_KIND_SETTINGS: StepKind

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
    __slots__ = ("scene", "include_unconfirmed", "at_version", "include_departed")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    INCLUDE_UNCONFIRMED_FIELD_NUMBER: _ClassVar[int]
    AT_VERSION_FIELD_NUMBER: _ClassVar[int]
    INCLUDE_DEPARTED_FIELD_NUMBER: _ClassVar[int]
    scene: str
    include_unconfirmed: bool
    at_version: int
    include_departed: bool
    def __init__(self, scene: _Optional[str] = ..., include_unconfirmed: bool = ..., at_version: _Optional[int] = ..., include_departed: bool = ...) -> None: ...

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
    __slots__ = ("version", "frame_id", "created", "updated", "removed", "aliases", "kind", "departed", "returned", "moved")
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
    KIND_FIELD_NUMBER: _ClassVar[int]
    DEPARTED_FIELD_NUMBER: _ClassVar[int]
    RETURNED_FIELD_NUMBER: _ClassVar[int]
    MOVED_FIELD_NUMBER: _ClassVar[int]
    version: int
    frame_id: str
    created: _containers.RepeatedScalarFieldContainer[str]
    updated: _containers.RepeatedScalarFieldContainer[str]
    removed: _containers.RepeatedScalarFieldContainer[str]
    aliases: _containers.ScalarMap[str, str]
    kind: StepKind
    departed: _containers.RepeatedScalarFieldContainer[str]
    returned: _containers.RepeatedScalarFieldContainer[str]
    moved: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, version: _Optional[int] = ..., frame_id: _Optional[str] = ..., created: _Optional[_Iterable[str]] = ..., updated: _Optional[_Iterable[str]] = ..., removed: _Optional[_Iterable[str]] = ..., aliases: _Optional[_Mapping[str, str]] = ..., kind: _Optional[_Union[StepKind, str]] = ..., departed: _Optional[_Iterable[str]] = ..., returned: _Optional[_Iterable[str]] = ..., moved: _Optional[_Iterable[str]] = ...) -> None: ...

class WatchMapResponse(_message.Message):
    __slots__ = ("delta",)
    DELTA_FIELD_NUMBER: _ClassVar[int]
    delta: MapDelta
    def __init__(self, delta: _Optional[_Union[MapDelta, _Mapping]] = ...) -> None: ...

class DiffMapRequest(_message.Message):
    __slots__ = ("scene", "from_version", "to_version")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    FROM_VERSION_FIELD_NUMBER: _ClassVar[int]
    TO_VERSION_FIELD_NUMBER: _ClassVar[int]
    scene: str
    from_version: int
    to_version: int
    def __init__(self, scene: _Optional[str] = ..., from_version: _Optional[int] = ..., to_version: _Optional[int] = ...) -> None: ...

class ObjectChange(_message.Message):
    __slots__ = ("object_id", "before", "after", "fields", "merged_into")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    BEFORE_FIELD_NUMBER: _ClassVar[int]
    AFTER_FIELD_NUMBER: _ClassVar[int]
    FIELDS_FIELD_NUMBER: _ClassVar[int]
    MERGED_INTO_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    before: _types_pb2.MapObject
    after: _types_pb2.MapObject
    fields: _containers.RepeatedScalarFieldContainer[str]
    merged_into: str
    def __init__(self, object_id: _Optional[str] = ..., before: _Optional[_Union[_types_pb2.MapObject, _Mapping]] = ..., after: _Optional[_Union[_types_pb2.MapObject, _Mapping]] = ..., fields: _Optional[_Iterable[str]] = ..., merged_into: _Optional[str] = ...) -> None: ...

class DiffMapResponse(_message.Message):
    __slots__ = ("from_version", "to_version", "changes")
    FROM_VERSION_FIELD_NUMBER: _ClassVar[int]
    TO_VERSION_FIELD_NUMBER: _ClassVar[int]
    CHANGES_FIELD_NUMBER: _ClassVar[int]
    from_version: int
    to_version: int
    changes: _containers.RepeatedCompositeFieldContainer[ObjectChange]
    def __init__(self, from_version: _Optional[int] = ..., to_version: _Optional[int] = ..., changes: _Optional[_Iterable[_Union[ObjectChange, _Mapping]]] = ...) -> None: ...

class VerifyMapRequest(_message.Message):
    __slots__ = ("scene",)
    SCENE_FIELD_NUMBER: _ClassVar[int]
    scene: str
    def __init__(self, scene: _Optional[str] = ...) -> None: ...

class VerifyMapResponse(_message.Message):
    __slots__ = ("version", "state_hash", "rebuilt_hash", "snapshots", "differing_versions", "steps")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    STATE_HASH_FIELD_NUMBER: _ClassVar[int]
    REBUILT_HASH_FIELD_NUMBER: _ClassVar[int]
    SNAPSHOTS_FIELD_NUMBER: _ClassVar[int]
    DIFFERING_VERSIONS_FIELD_NUMBER: _ClassVar[int]
    STEPS_FIELD_NUMBER: _ClassVar[int]
    version: int
    state_hash: str
    rebuilt_hash: str
    snapshots: int
    differing_versions: _containers.RepeatedScalarFieldContainer[int]
    steps: int
    def __init__(self, version: _Optional[int] = ..., state_hash: _Optional[str] = ..., rebuilt_hash: _Optional[str] = ..., snapshots: _Optional[int] = ..., differing_versions: _Optional[_Iterable[int]] = ..., steps: _Optional[int] = ...) -> None: ...

class EditMapRequest(_message.Message):
    __slots__ = ("scene", "edit_id", "made_on_version", "operator", "rename", "merge", "split", "delete", "pin")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    EDIT_ID_FIELD_NUMBER: _ClassVar[int]
    MADE_ON_VERSION_FIELD_NUMBER: _ClassVar[int]
    OPERATOR_FIELD_NUMBER: _ClassVar[int]
    RENAME_FIELD_NUMBER: _ClassVar[int]
    MERGE_FIELD_NUMBER: _ClassVar[int]
    SPLIT_FIELD_NUMBER: _ClassVar[int]
    DELETE_FIELD_NUMBER: _ClassVar[int]
    PIN_FIELD_NUMBER: _ClassVar[int]
    scene: str
    edit_id: str
    made_on_version: int
    operator: str
    rename: RenameEdit
    merge: MergeEdit
    split: SplitEdit
    delete: DeleteEdit
    pin: PinEdit
    def __init__(self, scene: _Optional[str] = ..., edit_id: _Optional[str] = ..., made_on_version: _Optional[int] = ..., operator: _Optional[str] = ..., rename: _Optional[_Union[RenameEdit, _Mapping]] = ..., merge: _Optional[_Union[MergeEdit, _Mapping]] = ..., split: _Optional[_Union[SplitEdit, _Mapping]] = ..., delete: _Optional[_Union[DeleteEdit, _Mapping]] = ..., pin: _Optional[_Union[PinEdit, _Mapping]] = ...) -> None: ...

class RenameEdit(_message.Message):
    __slots__ = ("object_id", "label")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    LABEL_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    label: str
    def __init__(self, object_id: _Optional[str] = ..., label: _Optional[str] = ...) -> None: ...

class MergeEdit(_message.Message):
    __slots__ = ("keep_id", "merged_ids")
    KEEP_ID_FIELD_NUMBER: _ClassVar[int]
    MERGED_IDS_FIELD_NUMBER: _ClassVar[int]
    keep_id: str
    merged_ids: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, keep_id: _Optional[str] = ..., merged_ids: _Optional[_Iterable[str]] = ...) -> None: ...

class SplitEdit(_message.Message):
    __slots__ = ("object_id", "part", "part_label")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    PART_FIELD_NUMBER: _ClassVar[int]
    PART_LABEL_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    part: _types_pb2.Box3
    part_label: str
    def __init__(self, object_id: _Optional[str] = ..., part: _Optional[_Union[_types_pb2.Box3, _Mapping]] = ..., part_label: _Optional[str] = ...) -> None: ...

class DeleteEdit(_message.Message):
    __slots__ = ("object_id",)
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    def __init__(self, object_id: _Optional[str] = ...) -> None: ...

class PinEdit(_message.Message):
    __slots__ = ("object_id", "pinned")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    PINNED_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    pinned: bool
    def __init__(self, object_id: _Optional[str] = ..., pinned: bool = ...) -> None: ...

class EditMapResponse(_message.Message):
    __slots__ = ("delta",)
    DELTA_FIELD_NUMBER: _ClassVar[int]
    delta: MapDelta
    def __init__(self, delta: _Optional[_Union[MapDelta, _Mapping]] = ...) -> None: ...

class JoinMapRequest(_message.Message):
    __slots__ = ("scene", "other_scene", "world_from_other", "edit_id")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    OTHER_SCENE_FIELD_NUMBER: _ClassVar[int]
    WORLD_FROM_OTHER_FIELD_NUMBER: _ClassVar[int]
    EDIT_ID_FIELD_NUMBER: _ClassVar[int]
    scene: str
    other_scene: str
    world_from_other: _containers.RepeatedScalarFieldContainer[float]
    edit_id: str
    def __init__(self, scene: _Optional[str] = ..., other_scene: _Optional[str] = ..., world_from_other: _Optional[_Iterable[float]] = ..., edit_id: _Optional[str] = ...) -> None: ...

class JoinMapResponse(_message.Message):
    __slots__ = ("delta", "ids")
    class IdsEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: str
        def __init__(self, key: _Optional[str] = ..., value: _Optional[str] = ...) -> None: ...
    DELTA_FIELD_NUMBER: _ClassVar[int]
    IDS_FIELD_NUMBER: _ClassVar[int]
    delta: MapDelta
    ids: _containers.ScalarMap[str, str]
    def __init__(self, delta: _Optional[_Union[MapDelta, _Mapping]] = ..., ids: _Optional[_Mapping[str, str]] = ...) -> None: ...

class AlignMapRequest(_message.Message):
    __slots__ = ("scene", "other_scene", "world_from_other")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    OTHER_SCENE_FIELD_NUMBER: _ClassVar[int]
    WORLD_FROM_OTHER_FIELD_NUMBER: _ClassVar[int]
    scene: str
    other_scene: str
    world_from_other: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, scene: _Optional[str] = ..., other_scene: _Optional[str] = ..., world_from_other: _Optional[_Iterable[float]] = ...) -> None: ...

class AlignMapResponse(_message.Message):
    __slots__ = ("world_from_other", "overlap", "rmse")
    WORLD_FROM_OTHER_FIELD_NUMBER: _ClassVar[int]
    OVERLAP_FIELD_NUMBER: _ClassVar[int]
    RMSE_FIELD_NUMBER: _ClassVar[int]
    world_from_other: _containers.RepeatedScalarFieldContainer[float]
    overlap: float
    rmse: float
    def __init__(self, world_from_other: _Optional[_Iterable[float]] = ..., overlap: _Optional[float] = ..., rmse: _Optional[float] = ...) -> None: ...
