"""Least-recently-used cache of arrays derived from logs."""

from collections import OrderedDict
from collections.abc import Callable
from threading import Lock
from typing import Any

from numpy.typing import NDArray


class Cache:
    """Least-recently-used cache of arrays by key.

    Threads may use it in parallel. It is not passed to other processes.

    Args:
        most: size in bytes.
    """

    def __init__(self, most: int) -> None:
        self._most, self._held = most, 0
        self._found: OrderedDict[object, NDArray[Any]] = OrderedDict()
        self._lock = Lock()

    def __reduce__(self) -> tuple[type["Cache"], tuple[int]]:
        return Cache, (self._most,)

    def get(self, key: object, make: Callable[[], NDArray[Any]]) -> NDArray[Any]:
        """The array of a key, computed if necessary; it must not be changed."""
        with self._lock:
            if key in self._found:
                self._found.move_to_end(key)
                return self._found[key]
        made = make()
        with self._lock:
            if key not in self._found:
                self._found[key] = made
                self._held += made.nbytes
            while self._held > self._most and len(self._found) > 1:
                self._held -= self._found.popitem(last=False)[1].nbytes
        return made
