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

import mujoco
from llvmlite import binding
from numba import types

from frictionjoint.errors import ModelError, ParameterError
from frictionjoint.simulate.carrier import MAGIC, REFUSED, RESOLVED, blocks, resolve
from frictionjoint.simulate.model_view import ModelView
from frictionjoint.simulate.shaft_wave import SHAFT, wave_blocks

# simulations of one model may run side by side
_one_at_a_time = threading.Lock()
# functions that compiled code calls
_kept: list[Any] = []
# addresses of models that were warned of
_without_room: set[int] = set()


def make_ready(model: Any) -> None:
    """Resolve a model's friction; where that fails warn once, and leave the model without it.

    Args:
        model: an MjModel or a `ModelView`; it is being stepped, so its data exist.
    """
    if isinstance(model, mujoco.MjModel):
        model = ModelView(model._address)
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


def warn_of_no_room(address: int) -> None:
    """Warn, once per model, of data that were made before their model got room for friction."""
    if address in _without_room:
        return
    _without_room.add(address)
    warnings.warn(
        "friction does not act in data that were made before their model got room for it: make "
        "them anew, mujoco.MjData(model), after frictionjoint.attach or load_model",
        RuntimeWarning,
        stacklevel=2,
    )


def _by_address(
    symbol: str, function: Callable[[int], None]
) -> "Callable[[ctypes.c_void_p], None]":
    """A Python function of an address for compiled code."""
    called = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(function)
    _kept.append(called)
    binding.add_symbol(symbol, ctypes.cast(called, ctypes.c_void_p).value)
    return cast(
        "Callable[[ctypes.c_void_p], None]",
        types.ExternalFunction(symbol, types.void(types.voidptr)),
    )


make_ready_in_c = _by_address(
    "frictionjoint_make_ready", lambda address: make_ready(ModelView(address))
)
"""`make_ready` for compiled code, by the address of the model."""
warn_of_no_room_in_c = _by_address("frictionjoint_no_room", warn_of_no_room)
"""`warn_of_no_room` for compiled code, by the address of the model."""
