"""Generalized Maxwell-slip: Al-Bender, Lampaert and Swevers (2005), IEEE TAC 50(11),
equations 9 to 12.

N massless blocks in parallel, each behind a spring k_i, with a fraction alpha_i of S(v):

    stuck:     dF_i/dt = k_i v                                   until F_i reaches alpha_i S(v)
    slipping:  dF_i/dt = sgn(v) C (alpha_i - F_i / S(v))         until the motion reverses
    F = sum (F_i + sigma1 alpha_i dz_i/dt) + sigma2 v

dz_i/dt is v for an element that sticks and 0 for one that slips. C, in N m/s, is the rate of
attraction towards the Stribeck curve. At constant speed an element has at most one event in a step,
and both pieces are exact: a line in displacement up to alpha_i S, and an exponential in time of
length S / C. A stuck element that S has fallen below slips at once.

Own numbers: C, N, then k_i and alpha_i by turns. State: N torques F_i, then N flags (1 slipping).
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law.bristle import DIRECTION, FH, HEADER, OWN, RATE, side, total
from frictionjoint.law.stribeck import stribeck_level

ATTRACTION, N_ELEMENTS, ELEMENTS = OWN, OWN + 1, OWN + 2


@in_line
def size(P: Vector, p: int) -> int:
    """float64 of a header."""
    return HEADER + 2 * int(P[p + N_ELEMENTS])


@compiled
def step(P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float) -> float:
    """Friction torque after a displacement; see ``integrated.step`` for the arguments."""
    n = int(P[p + N_ELEMENTS])
    if dq == 0.0:
        for i in range(HEADER + 2 * n):
            X[h + i] = X[a + i]
        return total(P, p, X[h + FH], X[h + RATE], v)
    direction = 1.0 if dq > 0.0 else -1.0
    turned = X[a + DIRECTION] != direction
    dx = abs(dq)
    S = stribeck_level(P, side(p, direction), dx / dt if dt > 0.0 else 0.0)
    # What is left of a deviation from the level after the step; nothing in no time means all.
    missing = math.expm1(-P[p + ATTRACTION] * dt / S)
    Fh, sticking = 0.0, 0.0
    for i in range(n):
        k, share = P[p + ELEMENTS + 2 * i], P[p + ELEMENTS + 2 * i + 1]
        level = share * S
        f = direction * X[a + HEADER + i]
        slips = not turned and X[a + HEADER + n + i] == 1.0
        if not slips:
            if f >= level:
                slips = True
            else:
                f += k * dx
                # one that comes back by the way that it left stands at its level but for rounding
                if f >= (1.0 - 1e-12) * level:
                    f = level  # it stays there: the speed is constant
                    X[h + HEADER + i] = direction * f
                    X[h + HEADER + n + i] = 1.0
                    Fh += f
                    continue
                sticking += share
        if slips:
            f -= (level - f) * missing
        X[h + HEADER + i] = direction * f
        X[h + HEADER + n + i] = 1.0 if slips else 0.0
        Fh += f
    X[h + FH] = direction * Fh
    X[h + RATE] = sticking
    X[h + DIRECTION] = direction
    return total(P, p, X[h + FH], sticking, v)
