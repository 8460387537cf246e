"""The maps in this process' memory, each as of its scene's last commit."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from typing import ParamSpec, TypeVar

from services.mapper.history import History, MapAt

_P = ParamSpec("_P")
_T = TypeVar("_T")


class OpenMaps:
    """One map a scene, whoever in this process reads or writes it, one at a time."""

    def __init__(self, history: History) -> None:
        self._history = history
        self._open: dict[str, MapAt] = {}
        self._busy: dict[str, asyncio.Lock] = {}

    @contextlib.asynccontextmanager
    async def reading(self, scene: str) -> AsyncIterator[MapAt]:
        """The scene's map as of the last commit, nobody changing it meanwhile."""
        async with self._busy.setdefault(scene, asyncio.Lock()):
            try:
                current = await self._caught_up(scene)
            except BaseException:
                self._open.pop(scene, None)  # interrupted, it may stand anywhere
                raise
            yield current

    @contextlib.asynccontextmanager
    async def changing(self, scene: str) -> AsyncIterator[MapAt]:
        """The same, to be changed and committed; where that fails, forgotten: the log is the truth."""
        async with self.reading(scene) as current:
            try:
                yield current
            except BaseException:
                self._open.pop(scene, None)
                raise

    async def _caught_up(self, scene: str) -> MapAt:
        version = await self._history.newest_version(scene)
        current = self._open.get(scene)
        if current is None or current.objects.version > version:
            self._open[scene] = current = await self._history.at(scene, version)
        if current.objects.version < version:
            await self._history.advance(scene, current, version)
        return current


async def to_its_end(function: Callable[_P, _T], *args: _P.args, **kwargs: _P.kwargs) -> _T:
    """Runs in a thread; a caller that hangs up still waits for it, so that nobody changes a map under its hands."""
    running = asyncio.ensure_future(asyncio.to_thread(function, *args, **kwargs))
    try:
        return await asyncio.shield(running)
    except asyncio.CancelledError:
        while not running.done():
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.wait({running})
        raise
