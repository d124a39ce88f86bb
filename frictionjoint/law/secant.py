"""How stiff and how strongly damped a law is over the coming step; nothing is committed.

Over a step of length h that ends with the velocity w the friction torque is

    F = Fh + (h K + D) w

Fh: hysteresis torque where the step begins. K: its secant between there and the expected end.
D = sigma1 dz/dq + sigma2, both at the expected end.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law import bristle, integrated
from frictionjoint.law.kernel import INTEGRATED, hysteresis_torque, presliding, trial
from frictionjoint.law.memory import CAPACITY, HEADER, N_MAX, N_MIN
from frictionjoint.law.stribeck import FS, SIGMA2

# of the breakaway torque: a spring that changes by less is not tried out
SMALL = 1e-6
# times the largest stiffness: a level that rises with the speed makes a secant steeper than that
STEEPEST = 2.0


@compiled
def secant(P: Vector, p: int, X: Vector, x: int, h: float, w: float) -> tuple[float, float, float]:
    """Constant part of the torque, N m, K, N m/rad, and D, N m s/rad, after an evaluation.

    A torque that falls while the joint moves is no spring and no damper: what is expected of it
    over the step belongs to the constant part.

    Args: h: s, the step. w: rad/s, expected at its end.
    """
    stiffest, sigma1 = presliding(P, p)
    first = p + 1 + (integrated.POSITIVE if P[p] == INTEGRATED else bristle.POSITIVE)
    side = first if w > 0.0 else first + bristle.NEGATIVE - bristle.POSITIVE
    sigma2 = P[side + SIGMA2]
    now = hysteresis_torque(P, p, X, x)
    dq = h * w
    if abs(dq) * stiffest <= SMALL * P[side + FS]:
        return now, stiffest, sigma1 + sigma2
    if P[p] == INTEGRATED and max(X[x + HEADER + N_MIN], X[x + HEADER + N_MAX]) >= CAPACITY:
        # no room for another extremum
        return now, stiffest, sigma1 + sigma2
    end, rate = trial(P, p, X, x, dq, h, w)
    K = (end - now) / dq
    if rate < 0.0:
        now += sigma1 * rate * w
    return now, min(STEEPEST * stiffest, max(0.0, K)), sigma1 * max(0.0, rate) + sigma2
