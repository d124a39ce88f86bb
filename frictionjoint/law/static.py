"""Static friction: Coulomb, Stribeck and viscous torque as a function of velocity alone.

    F = S(v) sat(v / V0) + sigma2 v        sat(x) = max(-1, min(1, x))

The textbook curve, as Armstrong-Helouvry (1991) and Olsson et al. (1998) review it, has no value at
v = 0: there it balances whatever is applied, up to Fs. A torque given by the motion alone cannot
do that, so the jump is drawn out over |v| < V0. That is a regularisation, not a hold: under a load
below breakaway the joint creeps at up to V0. A hold as Karnopp (1985) proposed needs the applied
torque, which a law driven by displacement does not know. In simulation |v| < V0 acts as a damper
of Fs / V0; an explicit step chatters within +-Fs once h Fs / (V0 J) exceeds 2.

The law has no memory: its result depends on the velocity at the end of the step only.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law.bristle import DIRECTION, FH, OWN, RATE, side, total
from frictionjoint.law.stribeck import stribeck_level

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
