"""How a service stands up: gRPC with health, reflection, one error interceptor and the key; alone or among others."""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import signal
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager
from typing import Any

import grpc
from grpc_health.v1 import health, health_pb2, health_pb2_grpc
from grpc_reflection.v1alpha import reflection
from pydantic import ValidationError

from ovip.config import KernelSettings, explain
from ovip.errors import InvalidInput, NotAuthorized, OvipError
from ovip.store import Store
from ovip.telemetry import configure_logging, get_logger

MAX_MESSAGE_BYTES = 16 * 1024 * 1024
_OPEN_TO_ALL = ("/grpc.health.v1.Health/",)
_LOOPBACK = ("127.", "localhost", "::1", "[::1]")

Serve = Callable[[Any, Store], AbstractAsyncContextManager[int]]
log = get_logger("serving")


@contextlib.asynccontextmanager
async def grpc_server(
    name: str,
    service_name: str,
    register: Callable[[grpc.aio.Server], None],
    host: str,
    port: int,
    api_key: str | None,
) -> AsyncIterator[int]:
    """A running gRPC server on `host:port` (0: a free one); yields the bound port. Stops gently on exit.

    Raises InvalidInput where the port is taken, or where it would listen beyond loopback without a key.
    """
    check_exposure(host, api_key)
    server = grpc.aio.server(
        interceptors=[_Guard(api_key), _ErrorsToStatus()],
        options=[
            ("grpc.max_receive_message_length", MAX_MESSAGE_BYTES),
            ("grpc.max_send_message_length", MAX_MESSAGE_BYTES),
            ("grpc.so_reuseport", 0),
        ],
    )
    register(server)
    standing = health.aio.HealthServicer()
    health_pb2_grpc.add_HealthServicer_to_server(standing, server)
    reflection.enable_server_reflection(
        (service_name, health_pb2.DESCRIPTOR.services_by_name["Health"].full_name, reflection.SERVICE_NAME),
        server,
    )
    bound = _bind(server, name, host, port)
    await server.start()
    for served in ("", service_name):
        await standing.set(served, health_pb2.HealthCheckResponse.SERVING)
    log.info("listening", service=name, address=f"{host}:{bound}")
    try:
        yield bound
    finally:
        await standing.enter_graceful_shutdown()
        await server.stop(grace=2.0)


def check_exposure(host: str, api_key: str | None) -> None:
    """InvalidInput where a service would listen beyond loopback without a key."""
    if not api_key and not host.startswith(_LOOPBACK):
        raise InvalidInput(f"OVIP_HOST is {host}: set OVIP_API_KEY before listening beyond this machine")


def run_alone(name: str, settings_kind: type[KernelSettings], serve: Serve) -> None:
    """Runs one service until SIGTERM or SIGINT; a known error ends with one line and status 1."""
    try:
        settings = settings_kind()
        configure_logging(settings.log_level, settings.log_json)
        asyncio.run(_serve_until_told(name, settings, serve))
    except ValidationError as error:
        print(f"{name}: {explain(error)}", file=sys.stderr)
        raise SystemExit(1) from error
    except OvipError as error:
        print(f"{name}: {error}", file=sys.stderr)
        raise SystemExit(1) from error


async def until_told() -> None:
    """Returns on SIGTERM or SIGINT."""
    told = asyncio.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, told.set)
    await told.wait()


@contextlib.asynccontextmanager
async def background(name: str, work: Callable[[], Awaitable[None]]) -> AsyncIterator[None]:
    """Runs `work` beside the block, again a second after it fails (logged); cancelled when the block ends."""
    task = asyncio.create_task(_again_and_again(name, work), name=name)
    try:
        yield
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task


async def _again_and_again(name: str, work: Callable[[], Awaitable[None]]) -> None:
    while True:
        try:
            await work()
            return
        except OvipError as error:
            log.warning("background_failed", work=name, error=str(error))
        except Exception:  # the supervisor of background work: logs whatever it was and starts it again
            log.exception("background_crashed", work=name)
        await asyncio.sleep(1.0)


