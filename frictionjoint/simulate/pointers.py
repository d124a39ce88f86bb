"""MuJoCo's structures and functions as compiled code reaches them.

Addresses of arrays stay pointers: numba's arrays carry a shape and a count of references, which
every function in between would hand on, and which the law does not need.
"""

import ctypes
import functools
import os
from collections.abc import Callable
from typing import Any, cast

import mujoco
from llvmlite import binding
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from frictionjoint.arrays import Vector
from frictionjoint.compiled import VECTOR

# without annotations of their own
_make: Any = types
_utils: Any = cgutils


@intrinsic
def _field(typing_context: Any, owner: Any, at: Any, kind: Any) -> tuple[Any, Any]:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address = _utils.pointer_add(builder, arguments[0], arguments[1])
        return builder.bitcast(address, context.get_value_type(signature.return_type))

    return _make.CPointer(kind.dtype)(types.voidptr, types.int64, kind), generate


@intrinsic
def _array(typing_context: Any, owner: Any, at: Any, kind: Any) -> tuple[Any, Any]:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address = _utils.pointer_add(builder, arguments[0], arguments[1])
        pointer = context.get_value_type(signature.return_type)
        return builder.load(builder.bitcast(address, pointer.as_pointer()))

    return _make.CPointer(kind.dtype)(types.voidptr, types.int64, kind), generate


# the typing context is numba's own business: compiled code passes the rest alone
field = cast("Callable[[ctypes.c_void_p, int, Any], Vector]", _field)
"""A structure's number `at` bytes from its beginning, of a type of numba's, as field(...)[0]."""
array = cast("Callable[[ctypes.c_void_p, int, Any], Vector]", _array)
"""The array whose address a structure holds `at` bytes from its beginning."""


@functools.lru_cache(maxsize=1)
def _load_library() -> None:
    """Let compiled code find MuJoCo's own functions by name, so that it can be cached."""
    folder = os.path.dirname(mujoco.__file__)
    library = next(f for f in sorted(os.listdir(folder)) if "libmujoco" in f or f == "mujoco.dll")
    binding.load_library_permanently(os.path.join(folder, library))


_load_library()
mj_rne = cast(
    "Callable[[ctypes.c_void_p, ctypes.c_void_p, int, Vector], None]",
    types.ExternalFunction("mj_rne", types.void(types.voidptr, types.voidptr, types.int32, VECTOR)),
)
mj_mul_m = cast(
    "Callable[[ctypes.c_void_p, ctypes.c_void_p, Vector, Vector], None]",
    types.ExternalFunction("mj_mulM", types.void(types.voidptr, types.voidptr, VECTOR, VECTOR)),
)
mj_factor_m = cast(
    "Callable[[ctypes.c_void_p, ctypes.c_void_p], None]",
    types.ExternalFunction("mj_factorM", types.void(types.voidptr, types.voidptr)),
)
mj_project_constraint = cast(
    "Callable[[ctypes.c_void_p, ctypes.c_void_p], None]",
    types.ExternalFunction("mj_projectConstraint", types.void(types.voidptr, types.voidptr)),
)
mj_mark_stack = cast(
    "Callable[[ctypes.c_void_p], None]",
    types.ExternalFunction("mj_markStack", types.void(types.voidptr)),
)
mj_free_stack = cast(
    "Callable[[ctypes.c_void_p], None]",
    types.ExternalFunction("mj_freeStack", types.void(types.voidptr)),
)
mj_stack_numbers = cast(
    "Callable[[ctypes.c_void_p, int], Vector]",
    types.ExternalFunction("mj_stackAllocNum", VECTOR(types.voidptr, types.uint64)),
)
"""Room for doubles on the data's own stack: no allocation, and each thread's data has its own."""
