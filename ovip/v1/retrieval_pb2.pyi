from ovip.v1 import types_pb2 as _types_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class RobotState(_message.Message):
    __slots__ = ("pose", "radius")
    POSE_FIELD_NUMBER: _ClassVar[int]
    RADIUS_FIELD_NUMBER: _ClassVar[int]
    pose: _types_pb2.Pose
    radius: float
    def __init__(self, pose: _Optional[_Union[_types_pb2.Pose, _Mapping]] = ..., radius: _Optional[float] = ...) -> None: ...

class FindRequest(_message.Message):
    __slots__ = ("scene", "text", "robot", "region_hint", "max_tier", "max_vlm_calls", "max_viewpoints", "min_tier")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    ROBOT_FIELD_NUMBER: _ClassVar[int]
    REGION_HINT_FIELD_NUMBER: _ClassVar[int]
    MAX_TIER_FIELD_NUMBER: _ClassVar[int]
    MAX_VLM_CALLS_FIELD_NUMBER: _ClassVar[int]
    MAX_VIEWPOINTS_FIELD_NUMBER: _ClassVar[int]
    MIN_TIER_FIELD_NUMBER: _ClassVar[int]
    scene: str
    text: str
    robot: RobotState
    region_hint: str
    max_tier: int
    max_vlm_calls: int
    max_viewpoints: int
    min_tier: int
    def __init__(self, scene: _Optional[str] = ..., text: _Optional[str] = ..., robot: _Optional[_Union[RobotState, _Mapping]] = ..., region_hint: _Optional[str] = ..., max_tier: _Optional[int] = ..., max_vlm_calls: _Optional[int] = ..., max_viewpoints: _Optional[int] = ..., min_tier: _Optional[int] = ...) -> None: ...

