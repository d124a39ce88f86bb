"""The laws' steps with their tangents.

A law is written once, as a scalar kernel. Its source is differentiated here, statement by
statement and in forward mode (`frictionjoint.law.tangents.differentiate`).
"""

import math
from types import ModuleType
from typing import Any

from frictionjoint.compiled import compiled, define, in_line
from frictionjoint.errors import ModelError
from frictionjoint.law import integrated, kernel, memory
from frictionjoint.law.tangents import direction, rules
from frictionjoint.law.tangents.differentiate import Differentiated, name_of

_ROOTS = (integrated.start, integrated.step, memory.make_room, kernel.step_rival)
_ADDED = {"math": math, "compiled": compiled, "in_line": in_line, "rules": rules} | {
    name: vars(direction)[name] for name in ("ZERO", "Tangent", "at", "put", "scaled", "sum2")
}


def _define_steps(made: ModuleType) -> None:
    """Define every law's step, and all kernels that the steps call, with tangents in a module.

    Raises:
        ModelError: a law contains a construct that cannot be differentiated.
    """
    ways: dict[Any, tuple[frozenset[str], bool]] = {}

    def add(kernel: Any, moving: frozenset[str], wanted: bool) -> None:
        if kernel in ways:
            if ways[kernel] != (moving, wanted):
                raise ModelError(f"{kernel.py_func.__name__} is called in two ways")
            return
        ways[kernel] = moving, wanted
        new = Differentiated(kernel, moving, wanted)
        for callee in new.calls:
            add(*callee)
        # the names that the kernel's own source uses, and those that differentiation adds
        space = vars(new.owner) | vars(made) | _ADDED
        define(new.source, f"{made.__name__}.{name_of(kernel)}", space)
        setattr(made, name_of(kernel), space[name_of(kernel)])

    for root in _ROOTS:
        add(root, frozenset(), False)


steps: Any = ModuleType("frictionjoint.law.tangents.steps")
"""The generated functions."""
_define_steps(steps)
