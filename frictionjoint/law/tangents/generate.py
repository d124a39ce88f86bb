"""Write `frictionjoint.law.tangents.kernels`: the laws' kernels with their tangents.

    python -m frictionjoint.law.tangents.generate

A law is written once, as a scalar kernel. Its source is differentiated here, statement by
statement and in forward mode (`frictionjoint.law.tangents.differentiate`), and the result is a file
like any other, compiled with the other kernels.
"""

import subprocess
import sys
from pathlib import Path
from typing import Any

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
from frictionjoint.law.tangents.plain import UnknownError

FILE = Path(__file__).with_name("kernels.py")

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
    # the exponent of the integrated law is a choice, that of Dahl's a number
    counts_of={integrated: (frozenset({"EXPONENT"}),)},
    # At the fixed point r = 1 the torque stays; its tangent goes on as in any other step.
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

_DRIVE = """
@compiled
def drive_{law}(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        {start}
        H[first], rate[first] = 0.0, X[{header}.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            {step}
            H[k], rate[k] = X[{header}.FH], X[{header}.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[{header}.FH, i], X_t[{header}.RATE, i]
"""
_STEP = "{law}_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)"
_DRIVE_INTEGRATED = _DRIVE.format(
    law="integrated",
    header="memory",
    start="integrated_start(P, P_t, 1, X, X_t, 0, memory.HEADER)",
    step="integrated_step(P, P_t, 1, X, X_t, 0, 0, memory.HEADER, dq, dt, dq / dt)\n"
    "            memory_make_room(X, X_t, 0, memory.HEADER)",
)


def source() -> str:
    """The text of `frictionjoint.law.tangents.kernels`.

    Raises:
        UnknownError: a law holds a construct that cannot be differentiated.
    """
    done: dict[Any, Differentiated] = {}
    ways: dict[Any, tuple[frozenset[str], bool]] = {}

    def add(kernel: Any, moving: frozenset[str], wanted: bool) -> None:
        if ways.setdefault(kernel, (moving, wanted)) != (moving, wanted):
            raise UnknownError(f"{kernel.py_func.__name__} is called in two ways")
        if kernel not in done:
            made = Differentiated(kernel, moving, wanted, _PARTICULARS)
            for callee in made.calls:
                add(*callee)
            done[kernel] = made

    for kernel in _ROOTS:
        add(kernel, frozenset(), False)
    laws = [law.__name__.rpartition(".")[2] for law in _RIVALS]
    drives = [
        _DRIVE.format(
            law=law,
            header="bristle",
            start="start_rival(P, 0, X, 0)",
            step=_STEP.format(law=law),
        )
        for law in laws
    ]
    modules = sorted({"bristle", "memory"}.union(*(x.activity.modules for x in done.values())))
    functions = [*(made.source for made in done.values()), _DRIVE_INTEGRATED, *drives]
    return _HEAD.format(modules=", ".join(modules)) + "\n\n".join(functions) + "\n"


_HEAD = '''"""The laws' kernels with their tangents; written by ``generate``, see there."""

import math

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import {modules}
from frictionjoint.law.kernel import start_rival
from frictionjoint.law.tangents import rules
from frictionjoint.law.tangents.direction import (
    ZERO, Tangent, Tangents, at, put, scaled, sum2, sum3, sum4
)

'''

if __name__ == "__main__":
    FILE.write_text(source(), encoding="utf-8")
    subprocess.run([sys.executable, "-m", "ruff", "format", "--quiet", str(FILE)], check=True)
