"""Threads where they help: points of a search side by side, linear algebra on one.

The matrices of a fit are tall and narrow: the threads of a BLAS library wait for each other longer
than they work. Measured on two cores: a loop of 45 s takes 36 s on one thread, and half the
processor time, which parallel trials compete for.
"""

import functools
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

from numba import config
from threadpoolctl import threadpool_limits

_P = ParamSpec("_P")
_R = TypeVar("_R")


def one_thread(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """The same function with one BLAS thread while it runs; what the caller set comes back."""

    @functools.wraps(function)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return run


_busy = threading.local()


@contextmanager
def side_by_side() -> Iterator[Callable[..., Any]]:
    """A `map` on as many threads as numba may use, the setting ``NUMBA_NUM_THREADS``.

    What it maps spends its time in kernels, filters and linear algebra, which hold no lock. Within
    one of its threads it is the plain `map`: the outermost loop is the one worth sharing. The
    threads live as long as the context: those of a process do not pass to one forked from it.
    """
    threads = int(config.NUMBA_NUM_THREADS)  # type: ignore[attr-defined]
    if threads == 1 or getattr(_busy, "inside", False):
        yield map
        return
    with ThreadPoolExecutor(threads, initializer=_enter) as pool:
        yield pool.map


def _enter() -> None:
    _busy.inside = True
