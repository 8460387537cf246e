from ovip.v1 import types_pb2 as _types_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Hello(_message.Message):
    __slots__ = ("scene", "robot_id", "session_id", "intrinsics", "world_from_source")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    ROBOT_ID_FIELD_NUMBER: _ClassVar[int]
    SESSION_ID_FIELD_NUMBER: _ClassVar[int]
    INTRINSICS_FIELD_NUMBER: _ClassVar[int]
    WORLD_FROM_SOURCE_FIELD_NUMBER: _ClassVar[int]
    scene: str
    robot_id: str
    session_id: str
    intrinsics: _types_pb2.Intrinsics
    world_from_source: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, scene: _Optional[str] = ..., robot_id: _Optional[str] = ..., session_id: _Optional[str] = ..., intrinsics: _Optional[_Union[_types_pb2.Intrinsics, _Mapping]] = ..., world_from_source: _Optional[_Iterable[float]] = ...) -> None: ...

class FrameUpload(_message.Message):
    __slots__ = ("sequence", "timestamp_ns", "pose", "rgb", "depth", "onboard")
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    RGB_FIELD_NUMBER: _ClassVar[int]
    DEPTH_FIELD_NUMBER: _ClassVar[int]
    ONBOARD_FIELD_NUMBER: _ClassVar[int]
    sequence: int
    timestamp_ns: int
    pose: _types_pb2.Pose
    rgb: _types_pb2.Image
    depth: _types_pb2.DepthImage
    onboard: OnboardDetections
    def __init__(self, sequence: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., pose: _Optional[_Union[_types_pb2.Pose, _Mapping]] = ..., rgb: _Optional[_Union[_types_pb2.Image, _Mapping]] = ..., depth: _Optional[_Union[_types_pb2.DepthImage, _Mapping]] = ..., onboard: _Optional[_Union[OnboardDetections, _Mapping]] = ...) -> None: ...

class OnboardDetections(_message.Message):
    __slots__ = ("detections",)
    DETECTIONS_FIELD_NUMBER: _ClassVar[int]
    detections: _containers.RepeatedCompositeFieldContainer[_types_pb2.Detection2D]
    def __init__(self, detections: _Optional[_Iterable[_Union[_types_pb2.Detection2D, _Mapping]]] = ...) -> None: ...

class StreamFramesRequest(_message.Message):
    __slots__ = ("hello", "frame")
    HELLO_FIELD_NUMBER: _ClassVar[int]
    FRAME_FIELD_NUMBER: _ClassVar[int]
    hello: Hello
    frame: FrameUpload
    def __init__(self, hello: _Optional[_Union[Hello, _Mapping]] = ..., frame: _Optional[_Union[FrameUpload, _Mapping]] = ...) -> None: ...

class Welcome(_message.Message):
    __slots__ = ("last_durable_sequence", "credits", "feature_space")
    LAST_DURABLE_SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    CREDITS_FIELD_NUMBER: _ClassVar[int]
    FEATURE_SPACE_FIELD_NUMBER: _ClassVar[int]
    last_durable_sequence: int
    credits: int
    feature_space: str
    def __init__(self, last_durable_sequence: _Optional[int] = ..., credits: _Optional[int] = ..., feature_space: _Optional[str] = ...) -> None: ...

