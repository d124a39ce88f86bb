"""Source of the kernels that evaluate each law along a motion with its tangents."""

from frictionjoint.law.names import LAWS

_HEAD = """
from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled
from frictionjoint.law import bristle, memory
from frictionjoint.law.kernel import start_row
from frictionjoint.law.tangents.direction import ZERO, Tangent, Tangents, put
"""
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
_DRIVE_INTEGRATED = _DRIVE.format(
    law="integrated",
    header="memory",
    start="integrated_start(P, P_t, 1, X, X_t, 0, memory.HEADER)",
    step="integrated_step(P, P_t, 1, X, X_t, 0, 0, memory.HEADER, dq, dt, dq / dt)\n"
    "            memory_make_room(X, X_t, 0, memory.HEADER)",
)


def drives() -> str:
    """Python text of ``drive_<law>`` for each law, without the steps that these kernels call."""
    rivals = [
        _DRIVE.format(
            law=law,
            header="bristle",
            start="start_row(P, 0, X, 0)",
            step=f"{law}_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)",
        )
        for law in LAWS[1:]
    ]
    return "\n".join([_HEAD, _DRIVE_INTEGRATED, *rivals])
