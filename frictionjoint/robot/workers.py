"""Joints in parallel: in processes, or over the workers of a Dask cluster."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from typing import Any, TypeVar

from frictionjoint.errors import FrictionJointError
from frictionjoint.threads import allow

_T = TypeVar("_T")
_R = TypeVar("_R")
Each = Callable[[Callable[[_T], _R], Iterable[_T]], Iterable[_R]]
# s that a scheduler has to answer
_PATIENCE_S = 15
_ENDS = {signal.SIGINT, signal.SIGTERM}


@contextmanager
def workers(count: int, scheduler: str | None) -> "Iterator[Each]":  # type: ignore[type-arg]
    """A `map` over processes (a single one runs in this process) or, by the scheduler's address,
    over the workers of a Dask cluster; an exception or interruption ends all that was begun.

    Raises:
        FrictionJointError: no scheduler answers there, or `distributed` is not installed.
    """
    if scheduler is not None:
        with _cluster(scheduler) as each:
            yield each
        return
    if count <= 1:
        yield map
        return
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, context, initializer=_begin)
    try:
        with _uninterrupted():
            for _ in range(count):  # each starts one, for none is idle before it has begun
                pool.submit(int)
        yield pool.map
    except BaseException:
        _end(pool)
        raise
    pool.shutdown()


def _end(pool: ProcessPoolExecutor) -> None:
    """End all processes at once; reports of cancelled tasks (Python 3.11) are suppressed."""
    thread: Any = pool._executor_manager_thread  # typeshed has another type
    hook = threading.excepthook
    threading.excepthook = lambda _: None
    try:
        for process in list((pool._processes or {}).values()):
            process.kill()
        pool.shutdown(wait=False, cancel_futures=True)
        if thread is not None:
            thread.join(_PATIENCE_S)
    finally:
        threading.excepthook = hook


@contextmanager
def _cluster(scheduler: str) -> "Iterator[Each]":  # type: ignore[type-arg]
    try:
        distributed: Any = import_module("distributed")  # it has no types
    except ImportError as error:
        fix = "pip install 'frictionjoint[cluster]'"
        raise FrictionJointError(f"--scheduler needs Dask: {fix}") from error
    try:
        client = distributed.Client(scheduler, timeout=_PATIENCE_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        what = "no Dask scheduler answers there, give tcp://HOST:PORT"
        raise FrictionJointError(f"--scheduler {scheduler}: {what}") from error

    def each(function: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[Any]:
        # equal tasks are not one task: none is taken from what an earlier run left there
        futures = client.map(function, list(items), pure=False)
        try:
            for future in futures:
                yield future.result()
        finally:
            client.cancel(futures)

    try:
        yield each
    finally:
        client.close()


def processes(jobs: int) -> int:
    """How many processes to use for as many jobs."""
    return min(jobs, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1)


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Delay signals that end a program: a half-started process would complain about its parent.
    Processes started meanwhile ignore them until `_begin`."""
    held: list[int] = []
    handlers, mask = {}, None
    if threading.current_thread() is threading.main_thread():
        for number in _ENDS:  # another thread may take a signal that this one blocks
            handlers[number] = signal.signal(number, lambda n, _: held.append(n))
    if hasattr(signal, "pthread_sigmask"):  # what is started inherits it
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, _ENDS)
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in handlers.items():
            signal.signal(number, handler)
        if held:
            signal.raise_signal(held[0])


def _begin() -> None:
    """Start a worker with one thread; the other cores have workers of their own."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends them
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDS)
    allow(1)
