"""Joints side by side in processes of their own."""

import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from numba import config

_T = TypeVar("_T")
_R = TypeVar("_R")
Each = Callable[[Callable[[_T], _R], Iterable[_T]], Iterable[_R]]


@contextmanager
def workers(count: int) -> "Iterator[Each]":  # type: ignore[type-arg]
    """A `map` over processes; of one alone in this one.

    An exception, and an interruption too, ends them all.
    """
    if count <= 1:
        yield map
        return
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, context, initializer=_begin)
    try:
        yield pool.map
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.terminate()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def processes(jobs: int) -> int:
    """How many processes to use for as many jobs."""
    return min(jobs, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1)


def _begin() -> None:
    """A worker of one thread: the other cores have workers of their own."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends them
    config.NUMBA_NUM_THREADS = 1  # type: ignore[attr-defined]
