"""The usual step of a simulated joint: the integrated law in a step without events.

In most steps a joint follows one hysteresis curve, reverses, slides or rests. `usual_torque`
computes such a step faster: it combines `row.torque_now` and `row.over_the_step`, and reads and
writes each number of the row only once. These two functions compute every other step: other laws,
starts, jumps in time, changed parameters, loops that close, resets of the memory, knots of the
transition curve, full stacks.

Rounding errors move a joint at rest back and forth, and the law would take each of these movements
for a reversal and fill its memory. So a displacement that barely changes the torque is treated as
elastic: the law keeps its state and its position until the displacement has grown.
"""

import math

import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.compiled import in_line
from frictionjoint.law import memory
from frictionjoint.law.integrated import (
    EXPONENT,
    KNOTS,
    LAMPAERT,
    MASING,
    NEGATIVE,
    POSITIVE,
    SIGMA1,
    closing_torque,
    undisturbed,
)
from frictionjoint.law.kernel import INTEGRATED
from frictionjoint.law.secant import REST, SMALL, implicit_step, steepening
from frictionjoint.law.stribeck import FS, SIGMA2, stribeck_level
from frictionjoint.simulate import row

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

    Returns NaN if the step is not a usual one, or explicit (h = 0); the row is then unchanged. For
    the arguments see `row.torque_now` and `row.over_the_step`.
    """
    evaluated = X[x + row.T_EVALUATED]
    since = evaluated - X[x + row.T_COMMITTED]
    gap = t - evaluated
    later = gap > 0.0
    front, a, dt = x + row.T_EVALUATED, x + row.FRONT + memory.HEADER, gap
    if not later:
        front, a, dt = x + row.T_COMMITTED, x + row.FRONT, since
    if (
        P[p] != INTEGRATED
        or h == 0.0
        or X[x + row.STEP] == 0.0
        or not (gap >= 0.0 and gap <= row.LEAP * max(h, X[x + row.STEP]) and dt > 0.0)
        or not (math.fabs(q) <= row.ASTRAY and math.fabs(v) <= row.ASTRAY)
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
    Fh, Fb, turned = X[a + memory.FH], X[a + memory.FB], X[a + memory.DIRECTION]
    n_min, n_max, virgin, rate = (
        X[a + memory.N_MIN],
        X[a + memory.N_MAX],
        X[a + memory.VIRGIN],
        X[a + memory.RATE],
    )
    stack = x + row.FRONT + 2 * memory.HEADER
    if (
        n_min >= memory.CAPACITY
        or n_max >= memory.CAPACITY
        or (virgin == 1.0 and P[first + MASING] == 1.0)
        or X[stack] != -P[first + NEGATIVE + FS]
        or X[stack + memory.CAPACITY] != P[first + POSITIVE + FS]
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
                X[stack + memory.CAPACITY + int(n_max)] = f
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
        row.commit_effects(P, p, effects, X, x)
        row.commit_point(X, x)
        for i in range(memory.HEADER):
            X[x + row.FRONT + i] = X[a + i]
    e = x + row.FRONT + memory.HEADER
    X[x + row.STEP] = h
    X[x + row.T_EVALUATED] = t
    X[x + row.Q_EVALUATED] = place
    X[x + row.V_EVALUATED] = v
    X[e + memory.FH] = f
    X[e + memory.FB] = b
    X[e + memory.DIRECTION] = way
    X[e + memory.N_MIN] = lows
    X[e + memory.N_MAX] = highs
    X[e + memory.VIRGIN] = virgin
    X[e + memory.RATE] = slip
    if not later:
        X[e + memory.FORGOTTEN] = X[a + memory.FORGOTTEN]
        X[e + memory.BOUND] = X[a + memory.BOUND]
    # the same computation as in `over_the_step` and `secant.implicit_step`
    if P[first + LAMPAERT] == 1.0:
        against = first + NEGATIVE if f > 0.0 else first + POSITIVE
        stiffest *= steepening(math.fabs(f) / P[against + FS], P[first + EXPONENT])
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
            constant, K, D, elastic = implicit_step(P, p, X, x + row.FRONT, h, inertia, impulse)
    constant, gain = row.shared_out(constant, K, D, elastic, h, v, inertia, weight)
    X[x + row.TORQUE] = constant
    X[x + row.GAIN] = gain
    return constant + gain * v
