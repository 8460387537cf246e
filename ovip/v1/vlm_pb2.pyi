from ovip.v1 import types_pb2 as _types_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class AskRequest(_message.Message):
    __slots__ = ("purpose", "prompt", "images", "json_schema", "max_output_tokens", "deadline_s")
    class Purpose(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        PURPOSE_UNSPECIFIED: _ClassVar[AskRequest.Purpose]
        PURPOSE_SEARCH: _ClassVar[AskRequest.Purpose]
        PURPOSE_ENUMERATE: _ClassVar[AskRequest.Purpose]
        PURPOSE_GROUP: _ClassVar[AskRequest.Purpose]
    PURPOSE_UNSPECIFIED: AskRequest.Purpose
    PURPOSE_SEARCH: AskRequest.Purpose
    PURPOSE_ENUMERATE: AskRequest.Purpose
    PURPOSE_GROUP: AskRequest.Purpose
    PURPOSE_FIELD_NUMBER: _ClassVar[int]
    PROMPT_FIELD_NUMBER: _ClassVar[int]
    IMAGES_FIELD_NUMBER: _ClassVar[int]
    JSON_SCHEMA_FIELD_NUMBER: _ClassVar[int]
    MAX_OUTPUT_TOKENS_FIELD_NUMBER: _ClassVar[int]
    DEADLINE_S_FIELD_NUMBER: _ClassVar[int]
    purpose: AskRequest.Purpose
    prompt: str
    images: _containers.RepeatedCompositeFieldContainer[_types_pb2.Image]
    json_schema: str
    max_output_tokens: int
    deadline_s: float
    def __init__(self, purpose: _Optional[_Union[AskRequest.Purpose, str]] = ..., prompt: _Optional[str] = ..., images: _Optional[_Iterable[_Union[_types_pb2.Image, _Mapping]]] = ..., json_schema: _Optional[str] = ..., max_output_tokens: _Optional[int] = ..., deadline_s: _Optional[float] = ...) -> None: ...

class AskResponse(_message.Message):
    __slots__ = ("json", "cached", "route", "prompt_tokens", "output_tokens", "milliseconds")
    JSON_FIELD_NUMBER: _ClassVar[int]
    CACHED_FIELD_NUMBER: _ClassVar[int]
    ROUTE_FIELD_NUMBER: _ClassVar[int]
    PROMPT_TOKENS_FIELD_NUMBER: _ClassVar[int]
    OUTPUT_TOKENS_FIELD_NUMBER: _ClassVar[int]
    MILLISECONDS_FIELD_NUMBER: _ClassVar[int]
    json: str
    cached: bool
    route: str
    prompt_tokens: int
    output_tokens: int
    milliseconds: float
    def __init__(self, json: _Optional[str] = ..., cached: bool = ..., route: _Optional[str] = ..., prompt_tokens: _Optional[int] = ..., output_tokens: _Optional[int] = ..., milliseconds: _Optional[float] = ...) -> None: ...

class GetGatewayStatusRequest(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class GetGatewayStatusResponse(_message.Message):
    __slots__ = ("configured", "routes", "calls", "cache_hits", "refused")
    CONFIGURED_FIELD_NUMBER: _ClassVar[int]
    ROUTES_FIELD_NUMBER: _ClassVar[int]
    CALLS_FIELD_NUMBER: _ClassVar[int]
    CACHE_HITS_FIELD_NUMBER: _ClassVar[int]
    REFUSED_FIELD_NUMBER: _ClassVar[int]
    configured: bool
    routes: _containers.RepeatedScalarFieldContainer[str]
    calls: int
    cache_hits: int
    refused: int
    def __init__(self, configured: bool = ..., routes: _Optional[_Iterable[str]] = ..., calls: _Optional[int] = ..., cache_hits: _Optional[int] = ..., refused: _Optional[int] = ...) -> None: ...
