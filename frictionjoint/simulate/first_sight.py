"""Models that the callback meets before anybody has made them ready.

A model that is compiled, copied or loaded while friction acts carries its parameters, but not yet
the addresses that belong to it. The native callback asks for them here when it first sees the
model: one call into Python in the life of a model.
"""

import ctypes
import threading
import warnings
from collections.abc import Callable
from typing import Any, cast

from llvmlite import binding
from numba import types

from frictionjoint.errors import ModelError, ParameterError
from frictionjoint.simulate.carrier import MAGIC, REFUSED, RESOLVED, blocks, resolve
from frictionjoint.simulate.model_view import ModelView
from frictionjoint.simulate.shaft_wave import SHAFT, wave_blocks

_SYMBOL = "frictionjoint_make_ready"
# simulations of one model may run side by side
_one_at_a_time = threading.Lock()


def make_ready(model: Any) -> None:
    """Resolve a model's friction; where that fails warn once, and leave the model without it.

    Args:
        model: an MjModel or a `ModelView`.
    """
    with _one_at_a_time:
        found = [*blocks(model).values(), *wave_blocks(model).values()]
        if not any(model.numeric_data[at + RESOLVED] == 0.0 for at in found):
            return  # another thread was here first, or a numeric that is no friction of ours
        try:
            resolve(model)
        except (ModelError, ParameterError) as error:
            for at in found:
                if model.numeric_data[at] in (MAGIC, SHAFT):
                    model.numeric_data[at + RESOLVED] = REFUSED
            warnings.warn(
                f"friction of a model does not act: {error}", RuntimeWarning, stacklevel=2
            )


def _called_from_c(address: int) -> None:
    make_ready(ModelView(address))


_kept = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(_called_from_c)
binding.add_symbol(_SYMBOL, ctypes.cast(_kept, ctypes.c_void_p).value)
make_ready_in_c = cast(
    "Callable[[ctypes.c_void_p], None]",
    types.ExternalFunction(_SYMBOL, types.void(types.voidptr)),
)
"""`make_ready` for compiled code, by the address of the model."""
