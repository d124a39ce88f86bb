"""A joint's state in ``mjData.userdata`` and the rule that commits it.

MuJoCo calls the passive callback as often as it likes: once a step, four times with RK4, again in
mj_forward and in finite differences. So a row keeps the last committed point and the last
evaluated one:

* a call at a later time commits the evaluated point, then evaluates;
* a call at the same time evaluates again from the committed point;
* a call at an earlier time, one that comes more than `LEAP` time steps later, or an all-zero row,
  starts afresh: at rest and never moved.

No step is longer than ``opt.timestep``, so a gap of several steps is a state set by the user, not
motion: for example ``mujoco.rollout`` from states of increasing time, whose user data is not part
of mjSTATE_FULLPHYSICS. The step is the model's, or that of the last evaluation where it was longer,
so that the time step may change during a run.

Over a step friction is TORQUE + GAIN w, with w the velocity at its end. That is MuJoCo's own step
with the passive force -(TORQUE + GAIN v) and h GAIN more on the joint's diagonal entry of
``mjData.M``. MuJoCo makes M anew in each position stage, and the callback may run several times on
one. So an entry that still has the value with friction (WRITTEN) first becomes the base again.

Row ``X[x:]``: STEP, the time step of the last evaluation (0 before the first); time, position,
velocity, torque over the step without its GAIN, and GAIN, all five committed, then evaluated; the
joint's entry of the mass matrix (BASE) and what stands in its place (WRITTEN); then the law's row,
then the effects' memory, committed and evaluated, then the evaluated torque of each effect.
"""

import mujoco
import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.effects.kernel import MEMORY
from frictionjoint.law.kernel import commit, fit_row, hold_row, hysteresis_torque, start_row
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.law.secant import implicit_step

STEP, T_COMMITTED, Q_COMMITTED, V_COMMITTED, TORQUE_COMMITTED, GAIN_COMMITTED = range(6)
T_EVALUATED, Q_EVALUATED, V_EVALUATED, TORQUE, GAIN, BASE, WRITTEN = range(6, 13)
# time steps
LEAP = 3.0
FRONT = WRITTEN + 1
# a state beyond it, or not a number, has gone astray, and MuJoCo resets it in a step
ASTRAY = float(mujoco.mjMAXVAL)


def row_size(law_row: int, n_effects: int) -> int:
    """Number of float64 in userdata for a joint with this many effects."""
    return FRONT + law_row + (2 * MEMORY + 1) * n_effects


@in_line
def commit_point(X: Vector, x: int) -> None:
    """Make time, position, velocity, torque and gain of the evaluated point the committed ones."""
    for i in range(T_EVALUATED - T_COMMITTED):
        X[x + T_COMMITTED + i] = X[x + T_EVALUATED + i]


@in_line
def commit_effects(P: Vector, p: int, effects: int, X: Vector, x: int) -> None:
    """Make the effects' evaluated memory the committed one."""
    n = MEMORY * int(P[effects])
    if n > 0:
        memory = x + FRONT + law_row_size(P, p)
        for i in range(n):
            X[memory + i] = X[memory + n + i]


@in_line
def torque_now(
    P: Vector, p: int, effects: int, X: Vector, x: int, t: float, q: float, v: float, step: float
) -> float:
    """The law's torque at (t, q, v), N m, by the rule above; P[effects] begins the effects.

    A diverged state has no torque: NaN. `step` is the model's time step, s; if it is infinite, no
    gap counts as a reset.
    """
    if not (abs(q) <= ASTRAY and abs(v) <= ASTRAY):
        # the law's search for events would not end; what is remembered stays as it is
        return np.nan
    law = x + FRONT
    gap = t - X[x + T_EVALUATED]
    if X[x + STEP] == 0.0 or gap < 0.0 or gap > LEAP * max(step, X[x + STEP]):
        X[x + T_COMMITTED] = t
        X[x + Q_COMMITTED] = q
        X[x + V_COMMITTED] = v
        X[x + TORQUE_COMMITTED] = 0.0
        X[x + GAIN_COMMITTED] = 0.0
        start_row(P, p, X, law)
        memory = law + law_row_size(P, p)
        for i in range(2 * MEMORY * int(P[effects])):
            X[memory + i] = 0.0
    elif gap > 0.0:
        if X[x + T_EVALUATED] > X[x + T_COMMITTED]:
            commit(P, p, X, law)
        # also after a start, where each effect has set its own memory
        commit_effects(P, p, effects, X, x)
        commit_point(X, x)
    fit_row(P, p, X, law)
    dt = t - X[x + T_COMMITTED]
    if dt == 0.0:
        # still at the start: no motion has led here, wherever "here" is put
        X[x + Q_COMMITTED] = q
    F = hold_row(P, p, X, law, q - X[x + Q_COMMITTED], dt, v)
    X[x + STEP] = step
    X[x + T_EVALUATED] = t
    X[x + Q_EVALUATED] = q
    X[x + V_EVALUATED] = v
    X[x + TORQUE] = F
    X[x + GAIN] = 0.0
    return F


