"""Source of the laws' steps with their tangents.

A law is written once, as a scalar kernel. Its source is differentiated here, statement by
statement and in forward mode (`frictionjoint.law.tangents.differentiate`).
"""

from typing import Any

from frictionjoint.errors import ModelError
from frictionjoint.law import (
    armstrong,
    dahl,
    dahl_stribeck,
    elastoplastic,
    integrated,
    lugre,
    maxwell_slip,
    memory,
    relaxation,
    static,
    stribeck,
)
from frictionjoint.law.tangents import rules
from frictionjoint.law.tangents.activity import Particulars
from frictionjoint.law.tangents.differentiate import Differentiated

_RIVALS = (static, armstrong, dahl, dahl_stribeck, lugre, elastoplastic, maxwell_slip)
_ROOTS = (integrated.start, integrated.step, memory.make_room, *(law.step for law in _RIVALS))
_COUNTS = (
    *("DIRECTION", "N_MIN", "N_MAX", "VIRGIN", "FORGOTTEN", "BOUND"),
    *("LAMPAERT", "MASING", "SLIDING", "N_ELEMENTS"),
)
_PARTICULARS = Particulars(
    rules={
        stribeck.stribeck_level: rules.stribeck_level,
        relaxation.advance: rules.advance,
        relaxation.distance: rules.distance,
        relaxation.rate: rules.rate,
        dahl.remaining: rules.remaining,
    },
    counts=(*(frozenset({name}) for name in _COUNTS), frozenset({"HEADER", "n"})),
    # the exponent is a fixed choice in the integrated law and a fitted number in Dahl's law
    counts_of={integrated: (frozenset({"EXPONENT"}),)},
    # At the fixed point r = 1 the torque stays constant, but its tangent still changes.
    left_out=frozenset({"if r == 1.0:\n    break"}),
    rounded={
        integrated._slide: {"max(0.0, reach)": "reach"},
        elastoplastic._transition: {
            "1.0": "1.0 - math.exp(-(u + a))",
            "-math.expm1(-u)": "1.0 - math.exp(-u)",
        },
    },
    harmless=frozenset({"d == a", "dq != 0.0", "dq == 0.0", "v == 0.0"}),
)


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
            made = Differentiated(kernel, moving, wanted, _PARTICULARS)
            for callee in made.calls:
                add(*callee)
            done[kernel] = made

    for kernel in _ROOTS:
        add(kernel, frozenset(), False)
    modules = sorted(set().union(*(x.activity.modules for x in done.values())))
    functions = [made.source for made in done.values()]
    return _HEAD.format(modules=", ".join(modules)) + "\n\n".join(functions) + "\n"


_HEAD = """
import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import {modules}
from frictionjoint.law.tangents import rules
from frictionjoint.law.tangents.direction import (
    ZERO, Tangent, Tangents, at, put, scaled, sum2, sum3, sum4
)

"""
