"""Types of arrays in signatures, their rounding and rms, and other libraries' arrays."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]
# of the difference of two numbers in single precision, relative to them
ROUNDING = 2.0 * float(np.finfo(np.float32).eps)


class Vector(Protocol):
    """A float64 array of shape (n,) in a kernel, which accesses its numbers by index.

    An element of ``NDArray`` is ``Any`` to a type checker, and ``Any`` hides mistakes.
    """

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> float: ...

    def __setitem__(self, index: int, value: float, /) -> None: ...


def root_mean_square(x: Array) -> float:
    """Square root of the mean square of an array of any shape, not empty."""
    return float(np.sqrt(np.mean(np.square(x))))


def like(given: Any, made: Array) -> Any:
    """A numpy array, or an array on a device, in the array library of another array."""
    library = type(given).__module__.partition(".")[0]
    if library == "torch":
        import torch

        return torch.from_dlpack(made)
    if library in ("jax", "jaxlib"):
        import jax

        return jax.dlpack.from_dlpack(made)
    if library == "warp":
        import warp

        return made if isinstance(made, warp.array) else warp.from_dlpack(made)
    return made
