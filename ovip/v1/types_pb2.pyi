from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Presence(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PRESENCE_UNSPECIFIED: _ClassVar[Presence]
    PRESENCE_PRESENT: _ClassVar[Presence]
    PRESENCE_MOVED_OR_REMOVED: _ClassVar[Presence]
PRESENCE_UNSPECIFIED: Presence
PRESENCE_PRESENT: Presence
PRESENCE_MOVED_OR_REMOVED: Presence

class Vector3(_message.Message):
    __slots__ = ("x", "y", "z")
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    Z_FIELD_NUMBER: _ClassVar[int]
    x: float
    y: float
    z: float
    def __init__(self, x: _Optional[float] = ..., y: _Optional[float] = ..., z: _Optional[float] = ...) -> None: ...

class Pose(_message.Message):
    __slots__ = ("world_from_camera",)
    WORLD_FROM_CAMERA_FIELD_NUMBER: _ClassVar[int]
    world_from_camera: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, world_from_camera: _Optional[_Iterable[float]] = ...) -> None: ...

class Intrinsics(_message.Message):
    __slots__ = ("fx", "fy", "cx", "cy", "width", "height")
    FX_FIELD_NUMBER: _ClassVar[int]
    FY_FIELD_NUMBER: _ClassVar[int]
    CX_FIELD_NUMBER: _ClassVar[int]
    CY_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_FIELD_NUMBER: _ClassVar[int]
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int
    def __init__(self, fx: _Optional[float] = ..., fy: _Optional[float] = ..., cx: _Optional[float] = ..., cy: _Optional[float] = ..., width: _Optional[int] = ..., height: _Optional[int] = ...) -> None: ...

class Box3(_message.Message):
    __slots__ = ("low", "high")
    LOW_FIELD_NUMBER: _ClassVar[int]
    HIGH_FIELD_NUMBER: _ClassVar[int]
    low: Vector3
    high: Vector3
    def __init__(self, low: _Optional[_Union[Vector3, _Mapping]] = ..., high: _Optional[_Union[Vector3, _Mapping]] = ...) -> None: ...

class Box2(_message.Message):
    __slots__ = ("x0", "y0", "x1", "y1")
    X0_FIELD_NUMBER: _ClassVar[int]
    Y0_FIELD_NUMBER: _ClassVar[int]
    X1_FIELD_NUMBER: _ClassVar[int]
    Y1_FIELD_NUMBER: _ClassVar[int]
    x0: float
    y0: float
    x1: float
    y1: float
    def __init__(self, x0: _Optional[float] = ..., y0: _Optional[float] = ..., x1: _Optional[float] = ..., y1: _Optional[float] = ...) -> None: ...

class Polygon(_message.Message):
    __slots__ = ("xy",)
    XY_FIELD_NUMBER: _ClassVar[int]
    xy: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, xy: _Optional[_Iterable[float]] = ...) -> None: ...

