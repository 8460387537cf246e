"""Work over many scenes in processes of its own, in order, the cores shared out."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import TypeVar

T = TypeVar("T")
S = TypeVar("S")
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def in_processes(task: Callable[[S], T], items: Sequence[S], workers: int) -> list[T]:
    """`task` of each item, in order. One worker, or one item: in this process."""
    if min(workers, len(items)) <= 1:
        return [task(item) for item in items]
    with _one_thread_each(), ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        return list(pool.map(task, items))


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes started meanwhile keep their linear algebra to one thread: the cores are shared out already."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name)
            else:
                os.environ[name] = value
