"""The kernel that lets the stiff joints of each tree hold their loads together, in every world.

Most trees of most worlds have none at a time: that is all that it reads of them.

It does what the native callback does after all joints have their explicit torque
(`frictionjoint.simulate.together`), with the function made from the same source. The inverse of the
mass matrix between the stiff joints comes from a factorization of its own: mujoco_warp makes that
of this step only after the passive forces. A thread has a kinematic tree of a world, beyond which
the mass matrix couples nothing.
"""

# The annotations of kernels are warp's types, not Python's:
# mypy: ignore-errors

import functools
from typing import Any

from frictionjoint.simulate.carrier import DOF, HEAD, ROW
from frictionjoint.simulate.together import is_stiff, settle
from frictionjoint.simulate.warp_source import translate


@functools.lru_cache(maxsize=1)
def build() -> Any:
    """The kernel that ends an evaluation: as `warp_kernel` does for all others, it writes the
    torques of stiff joints and adds them to the passive forces."""
    import warp as wp

    made = translate([is_stiff, settle], 1, "frictionjoint_warp_stiff")
    stiff_now, settled = made["simulate_together_is_stiff"], made["simulate_together_settle"]
    double, floats, doubles = wp.float64, wp.array(dtype=float), wp.array2d(dtype=wp.float64)
    whole = wp.array(dtype=int)

    @wp.func
    def factor(
        world: int, begin: int, end: int, rowadr: whole, rownnz: whole, colind: whole, L: doubles
    ):
        """M = L' D L of a tree's rows in place, from its leaves; D is the diagonal.

        A row's columns are the ancestors of its degree of freedom, whose own rows begin alike.
        """
        for back in range(end - begin):
            dof = end - 1 - back
            a, n = rowadr[dof], rownnz[dof]
            D = L[world, a + n - 1]
            for b in range(n - 1):
                at = n - 2 - b
                scale = L[world, a + at] / D
                above = colind[a + at]
                for c in range(rownnz[above]):
                    i = rowadr[above] + c
                    L[world, i] = L[world, i] - scale * L[world, a + c]
            for c in range(n - 1):
                L[world, a + c] = L[world, a + c] / D

    @wp.func
    def solve(
        world: int,
        begin: int,
        end: int,
        rowadr: whole,
        rownnz: whole,
        colind: whole,
        L: doubles,
        x: doubles,
    ):
        """x of a tree becomes the solution of L' D L y = x."""
        for back in range(end - begin):
            dof = end - 1 - back
            for c in range(rownnz[dof] - 1):
                i = rowadr[dof] + c
                above = colind[i]
                x[world, above] = x[world, above] - L[world, i] * x[world, dof]
        for dof in range(begin, end):
            last = rowadr[dof] + rownnz[dof] - 1
            x[world, dof] = x[world, dof] / L[world, last]
        for dof in range(begin, end):
            for c in range(rownnz[dof] - 1):
                i = rowadr[dof] + c
                x[world, dof] = x[world, dof] - L[world, i] * x[world, colind[i]]

    @wp.kernel(enable_backward=False, module="unique")
    def hold(
        numbers: doubles,
        blocks: whole,
        tree_first: whole,
        members: whole,
        tree_dof: wp.array2d(dtype=int),
        timestep: floats,
        weight: wp.array2d(dtype=float),
        rowadr: whole,
        rownnz: whole,
        colind: whole,
        mass: wp.array2d(dtype=float),
        state: doubles,
        total: doubles,
        stiff: wp.array2d(dtype=int),
        held: doubles,
        L: doubles,
        x: doubles,
        inverse: doubles,
        room: doubles,
        torque: wp.array2d(dtype=float),
        passive: wp.array2d(dtype=float),
    ):
        tree, world = wp.tid()
        if stiff[tree, world] == 0:
            return
        stiff[tree, world] = 0
        P = numbers[world % numbers.shape[0]]
        X = state[world]
        h = double(timestep[world % timestep.shape[0]])
        place = tree * state.shape[0] + world
        B, W, Y = held[place], inverse[place], room[place]
        first, last = tree_first[tree], tree_first[tree + 1]
        # a constant that changes in a loop has to be made a variable for warp
        k = int(0)  # noqa: RUF046, UP018
        astray = bool(False)  # noqa: UP018
        for i in range(first, last):
            j = members[i]
            block = blocks[j]
            w = double(weight[world % weight.shape[0], int(P[block + DOF])])
            if total[world, j] != total[world, j]:
                astray = bool(True)  # noqa: UP018
            if stiff_now(P, block + HEAD, X, int(P[block + ROW]), h, w):
                B[k] = double(block)
                k = k + 1
        if not astray:
            begin, end = tree_dof[tree, 0], tree_dof[tree, 1]
            for i in range(rowadr[begin], rowadr[end - 1] + rownnz[end - 1]):
                L[world, i] = double(mass[world, i])
            factor(world, begin, end, rowadr, rownnz, colind, L)
            for i in range(k):
                for dof in range(begin, end):
                    x[world, dof] = double(0.0)
                x[world, int(P[int(B[i]) + DOF])] = double(1.0)
                solve(world, begin, end, rowadr, rownnz, colind, L, x)
                for j in range(k):
                    W[j * k + i] = x[world, int(P[int(B[j]) + DOF])]
            settled(P, B, k, X, h, W, Y)
        n = int(0)  # noqa: RUF046, UP018
        for i in range(first, last):
            j = members[i]
            if n < k:  # noqa: SIM102 - warp's `and` would read B[k]
                if int(B[n]) == blocks[j]:
                    F = total[world, j]
                    if not astray:
                        F = F + Y[n]
                    n = n + 1
                    dof = int(P[blocks[j] + DOF])
                    torque[world, j] = float(F)
                    passive[world, dof] = passive[world, dof] - float(F)

    return hold
