"""Threads: points of a search in parallel, linear algebra on one thread.

The matrices of a fit are tall and narrow, and the threads of a BLAS library wait for each other
longer than they compute. Measured on two cores: a loop of 45 s takes 36 s with one BLAS thread, and
half the processor time, which parallel trials need.
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
    """Run a function with one thread per numerical library, and restore the setting afterwards."""

    @functools.wraps(function)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        with _libraries().limit(limits=1):
            return function(*args, **kwargs)

    return run


@functools.cache
def _libraries() -> ThreadpoolController:
    """BLAS libraries of numpy and scipy, cached: to find them takes as long as a small fit."""
    return ThreadpoolController()


_busy = threading.local()


_cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
_allowed = int(os.environ.get("FRICTIONJOINT_THREADS") or _cores or 1)


def allow(threads: int) -> None:
    """Set the number of threads, at first ``FRICTIONJOINT_THREADS`` or one per core."""
    global _allowed
    _allowed = threads


@contextmanager
def side_by_side() -> Iterator[Callable[..., Any]]:
    """A `map` on the number of threads that `allow` permits.

    The mapped functions spend their time in kernels, filters and linear algebra, which release
    Python's lock. Within a thread of such a map it is the plain `map`, because only the outermost
    loop is worth distributing. The threads are kept, because a search uses them thousands of times.
    """
    threads = threads_here()
    yield map if threads == 1 else _pool(os.getpid(), threads).map


def threads_here() -> int:
    """Number of threads that `side_by_side` would use here."""
    return 1 if getattr(_busy, "inside", False) else _allowed


@functools.lru_cache(maxsize=1)
def _pool(process: int, threads: int) -> ThreadPoolExecutor:
    """The threads of a process; a forked process gets its own."""
    return ThreadPoolExecutor(threads, initializer=setattr, initargs=(_busy, "inside", True))