class TierReport(_message.Message):
    __slots__ = ("tier", "result", "why", "vlm_calls", "milliseconds")
    class Result(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        RESULT_UNSPECIFIED: _ClassVar[TierReport.Result]
        RESULT_FOUND: _ClassVar[TierReport.Result]
        RESULT_AMBIGUOUS: _ClassVar[TierReport.Result]
        RESULT_MISSING: _ClassVar[TierReport.Result]
        RESULT_REJECTED: _ClassVar[TierReport.Result]
        RESULT_SKIPPED: _ClassVar[TierReport.Result]
        RESULT_WAITING: _ClassVar[TierReport.Result]
        RESULT_EXHAUSTED: _ClassVar[TierReport.Result]
    RESULT_UNSPECIFIED: TierReport.Result
    RESULT_FOUND: TierReport.Result
    RESULT_AMBIGUOUS: TierReport.Result
    RESULT_MISSING: TierReport.Result
    RESULT_REJECTED: TierReport.Result
    RESULT_SKIPPED: TierReport.Result
    RESULT_WAITING: TierReport.Result
    RESULT_EXHAUSTED: TierReport.Result
    TIER_FIELD_NUMBER: _ClassVar[int]
    RESULT_FIELD_NUMBER: _ClassVar[int]
    WHY_FIELD_NUMBER: _ClassVar[int]
    VLM_CALLS_FIELD_NUMBER: _ClassVar[int]
    MILLISECONDS_FIELD_NUMBER: _ClassVar[int]
    tier: int
    result: TierReport.Result
    why: str
    vlm_calls: int
    milliseconds: float
    def __init__(self, tier: _Optional[int] = ..., result: _Optional[_Union[TierReport.Result, str]] = ..., why: _Optional[str] = ..., vlm_calls: _Optional[int] = ..., milliseconds: _Optional[float] = ...) -> None: ...

class Candidate(_message.Message):
    __slots__ = ("object_id", "label", "position", "box", "score", "why", "frame_id", "box2")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    LABEL_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    BOX_FIELD_NUMBER: _ClassVar[int]
    SCORE_FIELD_NUMBER: _ClassVar[int]
    WHY_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    BOX2_FIELD_NUMBER: _ClassVar[int]
    object_id: str
    label: str
    position: _types_pb2.Vector3
    box: _types_pb2.Box3
    score: float
    why: str
    frame_id: str
    box2: _types_pb2.Box2
    def __init__(self, object_id: _Optional[str] = ..., label: _Optional[str] = ..., position: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., box: _Optional[_Union[_types_pb2.Box3, _Mapping]] = ..., score: _Optional[float] = ..., why: _Optional[str] = ..., frame_id: _Optional[str] = ..., box2: _Optional[_Union[_types_pb2.Box2, _Mapping]] = ...) -> None: ...

class Goal(_message.Message):
    __slots__ = ("position", "yaw")
    POSITION_FIELD_NUMBER: _ClassVar[int]
    YAW_FIELD_NUMBER: _ClassVar[int]
    position: _types_pb2.Vector3
    yaw: float
    def __init__(self, position: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., yaw: _Optional[float] = ...) -> None: ...

class Viewpoint(_message.Message):
    __slots__ = ("viewpoint_id", "position", "yaw", "region_id", "index", "total", "path")
    VIEWPOINT_ID_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    YAW_FIELD_NUMBER: _ClassVar[int]
    REGION_ID_FIELD_NUMBER: _ClassVar[int]
    INDEX_FIELD_NUMBER: _ClassVar[int]
    TOTAL_FIELD_NUMBER: _ClassVar[int]
    PATH_FIELD_NUMBER: _ClassVar[int]
    viewpoint_id: str
    position: _types_pb2.Vector3
    yaw: float
    region_id: str
    index: int
    total: int
    path: _containers.RepeatedCompositeFieldContainer[_types_pb2.Vector3]
    def __init__(self, viewpoint_id: _Optional[str] = ..., position: _Optional[_Union[_types_pb2.Vector3, _Mapping]] = ..., yaw: _Optional[float] = ..., region_id: _Optional[str] = ..., index: _Optional[int] = ..., total: _Optional[int] = ..., path: _Optional[_Iterable[_Union[_types_pb2.Vector3, _Mapping]]] = ...) -> None: ...

class RegionCoverage(_message.Message):
    __slots__ = ("region_id", "display_name", "area", "seen", "prior")
    REGION_ID_FIELD_NUMBER: _ClassVar[int]
    DISPLAY_NAME_FIELD_NUMBER: _ClassVar[int]
    AREA_FIELD_NUMBER: _ClassVar[int]
    SEEN_FIELD_NUMBER: _ClassVar[int]
    PRIOR_FIELD_NUMBER: _ClassVar[int]
    region_id: str
    display_name: str
    area: float
    seen: float
    prior: float
    def __init__(self, region_id: _Optional[str] = ..., display_name: _Optional[str] = ..., area: _Optional[float] = ..., seen: _Optional[float] = ..., prior: _Optional[float] = ...) -> None: ...

class Coverage(_message.Message):
    __slots__ = ("planned", "visited", "unreachable", "regions", "posterior_present", "complete")
    PLANNED_FIELD_NUMBER: _ClassVar[int]
    VISITED_FIELD_NUMBER: _ClassVar[int]
    UNREACHABLE_FIELD_NUMBER: _ClassVar[int]
    REGIONS_FIELD_NUMBER: _ClassVar[int]
    POSTERIOR_PRESENT_FIELD_NUMBER: _ClassVar[int]
    COMPLETE_FIELD_NUMBER: _ClassVar[int]
    planned: int
    visited: int
    unreachable: int
    regions: _containers.RepeatedCompositeFieldContainer[RegionCoverage]
    posterior_present: float
    complete: bool
    def __init__(self, planned: _Optional[int] = ..., visited: _Optional[int] = ..., unreachable: _Optional[int] = ..., regions: _Optional[_Iterable[_Union[RegionCoverage, _Mapping]]] = ..., posterior_present: _Optional[float] = ..., complete: bool = ...) -> None: ...

class Answer(_message.Message):
    __slots__ = ("outcome", "tier", "object", "goal", "path", "tiers", "candidates", "rejected", "fallbacks", "map_version", "regions_revision", "coverage", "needs")
    class Outcome(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        OUTCOME_UNSPECIFIED: _ClassVar[Answer.Outcome]
        OUTCOME_FOUND: _ClassVar[Answer.Outcome]
        OUTCOME_ABSENT: _ClassVar[Answer.Outcome]
        OUTCOME_UNRESOLVED: _ClassVar[Answer.Outcome]
    OUTCOME_UNSPECIFIED: Answer.Outcome
    OUTCOME_FOUND: Answer.Outcome
    OUTCOME_ABSENT: Answer.Outcome
    OUTCOME_UNRESOLVED: Answer.Outcome
    OUTCOME_FIELD_NUMBER: _ClassVar[int]
    TIER_FIELD_NUMBER: _ClassVar[int]
    OBJECT_FIELD_NUMBER: _ClassVar[int]
    GOAL_FIELD_NUMBER: _ClassVar[int]
    PATH_FIELD_NUMBER: _ClassVar[int]
    TIERS_FIELD_NUMBER: _ClassVar[int]
    CANDIDATES_FIELD_NUMBER: _ClassVar[int]
    REJECTED_FIELD_NUMBER: _ClassVar[int]
    FALLBACKS_FIELD_NUMBER: _ClassVar[int]
    MAP_VERSION_FIELD_NUMBER: _ClassVar[int]
    REGIONS_REVISION_FIELD_NUMBER: _ClassVar[int]
    COVERAGE_FIELD_NUMBER: _ClassVar[int]
    NEEDS_FIELD_NUMBER: _ClassVar[int]
    outcome: Answer.Outcome
    tier: int
    object: Candidate
    goal: Goal
    path: _containers.RepeatedCompositeFieldContainer[_types_pb2.Vector3]
    tiers: _containers.RepeatedCompositeFieldContainer[TierReport]
    candidates: _containers.RepeatedCompositeFieldContainer[Candidate]
    rejected: _containers.RepeatedCompositeFieldContainer[Candidate]
    fallbacks: _containers.RepeatedScalarFieldContainer[str]
    map_version: int
    regions_revision: int
    coverage: Coverage
    needs: str
    def __init__(self, outcome: _Optional[_Union[Answer.Outcome, str]] = ..., tier: _Optional[int] = ..., object: _Optional[_Union[Candidate, _Mapping]] = ..., goal: _Optional[_Union[Goal, _Mapping]] = ..., path: _Optional[_Iterable[_Union[_types_pb2.Vector3, _Mapping]]] = ..., tiers: _Optional[_Iterable[_Union[TierReport, _Mapping]]] = ..., candidates: _Optional[_Iterable[_Union[Candidate, _Mapping]]] = ..., rejected: _Optional[_Iterable[_Union[Candidate, _Mapping]]] = ..., fallbacks: _Optional[_Iterable[str]] = ..., map_version: _Optional[int] = ..., regions_revision: _Optional[int] = ..., coverage: _Optional[_Union[Coverage, _Mapping]] = ..., needs: _Optional[str] = ...) -> None: ...

class FindEvent(_message.Message):
    __slots__ = ("tier_started", "tier_finished", "viewpoint", "answer")
    TIER_STARTED_FIELD_NUMBER: _ClassVar[int]
    TIER_FINISHED_FIELD_NUMBER: _ClassVar[int]
    VIEWPOINT_FIELD_NUMBER: _ClassVar[int]
    ANSWER_FIELD_NUMBER: _ClassVar[int]
    tier_started: int
    tier_finished: TierReport
    viewpoint: Viewpoint
    answer: Answer
    def __init__(self, tier_started: _Optional[int] = ..., tier_finished: _Optional[_Union[TierReport, _Mapping]] = ..., viewpoint: _Optional[_Union[Viewpoint, _Mapping]] = ..., answer: _Optional[_Union[Answer, _Mapping]] = ...) -> None: ...

class FindResponse(_message.Message):
    __slots__ = ("search_id", "event")
    SEARCH_ID_FIELD_NUMBER: _ClassVar[int]
    EVENT_FIELD_NUMBER: _ClassVar[int]
    search_id: str
    event: FindEvent
    def __init__(self, search_id: _Optional[str] = ..., event: _Optional[_Union[FindEvent, _Mapping]] = ...) -> None: ...

class Observation(_message.Message):
    __slots__ = ("viewpoint_id", "frame_id", "unreachable")
    VIEWPOINT_ID_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    UNREACHABLE_FIELD_NUMBER: _ClassVar[int]
    viewpoint_id: str
    frame_id: str
    unreachable: bool
    def __init__(self, viewpoint_id: _Optional[str] = ..., frame_id: _Optional[str] = ..., unreachable: bool = ...) -> None: ...

class SearchRequest(_message.Message):
    __slots__ = ("start", "resume_search_id", "observation", "cancel")
    START_FIELD_NUMBER: _ClassVar[int]
    RESUME_SEARCH_ID_FIELD_NUMBER: _ClassVar[int]
    OBSERVATION_FIELD_NUMBER: _ClassVar[int]
    CANCEL_FIELD_NUMBER: _ClassVar[int]
    start: FindRequest
    resume_search_id: str
    observation: Observation
    cancel: bool
    def __init__(self, start: _Optional[_Union[FindRequest, _Mapping]] = ..., resume_search_id: _Optional[str] = ..., observation: _Optional[_Union[Observation, _Mapping]] = ..., cancel: bool = ...) -> None: ...

class SearchResponse(_message.Message):
    __slots__ = ("search_id", "event")
    SEARCH_ID_FIELD_NUMBER: _ClassVar[int]
    EVENT_FIELD_NUMBER: _ClassVar[int]
    search_id: str
    event: FindEvent
    def __init__(self, search_id: _Optional[str] = ..., event: _Optional[_Union[FindEvent, _Mapping]] = ...) -> None: ...

class GetSearchRequest(_message.Message):
    __slots__ = ("scene", "search_id")
    SCENE_FIELD_NUMBER: _ClassVar[int]
    SEARCH_ID_FIELD_NUMBER: _ClassVar[int]
    scene: str
    search_id: str
    def __init__(self, scene: _Optional[str] = ..., search_id: _Optional[str] = ...) -> None: ...

class GetSearchResponse(_message.Message):
    __slots__ = ("search_id", "text", "done", "answer")
    SEARCH_ID_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    DONE_FIELD_NUMBER: _ClassVar[int]
    ANSWER_FIELD_NUMBER: _ClassVar[int]
    search_id: str
    text: str
    done: bool
    answer: Answer
    def __init__(self, search_id: _Optional[str] = ..., text: _Optional[str] = ..., done: bool = ..., answer: _Optional[_Union[Answer, _Mapping]] = ...) -> None: ...