async def _serve_until_told(name: str, settings: KernelSettings, serve: Serve) -> None:
    store = await Store.connect(settings)
    try:
        async with serve(settings, store):
            await until_told()
            log.info("stopping", service=name)
    finally:
        await store.close()


def _bind(server: grpc.aio.Server, name: str, host: str, port: int) -> int:
    try:
        bound = server.add_insecure_port(f"{host}:{port}")
    except RuntimeError:
        bound = 0
    if not bound:
        raise InvalidInput(
            f"{name}: port {port} on {host} is taken or not allowed; "
            f"free it or set OVIP_{name.upper()}_PORT to another (0: any free one)"
        )
    return int(bound)


class _Guard(grpc.aio.ServerInterceptor):  # type: ignore[misc]
    """Refuses calls without the key; health stays open."""

    def __init__(self, api_key: str | None) -> None:
        self._expected = f"Bearer {api_key}" if api_key else None

    async def intercept_service(self, continuation: Any, details: Any) -> Any:
        handler = await continuation(details)
        if self._expected is None or handler is None or details.method.startswith(_OPEN_TO_ALL):
            return handler
        given = dict(details.invocation_metadata).get("authorization", "")
        if hmac.compare_digest(str(given).encode(), self._expected.encode()):
            return handler
        return _rewrap(handler, _refuse, _refuse_stream)


class _ErrorsToStatus(grpc.aio.ServerInterceptor):  # type: ignore[misc]
    """Turns the error tree into gRPC statuses; anything else is logged and becomes INTERNAL."""

    async def intercept_service(self, continuation: Any, details: Any) -> Any:
        handler = await continuation(details)
        if handler is None or details.method.startswith("/grpc."):
            return handler

        def one(behavior: Any) -> Any:
            async def call(request: Any, context: Any) -> Any:
                try:
                    return await behavior(request, context)
                except Exception as error:  # the one place that turns errors into statuses
                    await _abort(context, error, details.method)

            return call

        def many(behavior: Any) -> Any:
            async def call(request: Any, context: Any) -> Any:
                try:
                    async for reply in behavior(request, context):
                        yield reply
                except Exception as error:  # the one place that turns errors into statuses
                    await _abort(context, error, details.method)

            return call

        return _rewrap(handler, one, many)


async def _abort(context: Any, error: Exception, method: str) -> None:
    if isinstance(error, grpc.aio.AbortError):
        raise error
    if isinstance(error, OvipError):
        context.set_trailing_metadata((("ovip-error", error.slug),))
        await context.abort(grpc.StatusCode[error.code], str(error))
    log.error("call_crashed", method=method, exc_info=error)
    await context.abort(grpc.StatusCode.INTERNAL, "an internal error, logged by the service")


def _refuse(_behavior: Any) -> Any:
    async def call(_request: Any, context: Any) -> None:
        await _abort(context, _no_key(), "")

    return call


def _refuse_stream(_behavior: Any) -> Any:
    async def call(_request: Any, context: Any) -> Any:
        await _abort(context, _no_key(), "")
        yield

    return call


def _no_key() -> NotAuthorized:
    return NotAuthorized("expected metadata 'authorization: Bearer KEY' with the stack's OVIP_API_KEY")


def _rewrap(handler: Any, one: Callable[[Any], Any], many: Callable[[Any], Any]) -> Any:
    serializers = {
        "request_deserializer": handler.request_deserializer,
        "response_serializer": handler.response_serializer,
    }
    if handler.request_streaming and handler.response_streaming:
        return grpc.stream_stream_rpc_method_handler(many(handler.stream_stream), **serializers)
    if handler.request_streaming:
        return grpc.stream_unary_rpc_method_handler(one(handler.stream_unary), **serializers)
    if handler.response_streaming:
        return grpc.unary_stream_rpc_method_handler(many(handler.unary_stream), **serializers)
    return grpc.unary_unary_rpc_method_handler(one(handler.unary_unary), **serializers)