class Ack(_message.Message):
    __slots__ = ("sequence", "status", "reason", "frame_id", "credits", "duplicate")
    class Status(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        STATUS_UNSPECIFIED: _ClassVar[Ack.Status]
        STATUS_RECEIVED: _ClassVar[Ack.Status]
        STATUS_DURABLE: _ClassVar[Ack.Status]
        STATUS_APPLIED: _ClassVar[Ack.Status]
        STATUS_REJECTED: _ClassVar[Ack.Status]
    STATUS_UNSPECIFIED: Ack.Status
    STATUS_RECEIVED: Ack.Status
    STATUS_DURABLE: Ack.Status
    STATUS_APPLIED: Ack.Status
    STATUS_REJECTED: Ack.Status
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    STATUS_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    CREDITS_FIELD_NUMBER: _ClassVar[int]
    DUPLICATE_FIELD_NUMBER: _ClassVar[int]
    sequence: int
    status: Ack.Status
    reason: str
    frame_id: str
    credits: int
    duplicate: bool
    def __init__(self, sequence: _Optional[int] = ..., status: _Optional[_Union[Ack.Status, str]] = ..., reason: _Optional[str] = ..., frame_id: _Optional[str] = ..., credits: _Optional[int] = ..., duplicate: bool = ...) -> None: ...

class StreamFramesResponse(_message.Message):
    __slots__ = ("welcome", "ack")
    WELCOME_FIELD_NUMBER: _ClassVar[int]
    ACK_FIELD_NUMBER: _ClassVar[int]
    welcome: Welcome
    ack: Ack
    def __init__(self, welcome: _Optional[_Union[Welcome, _Mapping]] = ..., ack: _Optional[_Union[Ack, _Mapping]] = ...) -> None: ...

class FrameRecord(_message.Message):
    __slots__ = ("frame_id", "timestamp_ns", "pose", "intrinsics", "tags", "processed", "log_id")
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    INTRINSICS_FIELD_NUMBER: _ClassVar[int]
    TAGS_FIELD_NUMBER: _ClassVar[int]
    PROCESSED_FIELD_NUMBER: _ClassVar[int]
    LOG_ID_FIELD_NUMBER: _ClassVar[int]
    frame_id: str
    timestamp_ns: int
    pose: _types_pb2.Pose
    intrinsics: _types_pb2.Intrinsics
    tags: _containers.RepeatedScalarFieldContainer[str]
    processed: bool
    log_id: str
    def __init__(self, frame_id: _Optional[str] = ..., timestamp_ns: _Optional[int] = ..., pose: _Optional[_Union[_types_pb2.Pose, _Mapping]] = ..., intrinsics: _Optional[_Union[_types_pb2.Intrinsics, _Mapping]] = ..., tags: _Optional[_Iterable[str]] = ..., processed: bool = ..., log_id: _Optional[str] = ...) -> None: ...

class ListFramesRequest(_message.Message):
    __slots__ = ("scene", "after_log_id", "limit")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    AFTER_LOG_ID_FIELD_NUMBER: _ClassVar[int]
    LIMIT_FIELD_NUMBER: _ClassVar[int]
    scene: str
    after_log_id: str
    limit: int
    def __init__(self, scene: _Optional[str] = ..., after_log_id: _Optional[str] = ..., limit: _Optional[int] = ...) -> None: ...

class ListFramesResponse(_message.Message):
    __slots__ = ("frames", "tag_features")
    class TagFeaturesEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: bytes
        def __init__(self, key: _Optional[str] = ..., value: _Optional[bytes] = ...) -> None: ...
    FRAMES_FIELD_NUMBER: _ClassVar[int]
    TAG_FEATURES_FIELD_NUMBER: _ClassVar[int]
    frames: _containers.RepeatedCompositeFieldContainer[FrameRecord]
    tag_features: _containers.ScalarMap[str, bytes]
    def __init__(self, frames: _Optional[_Iterable[_Union[FrameRecord, _Mapping]]] = ..., tag_features: _Optional[_Mapping[str, bytes]] = ...) -> None: ...

class GetFrameRequest(_message.Message):
    __slots__ = ("scene", "frame_id", "with_rgb", "with_depth")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    WITH_RGB_FIELD_NUMBER: _ClassVar[int]
    WITH_DEPTH_FIELD_NUMBER: _ClassVar[int]
    scene: str
    frame_id: str
    with_rgb: bool
    with_depth: bool
    def __init__(self, scene: _Optional[str] = ..., frame_id: _Optional[str] = ..., with_rgb: bool = ..., with_depth: bool = ...) -> None: ...

class GetFrameResponse(_message.Message):
    __slots__ = ("frame", "rgb", "depth")
    FRAME_FIELD_NUMBER: _ClassVar[int]
    RGB_FIELD_NUMBER: _ClassVar[int]
    DEPTH_FIELD_NUMBER: _ClassVar[int]
    frame: FrameRecord
    rgb: _types_pb2.Image
    depth: _types_pb2.DepthImage
    def __init__(self, frame: _Optional[_Union[FrameRecord, _Mapping]] = ..., rgb: _Optional[_Union[_types_pb2.Image, _Mapping]] = ..., depth: _Optional[_Union[_types_pb2.DepthImage, _Mapping]] = ...) -> None: ...

class GroundRequest(_message.Message):
    __slots__ = ("scene", "frame_ids", "words")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    FRAME_IDS_FIELD_NUMBER: _ClassVar[int]
    WORDS_FIELD_NUMBER: _ClassVar[int]
    scene: str
    frame_ids: _containers.RepeatedScalarFieldContainer[str]
    words: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, scene: _Optional[str] = ..., frame_ids: _Optional[_Iterable[str]] = ..., words: _Optional[_Iterable[str]] = ...) -> None: ...

