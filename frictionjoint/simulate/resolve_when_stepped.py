"""Models that the callback meets before they are prepared.

A model that is compiled, copied or loaded while friction is on has its parameters, but not yet its
own addresses. The native callback requests them here when it first meets the model.
"""

import ctypes
import threading
import warnings
from typing import Any

from frictionjoint.compiled import external
from frictionjoint.errors import ModelError, ParameterError
from frictionjoint.simulate.block import MAGIC, REFUSED, RESOLVED, blocks, rooms_missed
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.layout import ModelView
from frictionjoint.simulate.pointers import Address
from frictionjoint.simulate.shaft_wave import SHAFT, wave_blocks

# simulations of one model may run side by side
_resolve_lock = threading.Lock()
# functions that compiled code calls
_kept: list[Any] = []


@external
def make_ready(m: Address) -> None:
    """Resolve the friction of a model that is being stepped, so its data exist; if that fails, warn
    once and leave the model without friction."""
    model = ModelView(m)
    with _resolve_lock:
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
                f"friction of a model does not act: {error}", RuntimeWarning, stacklevel=1
            )


@external
def warn_of_no_room(m: Address) -> None:
    """Warn, once per model, of data that were made before their model got room for friction."""
    if m in rooms_missed:
        return
    rooms_missed.add(m)
    warnings.warn(
        "friction does not act in this MjData, which has no room for the friction state: create it "
        "after frictionjoint.attach or load_model",
        RuntimeWarning,
        stacklevel=1,
    )


def bind_python() -> None:
    """Pass the addresses of the functions above to compiled code."""
    for outside in (make_ready, warn_of_no_room):
        function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(outside.stub)
        _kept.append(function)
        outside.bind(function)
