"""The kernel that evaluates friction in every world at once: a thread a joint and world.

It does what the native callback does (`frictionjoint.simulate.callback`), with functions made from
the same source, on rows of state that live in a warp array instead of ``mjData.userdata``. The law
is computed in doubles; mujoco_warp hands it position, velocity, inertia and time as single floats.

Time needs care: a float clock that counts milliseconds is off by several percent of a step after
some minutes, and the law divides by the step. So each row keeps a clock in doubles, `CLOCK`, that
advances by whole steps wherever the float clock agrees with whole steps to its own rounding.
"""

# The annotations of kernels are warp's types, not Python's:
# mypy: ignore-errors

import functools
from typing import Any

from frictionjoint.effects.signals import N_SIGNALS
from frictionjoint.simulate.callback import effects_torque, unit_gravity
from frictionjoint.simulate.carrier import DOF, EFFECTS, HEAD, JOINT, QPOS
from frictionjoint.simulate.row import STARTED, evaluate
from frictionjoint.simulate.warp_source import translate

# a row of state: the time mujoco_warp showed last, our clock then, and the row of `simulate.row`
SHOWN, CLOCK, FRONT = range(3)
# of two times in single precision, relative
ROUNDING = 2.0**-22


@functools.lru_cache(maxsize=8)
def build(room: int, with_effects: bool) -> tuple[Any, Any]:
    """The kernels of friction and of the reset.

    Args:
        room: numbers in the longest row of state.
        with_effects: whether any joint carries effects.
    """
    import warp as wp

    room = max(room, N_SIGNALS)
    made = translate(
        [evaluate, effects_torque, unit_gravity] if with_effects else [evaluate],
        room,
        f"frictionjoint_warp_{room}_{int(with_effects)}",
    )
    joint_torque = made["simulate_row_evaluate"]
    effect_torque = made.get("simulate_callback_effects_torque")
    gravity_arms = made.get("simulate_callback_unit_gravity")
    double, floats, doubles = wp.float64, wp.array(dtype=float), wp.array2d(dtype=wp.float64)
    vectors, matrices = wp.array2d(dtype=wp.vec3), wp.array2d(dtype=wp.mat33)

    @wp.func
    def clock(X: Any, x: Any, shown: Any, h: Any):
        """Our clock at the time shown; writes it down."""
        last = X[x + SHOWN]
        now = shown
        if shown < last:
            X[x + FRONT + STARTED] = double(0.0)
        elif X[x + FRONT + STARTED] != double(0.0):
            step = shown - last
            steps = wp.rint(step / h)
            if steps > double(0.0) and wp.abs(step - steps * h) <= double(ROUNDING) * shown:
                step = steps * h
            now = X[x + CLOCK] + step
        X[x + SHOWN] = shown
        X[x + CLOCK] = now
        return now

    @wp.kernel(enable_backward=False, module="unique")
    def friction(
        numbers: doubles,
        blocks: wp.array(dtype=int),
        rows: wp.array(dtype=int),
        timestep: floats,
        rowadr: wp.array(dtype=int),
        rownnz: wp.array(dtype=int),
        bodyid: wp.array(dtype=int),
        axis: vectors,
        gravity: wp.array(dtype=wp.vec3),
        time: floats,
        qpos: wp.array2d(dtype=float),
        qvel: wp.array2d(dtype=float),
        mass: wp.array2d(dtype=float),
        bias: wp.array2d(dtype=float),
        world_axis: vectors,
        xmat: matrices,
        state: doubles,
        torque: wp.array2d(dtype=float),
        passive: wp.array2d(dtype=float),
    ):
        world, k = wp.tid()
        P = numbers[world % numbers.shape[0]]
        X = state[world]
        block = blocks[k]
        x = rows[k]
        dof = int(P[block + DOF])
        h = double(timestep[world % timestep.shape[0]])
        t = clock(X, x, double(time[world]), h)
        q = double(qpos[world, int(P[block + QPOS])])
        v = double(qvel[world, dof])
        J = double(mass[world, rowadr[dof] + rownnz[dof] - 1])
        law = block + HEAD
        effects = block + int(P[block + EFFECTS])
        F = joint_torque(P, law, effects, X, x + FRONT, t, q, v, h, J)
        if wp.static(with_effects):  # noqa: SIM102 - one test is for the compiler
            if P[effects] > double(0.0):
                joint = int(P[block + JOINT])
                a = axis[world % axis.shape[0], joint]
                w = world_axis[world, joint]
                g = gravity[world % gravity.shape[0]]
                M = xmat[world, bodyid[joint]]
                R = wp.zeros(shape=9, dtype=wp.float64)
                for i in range(9):
                    R[i] = double(M[i // 3, i % 3])
                gx, gy = gravity_arms(
                    double(a[0]),
                    double(a[1]),
                    double(a[2]),
                    double(w[0]),
                    double(w[1]),
                    double(w[2]),
                    double(g[0]),
                    double(g[1]),
                    double(g[2]),
                    R,
                    0,
                )
                b = double(bias[world, dof])
                F = F + effect_torque(P, law, effects, X, x + FRONT, t, q, v, F, b, J, gx, gy)
        torque[world, k] = float(F)
        passive[world, dof] = passive[world, dof] - float(F)

    @wp.kernel(enable_backward=False, module="unique")
    def reset(mask: wp.array(dtype=wp.bool), rows: wp.array(dtype=int), state: doubles):
        world, k = wp.tid()
        if mask[world]:
            state[world, rows[k] + FRONT + STARTED] = double(0.0)

    return friction, reset
