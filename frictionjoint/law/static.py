"""Static friction: Coulomb, Stribeck and viscous torque as a function of velocity alone.

    F = S(v) sat(v / V0) + sigma2 v        sat(x) = max(-1, min(1, x))

The textbook curve, as Armstrong-Helouvry (1991) and Olsson et al. (1998) review it, has no value at
v = 0: there it balances whatever is applied, up to Fs. A torque given by the motion alone cannot
do that, so the jump is drawn out over |v| < V0. That is a regularisation, not a hold: under a load
below breakaway the joint creeps at up to V0. A hold as Karnopp (1985) proposed needs the applied
torque, which a law driven by displacement does not know. In simulation |v| < V0 acts as a damper
of Fs / V0 and would never come to rest.

So a simulation has the same level behind an elastic element: `elastic_step`, a spring that slips at
S(v). It yields after 1 ms at V0, where the fitted curve has reached the level too.

The law itself has no memory: its result depends on the velocity at the end of the step only.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law.bristle import DIRECTION, FH, NEGATIVE, OWN, POSITIVE, RATE, side, total
from frictionjoint.law.stribeck import FS, stribeck_level

V0 = OWN


@compiled
def step(P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float) -> float:
    """Friction torque at velocity v; see ``integrated.step`` for the arguments."""
    X[h + DIRECTION] = 0.0
    X[h + RATE] = 0.0
    if v == 0.0:
        X[h + FH] = 0.0
    else:
        direction = 1.0 if v > 0.0 else -1.0
        S = stribeck_level(P, side(p, direction), abs(v))
        X[h + FH] = direction * S * min(1.0, abs(v) / P[p + V0])
    return total(P, p, X[h + FH], 0.0, v)


@compiled
def stiffness(P: Vector, p: int) -> float:
    """Stiffness of the elastic element, N m/rad."""
    return max(P[p + POSITIVE + FS], P[p + NEGATIVE + FS]) / (P[p + V0] * 1e-3)


@compiled
def elastic_step(
    P: Vector, p: int, X: Vector, a: int, h: int, dq: float, dt: float, v: float
) -> float:
    """Friction torque of the elastic element that slips at S(v); arguments as of `step`."""
    Fh, rate, direction = X[a + FH], X[a + RATE], X[a + DIRECTION]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        S = stribeck_level(P, side(p, direction), abs(dq) / dt if dt > 0.0 else 0.0)
        strained = direction * Fh + stiffness(P, p) * abs(dq)
        rate = 1.0 if strained < S else 0.0
        Fh = direction * min(strained, S)
    X[h + FH] = Fh
    X[h + RATE] = rate
    X[h + DIRECTION] = direction
    return total(P, p, Fh, rate, v)
