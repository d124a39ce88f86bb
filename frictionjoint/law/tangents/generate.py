"""The laws' steps with their tangents.

A law is written once, as a scalar kernel. Its source is differentiated here, statement by
statement and in forward mode (`frictionjoint.law.tangents.differentiate`).
"""

import types
from importlib import import_module
from typing import Any

from frictionjoint.compiled import define
from frictionjoint.errors import ModelError
from frictionjoint.law import integrated, memory
from frictionjoint.law.names import LAWS
from frictionjoint.law.tangents.differentiate import Differentiated

_RIVAL_STEPS = [import_module(f"frictionjoint.law.{law}").step for law in LAWS[1:]]
_ROOTS = (integrated.start, integrated.step, memory.make_room, *_RIVAL_STEPS)


def source() -> str:
    """Python text of every law's step, and of all kernels that the steps call, with tangents.

    Raises:
        ModelError: a law contains a construct that cannot be differentiated.
    """
    done: dict[Any, Differentiated] = {}
    ways: dict[Any, tuple[frozenset[str], bool]] = {}

    def add(kernel: Any, moving: frozenset[str], wanted: bool) -> None:
        if ways.setdefault(kernel, (moving, wanted)) != (moving, wanted):
            raise ModelError(f"{kernel.py_func.__name__} is called in two ways")
        if kernel not in done:
            made = Differentiated(kernel, moving, wanted)
            for callee in made.calls:
                add(*callee)
            done[kernel] = made

    for kernel in _ROOTS:
        add(kernel, frozenset(), False)
    modules = sorted(set().union(*(x.modules for x in done.values())))
    functions = [made.source for made in done.values()]
    return _HEAD.format(modules=", ".join(modules)) + "\n\n".join(functions) + "\n"


_HEAD = """
import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import {modules}
from frictionjoint.law.tangents import rules
from frictionjoint.law.tangents.direction import ZERO, Tangent, Tangents, at, put, scaled, sum2

"""
steps: Any = types.ModuleType("frictionjoint.law.tangents.steps")
"""The generated functions."""
define(source(), steps.__name__, vars(steps))
