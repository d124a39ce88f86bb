"""Threads where they help: points of a search side by side, linear algebra on one.

The matrices of a fit are tall and narrow: the threads of a BLAS library wait for each other longer
than they work. Measured on two cores: a loop of 45 s takes 36 s on one BLAS thread, and half the
processor time, which parallel trials compete for.
"""

import functools
import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

import scipy.linalg  # noqa: F401  brings its own BLAS
from threadpoolctl import ThreadpoolController

_P = ParamSpec("_P")
_R = TypeVar("_R")


def one_thread(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """The same function on one thread of each library while it runs; then as the caller had it."""

    @functools.wraps(function)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        with _libraries().limit(limits=1):
            return function(*args, **kwargs)

    return run


@functools.cache
def _libraries() -> ThreadpoolController:
    """Those of numpy and scipy: to look for them takes as long as a small fit."""
    return ThreadpoolController()


_busy = threading.local()


def _cores() -> int:
    """Processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


_allowed = int(os.environ.get("FRICTIONJOINT_THREADS") or _cores())


def allow(threads: int) -> None:
    """Threads that work is shared among from now on; at first ``FRICTIONJOINT_THREADS``, or one
    for each core of the process.
    """
    global _allowed
    _allowed = threads


@contextmanager
def side_by_side() -> Iterator[Callable[..., Any]]:
    """A `map` on as many threads as `allow` says.

    What it maps spends its time in kernels, filters and linear algebra, which hold no lock. Within
    one of its threads it is the plain `map`: the outermost loop is the one worth sharing. The
    threads live as long as the process: a search asks for them thousands of times.
    """
    threads = threads_here()
    yield map if threads == 1 else _pool(os.getpid(), threads).map


def threads_here() -> int:
    """How many threads `side_by_side` would use here: so many parts are worth making of a whole."""
    if getattr(_busy, "inside", False):
        return 1
    return _allowed


@functools.lru_cache(maxsize=1)
def _pool(process: int, threads: int) -> ThreadPoolExecutor:
    """The threads of a process, which do not pass to one that is forked from it."""
    return ThreadPoolExecutor(threads, initializer=_enter)


def _enter() -> None:
    _busy.inside = True
