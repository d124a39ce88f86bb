"""The passive-force callback in Python: the code of `simulate.native`, with MjModel and MjData for
addresses, and their attributes for offsets.
"""

import types
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from frictionjoint.simulate import motor, native
from frictionjoint.simulate.layout import DATA_NAMES, MODEL_NAMES, structure
from frictionjoint.simulate.resolve_when_stepped import make_ready, warn_of_no_room


def _field(owner: Any, name: Any) -> Any:
    """An attribute as an array of one index; empty where this MuJoCo lacks it, which is 0."""
    if name == 0:
        return np.zeros(0, dtype=np.int32)
    return np.ravel(getattr(owner if hasattr(owner, name) else owner.opt, name))


def _whole(owner: Any, name: Any) -> list[Any]:
    """A number of the structure; of an array, in place of its address, the size."""
    value = getattr(owner, name)
    return [value.size if isinstance(value, np.ndarray) else value]


def _give_back_projection(data: mujoco.MjData) -> None:
    """`native.give_back_projection`; its fields are no attributes."""
    fields = structure("mjData").from_address(data._address)
    begins = [getattr(fields, name, None) for name in native.PROJECTED]
    lowest = min((begin for begin in begins if begin), default=None)
    if lowest is not None:
        fields.parena = lowest - fields.arena


def _names(names: tuple[str, ...], *owners: type) -> list[Any]:
    return [name if any(hasattr(owner, name) for owner in owners) else 0 for name in names]


_IN_PYTHON: dict[str, Any] = {
    "AT": [
        *_names(MODEL_NAMES, mujoco.MjModel, mujoco.MjOption),
        *_names(DATA_NAMES, mujoco.MjData),
    ],
    **dict.fromkeys(("reals", "shorts", "reals_in", "shorts_in"), _field),
    "wholes_in": _whole,
    "flags": lambda owner, name: _field(owner, name).view(np.bool_),
    "lacks_room": lambda model, data: len(data.userdata) < int(model.nuserdata),
    "give_back_projection": _give_back_projection,
    "warn_of_no_room_in_c": lambda model: warn_of_no_room(model._address),
    "make_ready_in_c": make_ready,
    **{n: getattr(mujoco, n) for n in ("mj_factorM", "mj_mulM", "mj_projectConstraint", "mj_rne")},
    # Python passes a whole array where C passes its beginning
    "mj_applyFT": lambda m, d, *xs: mujoco.mj_applyFT(m, d, *(x[:3] for x in xs[:3]), *xs[3:]),
    "mj_stackAllocNum": lambda data, n: np.zeros(n),
    # Python's own memory needs no mark
    **dict.fromkeys(("mj_markStack", "mj_freeStack"), lambda data: None),
}


def _in_python(kernel: Any, name: str, **more: Any) -> Any:
    """A kernel of addresses as a function of MuJoCo's own objects."""
    code, names = kernel.py_func.__code__, kernel.py_func.__globals__
    return types.FunctionType(code, {**names, **_IN_PYTHON, **more}, name)


python_callback: Callable[[mujoco.MjModel, mujoco.MjData], None] = _in_python(
    native.native,
    "python_callback",
    outside=_in_python(native.outside, "outside"),
    commanded_torque=_in_python(motor.commanded_torque, "commanded_torque"),
)
"""The callback in Python: slower than in C, but every line can be stepped through."""