class Image(_message.Message):
    __slots__ = ("encoding", "data")
    class Encoding(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        ENCODING_UNSPECIFIED: _ClassVar[Image.Encoding]
        ENCODING_JPEG: _ClassVar[Image.Encoding]
        ENCODING_PNG: _ClassVar[Image.Encoding]
    ENCODING_UNSPECIFIED: Image.Encoding
    ENCODING_JPEG: Image.Encoding
    ENCODING_PNG: Image.Encoding
    ENCODING_FIELD_NUMBER: _ClassVar[int]
    DATA_FIELD_NUMBER: _ClassVar[int]
    encoding: Image.Encoding
    data: bytes
    def __init__(self, encoding: _Optional[_Union[Image.Encoding, str]] = ..., data: _Optional[bytes] = ...) -> None: ...

class DepthImage(_message.Message):
    __slots__ = ("encoding", "data", "scale")
    class Encoding(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        ENCODING_UNSPECIFIED: _ClassVar[DepthImage.Encoding]
        ENCODING_PNG16: _ClassVar[DepthImage.Encoding]
        ENCODING_SHUFFLE_ZSTD: _ClassVar[DepthImage.Encoding]
    ENCODING_UNSPECIFIED: DepthImage.Encoding
    ENCODING_PNG16: DepthImage.Encoding
    ENCODING_SHUFFLE_ZSTD: DepthImage.Encoding
    ENCODING_FIELD_NUMBER: _ClassVar[int]
    DATA_FIELD_NUMBER: _ClassVar[int]
    SCALE_FIELD_NUMBER: _ClassVar[int]
    encoding: DepthImage.Encoding
    data: bytes
    scale: float
    def __init__(self, encoding: _Optional[_Union[DepthImage.Encoding, str]] = ..., data: _Optional[bytes] = ..., scale: _Optional[float] = ...) -> None: ...

class Mask(_message.Message):
    __slots__ = ("x", "y", "width", "height", "png")
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_FIELD_NUMBER: _ClassVar[int]
    PNG_FIELD_NUMBER: _ClassVar[int]
    x: int
    y: int
    width: int
    height: int
    png: bytes
    def __init__(self, x: _Optional[int] = ..., y: _Optional[int] = ..., width: _Optional[int] = ..., height: _Optional[int] = ..., png: _Optional[bytes] = ...) -> None: ...

class Detection2D(_message.Message):
    __slots__ = ("label", "score", "box", "mask", "feature", "second_feature")
    LABEL_FIELD_NUMBER: _ClassVar[int]
    SCORE_FIELD_NUMBER: _ClassVar[int]
    BOX_FIELD_NUMBER: _ClassVar[int]
    MASK_FIELD_NUMBER: _ClassVar[int]
    FEATURE_FIELD_NUMBER: _ClassVar[int]
    SECOND_FEATURE_FIELD_NUMBER: _ClassVar[int]
    label: str
    score: float
    box: Box2
    mask: Mask
    feature: _containers.RepeatedScalarFieldContainer[float]
    second_feature: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, label: _Optional[str] = ..., score: _Optional[float] = ..., box: _Optional[_Union[Box2, _Mapping]] = ..., mask: _Optional[_Union[Mask, _Mapping]] = ..., feature: _Optional[_Iterable[float]] = ..., second_feature: _Optional[_Iterable[float]] = ...) -> None: ...

class Detection(_message.Message):
    __slots__ = ("detection_id", "label", "score", "box2", "box3", "feature", "points", "colors", "second_feature")
    DETECTION_ID_FIELD_NUMBER: _ClassVar[int]
    LABEL_FIELD_NUMBER: _ClassVar[int]
    SCORE_FIELD_NUMBER: _ClassVar[int]
    BOX2_FIELD_NUMBER: _ClassVar[int]
    BOX3_FIELD_NUMBER: _ClassVar[int]
    FEATURE_FIELD_NUMBER: _ClassVar[int]
    POINTS_FIELD_NUMBER: _ClassVar[int]
    COLORS_FIELD_NUMBER: _ClassVar[int]
    SECOND_FEATURE_FIELD_NUMBER: _ClassVar[int]
    detection_id: str
    label: str
    score: float
    box2: Box2
    box3: Box3
    feature: bytes
    points: bytes
    colors: bytes
    second_feature: bytes
    def __init__(self, detection_id: _Optional[str] = ..., label: _Optional[str] = ..., score: _Optional[float] = ..., box2: _Optional[_Union[Box2, _Mapping]] = ..., box3: _Optional[_Union[Box3, _Mapping]] = ..., feature: _Optional[bytes] = ..., points: _Optional[bytes] = ..., colors: _Optional[bytes] = ..., second_feature: _Optional[bytes] = ...) -> None: ...

class DetectionBatch(_message.Message):
    __slots__ = ("frame_id", "pose", "intrinsics", "timestamp_ns", "detections", "surface_points", "late", "words", "nearest_depth")
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    INTRINSICS_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    DETECTIONS_FIELD_NUMBER: _ClassVar[int]
    SURFACE_POINTS_FIELD_NUMBER: _ClassVar[int]
    LATE_FIELD_NUMBER: _ClassVar[int]
    WORDS_FIELD_NUMBER: _ClassVar[int]
    NEAREST_DEPTH_FIELD_NUMBER: _ClassVar[int]
    frame_id: str
    pose: Pose
    intrinsics: Intrinsics
    timestamp_ns: int
    detections: _containers.RepeatedCompositeFieldContainer[Detection]
    surface_points: bytes
    late: bool
    words: _containers.RepeatedScalarFieldContainer[str]
    nearest_depth: bytes
    def __init__(self, frame_id: _Optional[str] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., intrinsics: _Optional[_Union[Intrinsics, _Mapping]] = ..., timestamp_ns: _Optional[int] = ..., detections: _Optional[_Iterable[_Union[Detection, _Mapping]]] = ..., surface_points: _Optional[bytes] = ..., late: bool = ..., words: _Optional[_Iterable[str]] = ..., nearest_depth: _Optional[bytes] = ...) -> None: ...

class MapObject(_message.Message):
    __slots__ = ("object_id", "label", "label_counts", "centroid", "box", "feature", "view_weight", "observations", "frames", "first_seen_ns", "last_seen_ns", "voxels", "mean_color", "best_frame_id", "best_box", "version", "revision", "presence", "pinned", "label_given", "relations", "moves")
    class LabelCountsEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: int
        def __init__(self, key: _Optional[str] = ..., value: _Optional[int] = ...) -> None: ...
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    LABEL_FIELD_NUMBER: _ClassVar[int]
    LABEL_COUNTS_FIELD_NUMBER: _ClassVar[int]
    CENTROID_FIELD_NUMBER: _ClassVar[int]
    BOX_FIELD_NUMBER: _ClassVar[int]
    FEATURE_FIELD_NUMBER: _ClassVar[int]
    VIEW_WEIGHT_FIELD_NUMBER: _ClassVar[int]
    OBSERVATIONS_FIELD_NUMBER: _ClassVar[int]
    FRAMES_FIELD_NUMBER: _ClassVar[int]
    FIRST_SEEN_NS_FIELD_NUMBER: _ClassVar[int]
    LAST_SEEN_NS_FIELD_NUMBER: _ClassVar[int]
    VOXELS_FIELD_NUMBER: _ClassVar[int]
    MEAN_COLOR_FIELD_NUMBER: _ClassVar[int]
    BEST_FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    BEST_BOX_FIELD_NUMBER: _ClassVar[int]
    VERSION_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    PRESENCE_FIELD_NUMBER: _ClassVar[int]
    PINNED_FIELD_NUMBER: _ClassVar[int]
    LABEL_GIVEN_FIELD_NUMBER: _ClassVar[int]
    RELATIONS_FIELD_NUMBER: _ClassVar[int]
    MOVES_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    label: str
    label_counts: _containers.ScalarMap[str, int]
    centroid: Vector3
    box: Box3
    feature: bytes
    view_weight: float
    observations: int
    frames: int
    first_seen_ns: int
    last_seen_ns: int
    voxels: int
    mean_color: _containers.RepeatedScalarFieldContainer[float]
    best_frame_id: str
    best_box: Box2
    version: int
    revision: int
    presence: Presence
    pinned: bool
    label_given: bool
    relations: _containers.RepeatedCompositeFieldContainer[Relation]
    moves: _containers.RepeatedCompositeFieldContainer[Move]
    def __init__(self, object_id: _Optional[str] = ..., label: _Optional[str] = ..., label_counts: _Optional[_Mapping[str, int]] = ..., centroid: _Optional[_Union[Vector3, _Mapping]] = ..., box: _Optional[_Union[Box3, _Mapping]] = ..., feature: _Optional[bytes] = ..., view_weight: _Optional[float] = ..., observations: _Optional[int] = ..., frames: _Optional[int] = ..., first_seen_ns: _Optional[int] = ..., last_seen_ns: _Optional[int] = ..., voxels: _Optional[int] = ..., mean_color: _Optional[_Iterable[float]] = ..., best_frame_id: _Optional[str] = ..., best_box: _Optional[_Union[Box2, _Mapping]] = ..., version: _Optional[int] = ..., revision: _Optional[int] = ..., presence: _Optional[_Union[Presence, str]] = ..., pinned: bool = ..., label_given: bool = ..., relations: _Optional[_Iterable[_Union[Relation, _Mapping]]] = ..., moves: _Optional[_Iterable[_Union[Move, _Mapping]]] = ...) -> None: ...

class Relation(_message.Message):
    __slots__ = ("kind", "other_id", "evidence")
    class Kind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        KIND_UNSPECIFIED: _ClassVar[Relation.Kind]
        KIND_ON: _ClassVar[Relation.Kind]
        KIND_IN: _ClassVar[Relation.Kind]
        KIND_NEXT_TO: _ClassVar[Relation.Kind]
        KIND_ATTACHED_TO: _ClassVar[Relation.Kind]
    KIND_UNSPECIFIED: Relation.Kind
    KIND_ON: Relation.Kind
    KIND_IN: Relation.Kind
    KIND_NEXT_TO: Relation.Kind
    KIND_ATTACHED_TO: Relation.Kind
    class EvidenceEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: float
        def __init__(self, key: _Optional[str] = ..., value: _Optional[float] = ...) -> None: ...
    KIND_FIELD_NUMBER: _ClassVar[int]
    OTHER_ID_FIELD_NUMBER: _ClassVar[int]
    EVIDENCE_FIELD_NUMBER: _ClassVar[int]
    kind: Relation.Kind
    other_id: str
    evidence: _containers.ScalarMap[str, float]
    def __init__(self, kind: _Optional[_Union[Relation.Kind, str]] = ..., other_id: _Optional[str] = ..., evidence: _Optional[_Mapping[str, float]] = ...) -> None: ...

class Move(_message.Message):
    __slots__ = ("timestamp_ns", "origin")
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    ORIGIN_FIELD_NUMBER: _ClassVar[int]
    timestamp_ns: int
    origin: Vector3
    def __init__(self, timestamp_ns: _Optional[int] = ..., origin: _Optional[_Union[Vector3, _Mapping]] = ...) -> None: ...
