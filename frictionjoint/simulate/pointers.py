"""MuJoCo's structures and functions for compiled code.

A structure is an address, and a field is at a byte offset from it (``simulate.layout``).
"""

import ctypes
import os
from collections.abc import Sequence
from typing import Any

import mujoco

from frictionjoint.arrays import Index, Vector
from frictionjoint.compiled import External, Table, c_text, external
from frictionjoint.simulate.layout import DATA_NAMES, MODEL_NAMES

Address = int
Size = int
"""C's size_t; an ``int`` of a function from elsewhere is C's int."""
Shorts = Index
Flags = Index
"""int32 and uint8 arrays of MuJoCo's."""


def _places(struct: str, names: Sequence[str], first: int) -> Any:
    """Where the offset of each field of a structure is in `AT`, by the field's name."""
    return type(struct, (), {name: first + i for i, name in enumerate(names)})


MODEL = _places("mjModel", MODEL_NAMES, 0)
DATA = _places("mjData", DATA_NAMES, len(MODEL_NAMES))
AT = Table("offsets", len(MODEL_NAMES) + len(DATA_NAMES))
"""Bytes from the beginning of mjModel and mjData; 0 for a field that this MuJoCo lacks."""


@c_text("(*(double **)({0} + {1}))")
def reals(owner: Address, at: int) -> Vector:
    """The array of doubles whose address is at byte `at` of a structure."""
    raise NotImplementedError


@c_text("(*(int32_t **)({0} + {1}))")
def shorts(owner: Address, at: int) -> Shorts:
    """The array of ints whose address is at byte `at` of a structure."""
    raise NotImplementedError


@c_text("(*(uint8_t **)({0} + {1}))")
def flags(owner: Address, at: int) -> Flags:
    """The array of bytes whose address is at byte `at` of a structure."""
    raise NotImplementedError


@c_text("((double *)({0} + {1}))")
def reals_in(owner: Address, at: int) -> Vector:
    """The doubles inside a structure at that offset."""
    raise NotImplementedError


@c_text("((int32_t *)({0} + {1}))")
def shorts_in(owner: Address, at: int) -> Shorts:
    """The ints inside a structure at that offset."""
    raise NotImplementedError


@c_text("((int64_t *)({0} + {1}))")
def wholes_in(owner: Address, at: int) -> Index:
    """The sizes inside a structure at that offset."""
    raise NotImplementedError


@external
def mj_rne(m: Address, d: Address, with_acceleration: int, result: Vector) -> None:
    """Inverse dynamics."""


@external
def mj_mulM(m: Address, d: Address, result: Vector, given: Vector) -> None:
    """Product with the mass matrix."""


@external
def mj_applyFT(
    m: Address, d: Address, force: Vector, torque: Vector, point: Vector, body: int, result: Vector
) -> None:
    """Add the joint torques of a force and a torque on a body."""


@external
def mj_factorM(m: Address, d: Address) -> None:
    """Factors of the mass matrix."""


@external
def mj_projectConstraint(m: Address, d: Address) -> None:
    """Inverse inertia in constraint space."""


@external
def mj_markStack(d: Address) -> None:
    """Mark the present top of the data's stack."""


@external
def mj_freeStack(d: Address) -> None:
    """Free everything allocated since the mark."""


@external
def mj_stackAllocNum(d: Address, n: Size) -> Vector:
    """Room for doubles on the data's own stack: no allocation, each thread's data has its own."""
    raise NotImplementedError


def bind_mujoco() -> None:
    """Pass the addresses of the functions above in the loaded MuJoCo library to compiled code."""
    folder = os.path.dirname(mujoco.__file__)
    names = sorted(os.listdir(folder))
    file = next(f for f in names if "libmujoco" in f or f == "mujoco.dll")
    library = ctypes.CDLL(os.path.join(folder, file))
    for function in [x for x in globals().values() if isinstance(x, External)]:
        function.bind(getattr(library, function.name))
