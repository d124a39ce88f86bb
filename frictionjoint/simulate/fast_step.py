"""The usual step of a simulated joint: the integrated law in a step without events.

In most steps a joint follows one hysteresis curve, reverses, slides or rests. `usual_torque`
computes such a step faster: it combines `row.torque_now` and `row.over_the_step`, and reads and
writes each number of the row only once. These two functions compute every other step: other laws,
starts, jumps in time, changed parameters, loops that close, resets of the memory, knots of the
transition curve, full stacks.

A joint at rest is never perfectly still, because rounding errors move it back and forth. The law
would treat each of these movements as a reversal and fill its memory. So a displacement that barely
changes the torque is treated as elastic: the law keeps its state and its position until the
displacement has grown.
"""

import math

import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.compiled import in_line
from frictionjoint.law.integrated import (
    KNOTS,
    MASING,
    NEGATIVE,
    POSITIVE,
    SIGMA1,
    closing_torque,
    undisturbed,
)
from frictionjoint.law.kernel import INTEGRATED
from frictionjoint.law.memory import (
    BOUND,
    CAPACITY,
    DIRECTION,
    FB,
    FH,
    FORGOTTEN,
    HEADER,
    N_MAX,
    N_MIN,
    RATE,
    VIRGIN,
)
from frictionjoint.law.secant import REST, SMALL, implicit_step
from frictionjoint.law.stribeck import FS, SIGMA2, stribeck_level
from frictionjoint.simulate.row import (
    ASTRAY,
    FRONT,
    GAIN,
    LEAP,
    Q_EVALUATED,
    STARTED,
    T_COMMITTED,
    T_EVALUATED,
    TORQUE,
    V_EVALUATED,
    commit_effects,
    commit_point,
    rare_torque,
    shared_out,
)

# negligible torque, as a fraction of the breakaway torque: some hundred times its rounding error
NOTHING = 2.0**-44


@in_line
def usual_torque(
    P: Vector,
    p: int,
    effects: int,
    X: Vector,
    x: int,
    t: float,
    q: float,
    v: float,
    h: float,
    J: float,
    weight: float,
) -> float:
    """Friction torque at velocity v for the step of h seconds that begins now, N m.

    Returns NaN if the step is not a usual one; the row is then unchanged. For the arguments see
    `row.torque_now` and `row.over_the_step`.
    """
    evaluated = X[x + T_EVALUATED]
    since = evaluated - X[x + T_COMMITTED]
    gap = t - evaluated
    later = gap > 0.0
    front, a, dt = x + T_EVALUATED, x + FRONT + HEADER, gap
    if not later:
        front, a, dt = x + T_COMMITTED, x + FRONT, since
    if (
        P[p] != INTEGRATED
        or X[x + STARTED] == 0.0
        or not (gap >= 0.0 and gap <= LEAP * max(h, since) and dt > 0.0)
        or not (math.fabs(q) <= ASTRAY and math.fabs(v) <= ASTRAY)
    ):
        return np.nan
    first = p + 1
    stiffest, sigma1 = P[first + KNOTS + 3], P[first + SIGMA1]
    at = X[front + 1]
    dq = q - at
    dx = math.fabs(dq)
    side = first + POSITIVE if dq > 0.0 else first + NEGATIVE
    moves = dx * stiffest > NOTHING * P[side + FS]
    # computed first, so that no other value must be kept during the call
    S = stribeck_level(P, side, dx / dt) if moves else 0.0
    was, constant, gain = X[front + 2], X[front + 3], X[front + 4]
    Fh, Fb, turned = X[a + FH], X[a + FB], X[a + DIRECTION]
    n_min, n_max, virgin, rate = X[a + N_MIN], X[a + N_MAX], X[a + VIRGIN], X[a + RATE]
    stack = x + FRONT + 2 * HEADER
    if (
        n_min >= CAPACITY
        or n_max >= CAPACITY
        or (virgin == 1.0 and P[first + MASING] == 1.0)
        or X[stack] != -P[first + NEGATIVE + FS]
        or X[stack + CAPACITY] != P[first + POSITIVE + FS]
    ):
        return np.nan
    f, b, way, lows, highs, slip = Fh, Fb, turned, n_min, n_max, rate
    known, tangent = False, 0.0
    place, bent = at, stiffest * dq
    if moves:
        place, bent = q, 0.0
        way = math.copysign(1.0, dq)
        if turned == -way:
            b = f
            if way > 0.0:
                X[stack + int(n_min)] = f
                lows = n_min + 1.0
            else:
                X[stack + CAPACITY + int(n_max)] = f
                highs = n_max + 1.0
        top = closing_torque(X, a, stack, way)
        wiped = virgin == 0.0 and lows == 1.0 and highs == 1.0
        f, slip, K = undisturbed(P, first, way * f, way * b, wiped, 1.0, top, S, dx)
        if f != f:
            return np.nan
        f = way * f
        known, tangent = True, K * slip
    # The step is a usual one. The row is written only from here on.
    if later:
        commit_effects(P, p, effects, X, x)
        commit_point(X, x)
        for i in range(HEADER):
            X[x + FRONT + i] = X[a + i]
    e = x + FRONT + HEADER
    X[x + T_EVALUATED] = t
    X[x + Q_EVALUATED] = place
    X[x + V_EVALUATED] = v
    X[e + FH] = f
    X[e + FB] = b
    X[e + DIRECTION] = way
    X[e + N_MIN] = lows
    X[e + N_MAX] = highs
    X[e + VIRGIN] = virgin
    X[e + RATE] = slip
    if not later:
        X[e + FORGOTTEN] = X[a + FORGOTTEN]
        X[e + BOUND] = X[a + BOUND]
    # the same computation as in `over_the_step` and `secant.implicit_step`
    inertia = 1.0 / weight if weight > 0.0 and J * weight > 1.0 else J
    impulse = inertia * v + h * (inertia * (v - was) / dt + (constant + gain * v) - f - bent)
    ahead, r = math.copysign(1.0, impulse), math.fabs(impulse)
    side = first + POSITIVE if impulse > 0.0 else first + NEGATIVE
    Fs, sigma2 = P[side + FS], P[side + SIGMA2]
    constant, K, D, elastic = f + bent, stiffest, sigma1 + sigma2, 1.0
    if h * r * stiffest > REST * Fs * inertia:
        if way == -ahead:
            known, tangent, slip = True, stiffest, 1.0
        if known:
            damping = sigma1 * max(0.0, slip) + sigma2
            w = r / (inertia + h * (damping + h * max(0.0, tangent)))
            if h * w * stiffest > REST * Fs:
                known = h * w * math.fabs(tangent) <= SMALL * Fs
                K, D = max(0.0, tangent), damping
                constant += sigma1 * min(0.0, slip) * ahead * w
        if not known:
            constant, K, D, elastic = implicit_step(P, p, X, x + FRONT, h, inertia, impulse)
    constant, gain = shared_out(constant, K, D, elastic, h, v, inertia, weight)
    X[x + TORQUE] = constant
    X[x + GAIN] = gain
    return constant + gain * v


@in_line
def joint_torque(
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
    """Friction torque at velocity v for the step that begins now, N m; NaN after divergence."""
    F = usual_torque(P, p, effects, X, x, t, q, v, h, J, weight) if h > 0.0 else np.nan
    if F == F:
        return F
    return rare_torque(P, p, effects, X, x, t, q, v, step, h, J, weight)
