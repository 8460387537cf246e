"""A uvicorn server inside a running event loop, beside other services."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator, Iterator

import uvicorn
from fastapi import FastAPI

from ovip.errors import InvalidInput

_STOP_SECONDS = 3
_BACKLOG = 512


@contextlib.asynccontextmanager
async def listening(app: FastAPI, host: str, port: int, stopping: asyncio.Event) -> AsyncIterator[int]:
    """The app served on `host:port` (0: a free one); yields the bound port. Stops gently at the end.

    Raises InvalidInput where the port cannot be had. `stopping` is set first, so that event streams end.
    """
    bound = _bind(host, port)
    config = uvicorn.Config(
        app, lifespan="off", log_config=None, access_log=False, timeout_graceful_shutdown=_STOP_SECONDS
    )
    server = _Server(config)
    serving = asyncio.create_task(server.serve(sockets=[bound]), name="api")
    try:
        await server.standing.wait()
        yield int(bound.getsockname()[1])
    finally:
        stopping.set()
        server.should_exit = True
        await serving
        bound.close()


class _Server(uvicorn.Server):
    """Leaves signals to the process it runs in, and says when it stands."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.standing = asyncio.Event()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        try:
            await super().startup(sockets)
        finally:
            self.standing.set()

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def _bind(host: str, port: int) -> socket.socket:
    """A listening socket. Its protocol is named because asyncio turns Nagle's delay off for such sockets only."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        bound = socket.socket(family, kind, protocol or socket.IPPROTO_TCP)
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        bound.bind(address)
        bound.listen(_BACKLOG)
    except OSError as error:
        raise InvalidInput(
            f"api: cannot listen on {host} port {port} ({error.strerror or error}); free it, or set "
            "OVIP_API_PORT to another port (0: any free one)"
        ) from error
    bound.setblocking(False)
    return bound
