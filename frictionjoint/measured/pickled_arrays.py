"""Arrays of numpy inside a pickle, for an unpickler that imports nothing.

numpy pickles an array as an empty array followed by a state of shape, type and bytes. The classes
here stand in for numpy's and accept such states; they call nothing else.
"""

import math
import pickle
import re
from collections.abc import Callable
from typing import Any

import numpy as np

_NUMBERS = re.compile(r"[iu][1248]|f[248]|b1")


class PickledArray:
    """An array whose state follows it in the pickle; `numbers` is the array."""

    numbers: np.ndarray[Any, Any]

    def __init__(self, *_: Any) -> None:
        self.numbers = np.zeros(0)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _, shape, kind, by_columns, content = state
        if not (isinstance(kind, _Kind) and isinstance(content, bytes)):
            raise pickle.UnpicklingError("an array of something other than numbers")
        size = math.prod(shape)
        if min(shape, default=0) < 0 or size * kind.dtype.itemsize != len(content):
            raise pickle.UnpicklingError(f"an array of shape {shape} in {len(content)} bytes")
        numbers = np.frombuffer(content, kind.dtype)
        self.numbers = numbers.reshape(shape[::-1]).T if by_columns else numbers.reshape(shape)


class _Kind:
    """Type of an array's numbers; its byte order is its state."""

    def __init__(self, code: str, *_: Any) -> None:
        if not (isinstance(code, str) and _NUMBERS.fullmatch(code)):
            raise pickle.UnpicklingError(f"an array of {code!r}, not of numbers")
        self.dtype = np.dtype(code)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        if state[1] in ("<", ">"):
            self.dtype = self.dtype.newbyteorder(state[1])


def _bytes(text: str, code: str) -> bytes:
    """Bytes in the encoding of older pickles."""
    if code != "latin1":
        raise pickle.UnpicklingError(f"_codecs.encode to {code!r}")
    return text.encode("latin1")


_RECONSTRUCT = ("numpy.core.multiarray", "numpy._core.multiarray")


def stand_in(module: str, name: str) -> Callable[..., Any] | None:
    """Replacement for a name of numpy in a pickle; None if an array does not need it."""
    if module in _RECONSTRUCT and name == "_reconstruct":
        return PickledArray
    known: dict[tuple[str, str], Callable[..., Any]] = {
        # the class of the array, which a stand-in of `_reconstruct` is given
        ("numpy", "ndarray"): PickledArray,
        ("numpy", "dtype"): _Kind,
        ("_codecs", "encode"): _bytes,
    }
    return known.get((module, name))
