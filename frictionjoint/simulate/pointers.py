"""MuJoCo's structures and functions as compiled code reaches them.

A structure is an address, and a field of it lies so many bytes behind it (``simulate.layout``).
"""

import ctypes
import os
from typing import Any

import mujoco

from frictionjoint.arrays import Index, Vector
from frictionjoint.compiled import External, c_text, external

Address = int
Size = int
"""C's size_t; an ``int`` of a function from elsewhere is C's int."""
Shorts = Index
Flags = Index
"""int32 and uint8 arrays of MuJoCo's."""


@c_text("(*(double **)({0} + {1}))")
def reals(owner: Address, at: int) -> Vector:
    """The array of doubles whose address a structure holds `at` bytes from its beginning."""
    raise NotImplementedError


@c_text("(*(int32_t **)({0} + {1}))")
def shorts(owner: Address, at: int) -> Shorts:
    """The same of ints."""
    raise NotImplementedError


@c_text("(*(uint8_t **)({0} + {1}))")
def flags(owner: Address, at: int) -> Flags:
    """The same of bytes."""
    raise NotImplementedError


@c_text("((double *)({0} + {1}))")
def reals_in(owner: Address, at: int) -> Vector:
    """The doubles that a structure itself holds there."""
    raise NotImplementedError


@c_text("((int32_t *)({0} + {1}))")
def shorts_in(owner: Address, at: int) -> Shorts:
    """The ints that a structure itself holds there."""
    raise NotImplementedError


@c_text("((int64_t *)({0} + {1}))")
def wholes_in(owner: Address, at: int) -> Index:
    """The sizes that a structure itself holds there."""
    raise NotImplementedError


@external
def mj_rne(m: Address, d: Address, with_acceleration: int, result: Vector) -> None:
    """Inverse dynamics."""


@external
def mj_mulM(m: Address, d: Address, result: Vector, given: Vector) -> None:
    """Product with the mass matrix."""


@external
def mj_factorM(m: Address, d: Address) -> None:
    """Factors of the mass matrix."""


@external
def mj_projectConstraint(m: Address, d: Address) -> None:
    """The inverse inertia that constraints feel."""


@external
def mj_markStack(d: Address) -> None:
    """Remember how much of the data's stack is taken."""


@external
def mj_freeStack(d: Address) -> None:
    """Give back what was taken since."""


@external
def mj_stackAllocNum(d: Address, n: Size) -> Vector:
    """Room for doubles on the data's own stack: no allocation, each thread's data has its own."""
    raise NotImplementedError


def bind_mujoco(*functions: External[..., Any]) -> None:
    """Tell compiled code where the loaded MuJoCo has these functions."""
    folder = os.path.dirname(mujoco.__file__)
    names = sorted(os.listdir(folder))
    file = next(f for f in names if "libmujoco" in f or f == "mujoco.dll")
    library = ctypes.CDLL(os.path.join(folder, file))
    for function in functions:
        found = ctypes.cast(getattr(library, function.name), ctypes.c_void_p).value
        function.bind(found or 0)
