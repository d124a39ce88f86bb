"""Elasto-plastic friction: Dupont, Hayward, Armstrong and Altpeter (2002), IEEE TAC 47(5),
equations 6 to 9.

    F     = sigma0 z + sigma1 dz/dt + sigma2 v
    dz/dt = v (1 - alpha(z, v) sgn(v) z / zss(v))          zss = S(v) / sigma0

alpha is 0 where z and v have opposite signs or |z| <= zba, 1 from |z| = zss on, and rises between
them as half a sine wave: below the breakaway displacement zba the contact is elastic and cannot
drift. Here sigma0 zba = breakaway * Fc, with 0 < breakaway < 1: it lies below S(v) at all speeds.

Per step there are at most three pieces in displacement: the elastic one (exact), the transition,
and the relaxation from above after S has fallen (exact). In the transition u = -ln(1 - f/S) is the
variable: du/da = (1 - alpha r) / (1 - r) stays between 1 and 1 / (1 - r_ba), so that the equation
that is stiff near r = 1 is not stiff in u, and explicit Runge-Kutta steps solve it to about 1e-8.
Their size in u grows as exp(u / 5): the slope tends to 1 as exp(-u), and the error of a step of
fourth order goes with the fifth power of its size.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law.bristle import DIRECTION, FH, OWN, RATE, side, total
from frictionjoint.law.stribeck import FC, stribeck_level

SIGMA0, BREAKAWAY = OWN, OWN + 1


@in_line
def plastic_share(r: float, r_ba: float) -> float:
    """alpha at f = r S, for r > 0."""
    if r <= r_ba:
        return 0.0
    if r >= 1.0:
        return 1.0
    s = math.sin(0.5 * math.pi * (r - r_ba) / (1.0 - r_ba))
    return s * s


@in_line
def _slope(u: float, r_ba: float) -> float:
    left = math.exp(-u)
    r = 1.0 - left
    return (1.0 - plastic_share(r, r_ba) * r) / left


@compiled
def _transition(r: float, r_ba: float, a: float) -> float:
    """r after the displacement a (in units of S / sigma0) from r_ba <= r < 1."""
    u = -math.log1p(-r)
    while a > 0.0:
        # exp(-37) is below the spacing of doubles at 1
        if u + a >= 37.0:  # du/da >= 1
            return 1.0
        k1 = _slope(u, r_ba)
        d = min(a, 0.04 * math.exp(0.2 * u) / k1)
        k2 = _slope(u + 0.5 * d * k1, r_ba)
        k3 = _slope(u + 0.5 * d * k2, r_ba)
        k4 = _slope(u + d * k3, r_ba)
        u += d * (k1 + 2.0 * (k2 + k3) + k4) / 6.0
        if d == a:
            break
        a -= d
    return -math.expm1(-u)


@compiled
def step(P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float) -> float:
    """Friction torque after a displacement; see ``integrated.step`` for the arguments."""
    Fh, rate, direction = X[a + FH], X[a + RATE], X[a + DIRECTION]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        levels = side(p, direction)
        dx = abs(dq)
        S = stribeck_level(P, levels, dx / dt if dt > 0.0 else 0.0)
        f = direction * Fh
        f_ba = P[p + BREAKAWAY] * P[levels + FC]
        r_ba = f_ba / S
        left = P[p + SIGMA0] * dx
        elastic = min(left, max(0.0, f_ba - f))
        f += elastic
        left -= elastic
        if left > 0.0:
            if f >= S:
                f -= (S - f) * math.expm1(-left / S)
            else:
                # rounding can leave f a bit short of f_ba
                f = S * _transition(max(f / S, r_ba), r_ba, left / S)
        Fh = direction * f
        rate = 1.0 - plastic_share(f / S, r_ba) * f / S
    X[h + FH] = Fh
    X[h + RATE] = rate
    X[h + DIRECTION] = direction
    return total(P, p, Fh, rate, v)
