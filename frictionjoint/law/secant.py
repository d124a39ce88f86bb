"""How stiff and how strongly damped a law is over the coming step; nothing is committed.

Over a step of length h that ends with the velocity w the friction torque is

    F = Fh + (h K + D) w

Fh: hysteresis torque where the step begins. K: its secant between there and the expected end.
D = sigma1 dz/dq + sigma2, both at the expected end.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import bristle, integrated
from frictionjoint.law.kernel import INTEGRATED, hysteresis_torque, presliding, trial
from frictionjoint.law.memory import (
    CAPACITY,
    DIRECTION,
    FB,
    FH,
    HEADER,
    N_MAX,
    N_MIN,
    RATE,
    VIRGIN,
)
from frictionjoint.law.stribeck import FS, SIGMA2
from frictionjoint.law.transition import segment_of_torque, slope

# of the breakaway torque: where the curve rises by less its tangent is its secant
SMALL = 1e-2
# and where it rises by less than this a joint is at rest, whose next motion may go either way
REST = 1e-6
# times the largest stiffness: a level that rises with the speed makes a secant steeper than that
STEEPEST = 2.0


@in_line
def _tangent(P: Vector, p: int, X: Vector, h: int, w: float) -> tuple[float, float]:
    """dFh/dq, N m/rad, and dz/dq at the header `h` of the integrated law, for motion towards w."""
    k = p + integrated.KNOTS
    direction = 1.0 if w > 0.0 else -1.0
    if X[h + DIRECTION] == -direction:
        return slope(P, k, 0), 1.0
    first = X[h + VIRGIN] == 1.0 and X[h + N_MIN] == 1.0 and X[h + N_MAX] == 1.0
    scale = 0.5 if first and P[p + integrated.MASING] == 1.0 else 1.0
    risen = max(0.0, direction * (X[h + FH] - X[h + FB])) / scale
    rate = X[h + RATE]
    return slope(P, k, segment_of_torque(P, k, risen)) * rate, rate


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
    if abs(dq) * stiffest <= REST * P[side + FS]:
        return now, stiffest, sigma1 + sigma2
    if P[p] == INTEGRATED:
        tangent, rate = _tangent(P, p + 1, X, x + HEADER, w)
        if abs(dq * tangent) <= SMALL * P[side + FS]:
            now += sigma1 * min(0.0, rate) * w
            return now, max(0.0, tangent), sigma1 * max(0.0, rate) + sigma2
    if P[p] == INTEGRATED and max(X[x + HEADER + N_MIN], X[x + HEADER + N_MAX]) >= CAPACITY:
        # no room for another extremum
        return now, stiffest, sigma1 + sigma2
    end, rate = trial(P, p, X, x, dq, h, w)
    K = (end - now) / dq
    if rate < 0.0:
        now += sigma1 * rate * w
    return now, min(STEEPEST * stiffest, max(0.0, K)), sigma1 * max(0.0, rate) + sigma2
