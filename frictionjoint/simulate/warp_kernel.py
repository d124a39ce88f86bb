"""The kernel that evaluates friction in every world at once: a thread a joint and world.

It does what the native callback does (`frictionjoint.simulate.native`), with functions made from
the same source, on rows of state that live in a warp array instead of ``mjData.userdata``. The law
is computed in doubles; mujoco_warp hands it position, velocity, inertia and time as single floats.

Time and position need care. A float clock that counts milliseconds is off by several percent of a
step after some minutes, and the law divides by the step. A float position of a radian is off by
6e-8 rad, and presliding stiffness turns that into a torque that keeps a joint at rest trembling. So
each row keeps both in doubles. `CLOCK` advances by whole steps wherever the float clock agrees with
whole steps to its own rounding. `PLACE` advances by velocity times step, as the integrators do
before they round, wherever the position shown agrees with that to its own rounding. Left to itself
it would leave the position shown, and what friction holds would drift: forward in steps too
small to show, back in larger ones. So while the position shown moves, `PLACE` is pulled to it.
"""

# The annotations of kernels are warp's types, not Python's:
# mypy: ignore-errors

import functools
from typing import Any

from frictionjoint.arrays import ROUNDING
from frictionjoint.effects.signals import N_SIGNALS
from frictionjoint.simulate.block import DOF, EFFECTS, HEAD, JOINT, QPOS
from frictionjoint.simulate.joint_effects import coupled_load, effects_torque, unit_gravity
from frictionjoint.simulate.row import (
    ASTRAY,
    BASE,
    GAIN,
    STEP,
    T_EVALUATED,
    TORQUE,
    WRITTEN,
    over_the_step,
    torque_now,
)
from frictionjoint.translate.warp import translate

# a row of state: time and position as mujoco_warp showed them last, the same as we count them, and
# the row of `simulate.row`
TIME_SHOWN, CLOCK, PLACE_SHOWN, PLACE, FRONT = range(5)


