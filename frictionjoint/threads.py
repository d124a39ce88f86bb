"""Linear algebra on one thread.

The matrices of a fit are tall and narrow: the threads of a BLAS library wait for each other longer
than they work. Measured on two cores: a loop of 45 s takes 36 s on one thread, and half the
processor time, which trials side by side have to share.
"""

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

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
