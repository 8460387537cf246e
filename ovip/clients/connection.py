"""Channels to the services, and how their calls fail: as our tree of errors, reads tried again."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable, Iterator
from typing import Any

import grpc

from ovip.errors import OvipError, Unavailable, from_status

MAX_MESSAGE_BYTES = 16 * 1024 * 1024
READ_SECONDS = 30.0
SLOW_SECONDS = 600.0
_PAUSES = (0.1, 0.5, 1.5)


def connect(address: str, api_key: str | None = None) -> Any:
    """An asyncio channel to `host:port` that carries the key and survives a restart of the other side."""
    return grpc.aio.insecure_channel(
        address,
        options=[
            ("grpc.max_receive_message_length", MAX_MESSAGE_BYTES),
            ("grpc.max_send_message_length", MAX_MESSAGE_BYTES),
            ("grpc.initial_reconnect_backoff_ms", 100),
            ("grpc.max_reconnect_backoff_ms", 1000),
            ("grpc.enable_http_proxy", 0),
        ],
        interceptors=_key_interceptors(api_key),
    )


async def read(call: Callable[[], Awaitable[Any]]) -> Any:
    """The reply of a call that may be made twice; tried four times over two seconds while the service is away."""
    for pause in _PAUSES:
        try:
            with errors():
                return await call()
        except Unavailable:
            await asyncio.sleep(pause)
    with errors():
        return await call()


async def read_stream(call: Callable[[], Any]) -> list[Any]:
    """All replies of a stream that ends by itself; one that breaks half way is read again from its start."""

    async def replies() -> list[Any]:
        return [reply async for reply in call()]

    result: list[Any] = await read(replies)
    return result


@contextlib.contextmanager
def errors() -> Iterator[None]:
    try:
        yield
    except grpc.aio.AioRpcError as error:
        raise error_of(error) from error


def error_of(error: grpc.aio.AioRpcError) -> OvipError:
    """The error of our tree that a gRPC status stands for."""
    trailing = dict(error.trailing_metadata() or ())
    slug = str(trailing.get("ovip-error", ""))
    return from_status(error.code().name, error.details() or error.code().name, slug)


def _key_interceptors(api_key: str | None) -> list[Any]:
    if not api_key:
        return []
    kinds = ("UnaryUnary", "UnaryStream", "StreamUnary", "StreamStream")
    return [_key_interceptor(kind, f"Bearer {api_key}") for kind in kinds]


def _key_interceptor(kind: str, value: str) -> Any:
    base = getattr(grpc.aio, f"{kind}ClientInterceptor")

    async def intercept(_self: Any, continuation: Any, details: Any, request: Any) -> Any:
        metadata = grpc.aio.Metadata(*(details.metadata or ()))
        metadata.add("authorization", value)
        return await continuation(details._replace(metadata=metadata), request)

    name = {"UnaryUnary": "unary_unary", "UnaryStream": "unary_stream", "StreamUnary": "stream_unary"}.get(
        kind, "stream_stream"
    )
    return type(f"Key{kind}", (base,), {f"intercept_{name}": intercept})()
