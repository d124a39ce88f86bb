"""How kernels are compiled.

numba compiles into a function all that it calls, again at every level, and a law is called from
many places. `late` cuts it off there: its callers hold a pointer to it, and it is compiled, or
loaded from numba's cache, when it is first called or asked for, once for all of them. So a model
with one law and no effects waits for no other law and for no effect.
"""

import ctypes
import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from llvmlite import binding, ir
from numba import cfunc, config, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

from frictionjoint.arrays import Vector

# Division by zero is as in C: the test for it would be most of a small kernel. Other threads go on
# meanwhile, see `threads.side_by_side`.
compiled = njit(cache=True, error_model="numpy", nogil=True)
# for a function that every step calls: the call would cost as much as its work
in_line = njit(cache=True, error_model="numpy", nogil=True, forceinline=True)

# without annotations of its own
_types: Any = types
_utils: Any = cgutils
_config: Any = config
REAL, WHOLE, NOTHING = types.float64, types.int64, types.void
VECTOR = _types.CPointer(REAL)
_C: dict[Any, Any] = {
    REAL: ctypes.c_double,
    WHOLE: ctypes.c_int64,
    VECTOR: ctypes.c_void_p,
    NOTHING: None,
}


@intrinsic
def _address(typing_context: Any, array: Any, at: Any) -> tuple[Any, Any]:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.gep(data, [arguments[1]])

    return _types.CPointer(array.dtype)(array, WHOLE), generate


@intrinsic
def _zeros(typing_context: Any, n: Any) -> tuple[Any, Any]:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        made = builder.alloca(ir.DoubleType(), size=arguments[0])
        size = builder.mul(arguments[0], context.get_constant(WHOLE, 8))
        _utils.memset(builder, made, size, 0)
        return made

    return VECTOR(WHOLE), generate


# A kernel for pointers serves simulations, which have no arrays, and logs: compiled once for both.
_jit = not _config.DISABLE_JIT
pointer = cast(
    "Callable[[Vector, int], Vector]",
    _address if _jit else lambda array, at: array.reshape(-1)[at:],
)
"""Pointer to number `at` of a contiguous array, which must be an argument: others end here."""
room = cast("Callable[[int], Vector]", _zeros if _jit else np.zeros)
"""Pointer to so many zeros, on the stack of the function that asks for them."""
whole = cast("Callable[[int], int]", np.int64)
"""A whole number written out, as one of any value: else a kernel is compiled for each of them."""

_Function = TypeVar("_Function", bound=Callable[..., Any])
_links: dict[Any, Callable[[], int]] = {}
# compiled code knows these by address alone, for as long as the process lives
_kept: list[Any] = []


def late(function: _Function, signature: Any) -> _Function:
    """The same function for compiled code to call, compiled apart and not before it is needed.

    Args:
        function: compiled by numba, defined in a module.
        signature: of REAL, WHOLE and, for arrays and pointers alike, VECTOR.
    """
    if not _jit:
        return function
    plain = cast("Any", function).py_func
    symbol = f"{plain.__module__}.{plain.__name__}".replace(".", "_")
    prototype = ctypes.CFUNCTYPE(*(_C[kind] for kind in (signature.return_type, *signature.args)))

    @functools.lru_cache(maxsize=1)
    def linked() -> int:
        native = cfunc(signature, cache=True, error_model="numpy")(plain)
        _kept.append(native)
        place.value = native.address
        return int(place.value or 0)

    def link_and_call(*arguments: Any) -> Any:
        return prototype(linked())(*arguments)

    first = prototype(link_and_call)
    place = ctypes.c_void_p(ctypes.cast(first, ctypes.c_void_p).value)
    binding.add_symbol(symbol, ctypes.addressof(place))

    def call(typing_context: Any, *arguments: Any) -> tuple[Any, Any]:
        pairs = zip(signature.args, arguments, strict=True)
        given = [theirs if wanted == VECTOR else wanted for wanted, theirs in pairs]
        return signature.return_type(*given), generate

    def generate(context: Any, builder: Any, given: Any, arguments: Any) -> Any:
        values = [
            context.make_array(kind)(context, builder, value).data
            if isinstance(kind, types.Array)
            else value
            for kind, value in zip(given.args, arguments, strict=True)
        ]
        kinds = [context.get_value_type(kind) for kind in signature.args]
        result = ir.VoidType() if signature.return_type == NOTHING else ir.DoubleType()
        pointer = ir.FunctionType(result, kinds).as_pointer()
        held = builder.module.globals.get(symbol)
        held = held or ir.GlobalVariable(builder.module, pointer, symbol)
        got = builder.call(builder.load(held), values)
        return context.get_dummy_value() if signature.return_type == NOTHING else got

    parameters = list(inspect.signature(plain).parameters.values())
    context = inspect.Parameter("typing_context", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    cast("Any", call).__signature__ = inspect.Signature([context, *parameters])
    calling: Any = intrinsic(call)
    # for what reads the source: frictionjoint.simulate.warp_source
    calling.py_func, calling.targetoptions = plain, {}
    _links[calling] = linked
    _kept.append((place, first))
    return cast("_Function", calling)


def link(function: Any) -> None:
    """Compile or load a `late` function now; nothing to do where numba does not compile."""
    if _jit:
        _links[function]()