@functools.lru_cache(maxsize=8)
def build(with_effects: bool, motor: Any, header: int) -> tuple[tuple[Any, Any, Any, Any], Any]:
    """The kernels that take friction out of M, evaluate it, read its torque, and reset it; and the
    structure of a model's motors.

    Args:
        with_effects: whether any joint carries effects.
        header: numbers of the longest header of a law.
        motor: warp's type of an actuator's gains and biases.
    """
    import warp as wp

    functions = [torque_now, over_the_step]
    if with_effects:
        functions += [effects_torque, unit_gravity, coupled_load]
    room = max(header, N_SIGNALS) if with_effects else header
    made = translate(functions, room, f"frictionjoint_warp_{int(with_effects)}_{room}")
    joint_torque = made["simulate_row_torque_now"]
    implicit_torque = made["simulate_row_over_the_step"]
    effect_torque = made.get("simulate_joint_effects_effects_torque")
    gravity_arms = made.get("simulate_joint_effects_unit_gravity")
    load_of_others = made.get("simulate_joint_effects_coupled_load")
    double, floats, doubles = wp.float64, wp.array(dtype=float), wp.array2d(dtype=wp.float64)
    vectors, matrices = wp.array2d(dtype=wp.vec3), wp.array2d(dtype=wp.mat33)

    @wp.struct
    class Motors:
        """Actuators of joints that saturate: those of joint k are acting[first[k]:first[k + 1]]."""

        first: wp.array(dtype=int)
        acting: wp.array(dtype=int)
        clamps: bool
        ctrl: wp.array2d(dtype=float)
        limited: wp.array(dtype=bool)
        limits: wp.array2d(dtype=wp.vec2)
        gears: wp.array2d(dtype=wp.spatial_vector)
        gains: wp.array2d(dtype=motor)
        biases: wp.array2d(dtype=motor)

    @wp.func
    def follow(X: Any, x: Any, t: Any, q: Any, v: Any, h: Any):
        """Update the row's own time and position from the simulation's time and position."""
        step = t - X[x + TIME_SHOWN]
        way = q - X[x + PLACE_SHOWN]
        if step < double(0.0):
            X[x + FRONT + STEP] = double(0.0)
        if X[x + FRONT + STEP] == double(0.0):
            X[x + CLOCK] = t
            X[x + PLACE] = q
        else:
            steps = wp.rint(step / h)
            if steps > double(0.0) and wp.abs(step - steps * h) <= double(ROUNDING) * t:
                step = steps * h
            moved = q != X[x + PLACE_SHOWN]
            if steps == double(1.0) and wp.abs(way - h * v) <= double(ROUNDING) * wp.abs(q):
                way = h * v
            X[x + CLOCK] = X[x + CLOCK] + step
            X[x + PLACE] = X[x + PLACE] + way
            if moved:
                # by a hundredth of its distance from the position shown
                X[x + PLACE] = X[x + PLACE] + double(0.01) * (q - X[x + PLACE])
        X[x + TIME_SHOWN] = t
        X[x + PLACE_SHOWN] = q

    @wp.func
    def asked(motors: Motors, k: int, world: int, q: wp.float64, v: wp.float64):
        """Commanded torque of a joint's motors, see `motor.commanded_torque`."""
        total = double(0.0)
        for n in range(motors.first[k], motors.first[k + 1]):
            i = motors.acting[n]
            u = motors.ctrl[world, i]
            if motors.clamps and motors.limited[i]:
                limit = motors.limits[world % motors.limits.shape[0], i]
                u = wp.clamp(u, limit[0], limit[1])
            if u != u:
                u = float(0.0)  # noqa: UP018 - a constant could not change for warp
            gear = double(motors.gears[world % motors.gears.shape[0], i][0])
            bias = motors.biases[world % motors.biases.shape[0], i]
            gain = motors.gains[world % motors.gains.shape[0], i][0]
            force = double(gain) * double(u) + double(bias[0])
            force = force + gear * (double(bias[1]) * q + double(bias[2]) * v)
            total = total + gear * force
        return total

    @wp.func
    def row_of(
        numbers: doubles, blocks: wp.array(dtype=int), rows: wp.array(dtype=int), k: int, world: int
    ):
        """Index of a joint's row of `simulate.row`, and of its degree of freedom."""
        return rows[k] + FRONT, int(numbers[world % numbers.shape[0], blocks[k] + DOF])

    @wp.kernel(enable_backward=False, module="unique")
    def take_back(
        numbers: doubles,
        blocks: wp.array(dtype=int),
        rows: wp.array(dtype=int),
        rowadr: wp.array(dtype=int),
        rownnz: wp.array(dtype=int),
        state: doubles,
        mass: wp.array2d(dtype=float),
    ):
        """Take friction out of the mass matrix, see `simulate.row`."""
        k, world = wp.tid()
        x, dof = row_of(numbers, blocks, rows, k, world)
        entry = rowadr[dof] + rownnz[dof] - 1
        if double(mass[world, entry]) == state[world, x + WRITTEN]:
            mass[world, entry] = float(state[world, x + BASE])
        state[world, x + BASE] = double(mass[world, entry])

    @wp.kernel(enable_backward=False, module="unique")
    def friction(
        numbers: doubles,
        blocks: wp.array(dtype=int),
        rows: wp.array(dtype=int),
        loads: wp.array(dtype=int),
        timestep: floats,
        weight: wp.array2d(dtype=float),
        locked: wp.array(dtype=float),
        rowadr: wp.array(dtype=int),
        rownnz: wp.array(dtype=int),
        armature: wp.array2d(dtype=float),
        bodyid: wp.array(dtype=int),
        axis: vectors,
        gravity: wp.array(dtype=wp.vec3),
        time: floats,
        qpos: wp.array2d(dtype=float),
        qvel: wp.array2d(dtype=float),
        bias: wp.array2d(dtype=float),
        pushed: wp.array2d(dtype=float),
        moved: wp.array2d(dtype=float),
        qacc: wp.array2d(dtype=float),
        constraint: wp.array2d(dtype=float),
        world_axis: vectors,
        xmat: matrices,
        motors: Motors,
        state: doubles,
        mass: wp.array2d(dtype=float),
        of_effects: wp.array2d(dtype=float),
        passive: wp.array2d(dtype=float),
    ):
        k, world = wp.tid()
        P = numbers[world % numbers.shape[0]]
        X = state[world]
        block = blocks[k]
        x = rows[k]
        dof = int(P[block + DOF])
        h = double(timestep[world % timestep.shape[0]])
        q = double(qpos[world, int(P[block + QPOS])])
        v = double(qvel[world, dof])
        place = q
        # a state gone astray would spoil the clock and the place for ever
        if wp.abs(q) <= double(ASTRAY) and wp.abs(v) <= double(ASTRAY):
            follow(X, x, double(time[world]), q, v, h)
            place = X[x + PLACE]
        t = X[x + CLOCK]
        J = X[x + FRONT + BASE]
        law = block + HEAD
        effects = block + int(P[block + EFFECTS])
        later = X[x + FRONT + T_EVALUATED] != t
        F = joint_torque(P, law, effects, X, x + FRONT, t, place, v, h)
        if F == F:
            inverse = double(weight[world % weight.shape[0], dof]) * double(locked[dof]) / J
            F = implicit_torque(P, law, X, x + FRONT, h, v, J, inverse)
        others_torque = double(0.0)
        if wp.static(with_effects):  # noqa: SIM102 - one test is for the compiler
            if P[effects] > double(0.0):
                joint = int(P[block + JOINT])
                a = axis[world % axis.shape[0], joint]
                turned = world_axis[world, joint]
                g = gravity[world % gravity.shape[0]]
                M = xmat[world, bodyid[joint]]
                R = wp.zeros(shape=9, dtype=wp.float64)
                for i in range(9):
                    R[i] = double(M[i // 3, i % 3])
                gx, gy = gravity_arms(wp.vec3d(a), wp.vec3d(turned), 0, wp.vec3d(g), R, 0)
                b = double(bias[world, dof]) - double(pushed[world, dof])
                if loads[k] >= 0:
                    others = double(moved[world, dof]) - J * double(qacc[world, dof])
                    others = others - double(constraint[world, dof])
                    if others != others:
                        others = double(0.0)  # left by a state gone astray that was set right
                    b = b + load_of_others(P, law, X, x + FRONT, loads[k], later, others)
                rotor = double(armature[world % armature.shape[0], dof])
                wanted = asked(motors, k, world, q, v)
                others_torque = effect_torque(
                    P, law, effects, X, x + FRONT, t, q, v, b, J - rotor, rotor, gx, gy, wanted
                )
                if F == F:
                    F = X[x + FRONT + TORQUE] + X[x + FRONT + GAIN] * v
        if F == F:
            entry = rowadr[dof] + rownnz[dof] - 1
            mass[world, entry] = float(J + h * X[x + FRONT + GAIN])
            X[x + FRONT + WRITTEN] = double(mass[world, entry])
        of_effects[world, k] = float(others_torque)
        passive[world, dof] = passive[world, dof] - float(F + others_torque)

    @wp.kernel(enable_backward=False, module="unique")
    def acted(
        numbers: doubles,
        blocks: wp.array(dtype=int),
        rows: wp.array(dtype=int),
        timestep: floats,
        time: floats,
        qvel: wp.array2d(dtype=float),
        qacc: wp.array2d(dtype=float),
        of_effects: wp.array2d(dtype=float),
        state: doubles,
        torque: wp.array2d(dtype=float),
    ):
        """c + G w and the torque of effects, with w the velocity at the end of the step."""
        k, world = wp.tid()
        x, dof = row_of(numbers, blocks, rows, k, world)
        w = double(qvel[world, dof])
        if double(time[world]) == state[world, rows[k] + TIME_SHOWN]:
            # evaluated, and the step is still to come
            a = double(qacc[world, dof])
            if a == a:  # not left by a state gone astray that was set right
                w = w + double(timestep[world % timestep.shape[0]]) * a
        law = state[world, x + TORQUE] + state[world, x + GAIN] * w
        torque[world, k] = float(law) + of_effects[world, k]

    @wp.kernel(enable_backward=False, module="unique")
    def reset(mask: wp.array(dtype=wp.bool), rows: wp.array(dtype=int), state: doubles):
        k, world = wp.tid()
        if mask[world]:
            state[world, rows[k] + FRONT + STEP] = double(0.0)

    return (take_back, friction, acted, reset), Motors