@in_line
def shared_out(
    constant: float,
    K: float,
    D: float,
    elastic: float,
    h: float,
    v: float,
    inertia: float,
    weight: float,
) -> tuple[float, float]:
    """TORQUE, N m, and GAIN, N m s/rad, of a step of h seconds.

    GAIN is the part of spring and damper that acts implicitly.

    Args:
        constant, K, D, elastic: see `law.secant.implicit_step`. inertia, weight: see
            `over_the_step`.
    """
    stiff = h * h * K * weight
    # half of a spring is implicit at h^2 K / J = 0.25: a soft one loses less energy explicitly, a
    # stiff one must be implicit. Half of what slips is: MuJoCo's velocities belong to the middle of
    # a step, its positions to the ends
    implicit = elastic * stiff / (stiff + 0.25) + (1.0 - elastic) * 0.5
    # half of a damper that is weak for the step acts at the velocity before it, so that its torque
    # is that of the step's middle; a strong one must be implicit, and then stops the joint
    explicit = 0.5 * inertia / (inertia + h * D) if D > 0.0 and inertia > 0.0 else 0.0
    return constant + explicit * D * v, implicit * h * K + (1.0 - explicit) * D


@in_line
def over_the_step(
    P: Vector, p: int, X: Vector, x: int, h: float, v: float, J: float, weight: float
) -> float:
    """Replace the torque of `torque_now` by that for the step of h seconds that begins now.

    The acceleration over the last step gives all other torque on the joint, which is assumed to
    stay constant. Only the row is used, because other values in MuJoCo differ between repeated
    evaluations.

    Args:
        J: the joint's entry of the mass matrix, kg m^2.
        weight: inverse of the joint's inertia with all other joints free.
    Returns:
        torque at velocity v, N m.
    """
    # what a joint that breaks away has to move, while the others give way
    inertia = min(J, 1.0 / weight) if weight > 0.0 else J
    dt = X[x + T_EVALUATED] - X[x + T_COMMITTED]
    impulse = inertia * v
    if dt > 0.0:
        others = inertia * (v - X[x + V_COMMITTED]) / dt
        others += X[x + TORQUE_COMMITTED] + X[x + GAIN_COMMITTED] * v
        impulse += h * (others - hysteresis_torque(P, p, X, x + FRONT))
    constant, K, D, elastic = implicit_step(P, p, X, x + FRONT, h, inertia, impulse)
    X[x + TORQUE], X[x + GAIN] = shared_out(constant, K, D, elastic, h, v, inertia, weight)
    return X[x + TORQUE] + X[x + GAIN] * v


@compiled
def rare_torque(
    P: Vector,
    p: int,
    effects: int,
    X: Vector,
    x: int,
    t: float,
    q: float,
    v: float,
    step: float,
    h: float,
    J: float,
    weight: float,
) -> float:
    """Friction torque for any step, N m; for the arguments see `torque_now` and
    `over_the_step`.

    The torque is explicit if h is 0. `step` is the model's time step, s.
    """
    F = torque_now(P, p, effects, X, x, t, q, v, step)
    if F == F and h > 0.0:
        return over_the_step(P, p, X, x, h, v, J, weight)
    return F