class GroundedFrame(_message.Message):
    __slots__ = ("frame_id", "detections")
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    DETECTIONS_FIELD_NUMBER: _ClassVar[int]
    frame_id: str
    detections: _containers.RepeatedCompositeFieldContainer[_types_pb2.Detection]
    def __init__(self, frame_id: _Optional[str] = ..., detections: _Optional[_Iterable[_Union[_types_pb2.Detection, _Mapping]]] = ...) -> None: ...

class GroundResponse(_message.Message):
    __slots__ = ("frames", "ungroundable_words")
    FRAMES_FIELD_NUMBER: _ClassVar[int]
    UNGROUNDABLE_WORDS_FIELD_NUMBER: _ClassVar[int]
    frames: _containers.RepeatedCompositeFieldContainer[GroundedFrame]
    ungroundable_words: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, frames: _Optional[_Iterable[_Union[GroundedFrame, _Mapping]]] = ..., ungroundable_words: _Optional[_Iterable[str]] = ...) -> None: ...

class EmbedTextRequest(_message.Message):
    __slots__ = ("texts",)
    TEXTS_FIELD_NUMBER: _ClassVar[int]
    texts: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, texts: _Optional[_Iterable[str]] = ...) -> None: ...

class EmbedTextResponse(_message.Message):
    __slots__ = ("features", "feature_space")
    FEATURES_FIELD_NUMBER: _ClassVar[int]
    FEATURE_SPACE_FIELD_NUMBER: _ClassVar[int]
    features: _containers.RepeatedScalarFieldContainer[bytes]
    feature_space: str
    def __init__(self, features: _Optional[_Iterable[bytes]] = ..., feature_space: _Optional[str] = ...) -> None: ...

class GetPerceptionStatusRequest(_message.Message):
    __slots__ = ("scene",)
    SCENE_FIELD_NUMBER: _ClassVar[int]
    scene: str
    def __init__(self, scene: _Optional[str] = ...) -> None: ...

class GetPerceptionStatusResponse(_message.Message):
    __slots__ = ("frames_durable", "frames_processed", "frames_skipped", "vocabulary", "world_from_source", "backend", "feature_space", "detections", "newest_detections_id")
    FRAMES_DURABLE_FIELD_NUMBER: _ClassVar[int]
    FRAMES_PROCESSED_FIELD_NUMBER: _ClassVar[int]
    FRAMES_SKIPPED_FIELD_NUMBER: _ClassVar[int]
    VOCABULARY_FIELD_NUMBER: _ClassVar[int]
    WORLD_FROM_SOURCE_FIELD_NUMBER: _ClassVar[int]
    BACKEND_FIELD_NUMBER: _ClassVar[int]
    FEATURE_SPACE_FIELD_NUMBER: _ClassVar[int]
    DETECTIONS_FIELD_NUMBER: _ClassVar[int]
    NEWEST_DETECTIONS_ID_FIELD_NUMBER: _ClassVar[int]
    frames_durable: int
    frames_processed: int
    frames_skipped: int
    vocabulary: _containers.RepeatedScalarFieldContainer[str]
    world_from_source: _containers.RepeatedScalarFieldContainer[float]
    backend: str
    feature_space: str
    detections: int
    newest_detections_id: str
    def __init__(self, frames_durable: _Optional[int] = ..., frames_processed: _Optional[int] = ..., frames_skipped: _Optional[int] = ..., vocabulary: _Optional[_Iterable[str]] = ..., world_from_source: _Optional[_Iterable[float]] = ..., backend: _Optional[str] = ..., feature_space: _Optional[str] = ..., detections: _Optional[int] = ..., newest_detections_id: _Optional[str] = ...) -> None: ...
