"""Stiffness and damping of a law over the coming step; nothing is committed.

Over a step of length h that ends with the velocity w the friction torque is

    F = Fh + (h K + D) w

Fh: hysteresis torque at the start of the step. K: its secant between the start and the expected
end. D = sigma1 dz/dq + sigma2, both at the expected end. The expected end follows from an implicit
step of the joint alone under the impulse r that remains while Fh is constant:

    J w + h (Fh(q + h w) - Fh(q) + D w) = r
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import bristle, integrated
from frictionjoint.law.kernel import (
    DAHL,
    DAHL_STRIBECK,
    INTEGRATED,
    LUGRE,
    header_size,
    hysteresis_torque,
    levels_at,
    presliding,
    trial,
)
from frictionjoint.law.memory import CAPACITY, DIRECTION, FB, FH, HEADER, N_MAX, N_MIN, RATE, VIRGIN
from frictionjoint.law.relaxation import power
from frictionjoint.law.stribeck import FS, SIGMA2
from frictionjoint.law.transition import segment_of_torque, slope

# of the breakaway torque: where the curve rises by less its tangent is its secant
SMALL = 1e-2
# and where it rises by less than this a joint is at rest, whose next motion may go either way
REST = 1e-6
# times the largest stiffness: a level that rises with the speed makes a secant steeper than that
STEEPEST = 2.0


@in_line
def steepening(strain: float, n: float) -> float:
    """Stiffness at a reversal over that at zero torque, in the 2002 form of the integrated law.

    Args: strain: torque over the breakaway torque of the new direction. n: exponent.
    """
    return 1.0 + power(strain, n)


@compiled
def _stiffest(P: Vector, p: int, X: Vector, x: int) -> float:
    """Stiffness of a motion that reverses at the evaluated torque, N m/rad.

    A contact that moves towards its level is softer.
    """
    now = hysteresis_torque(P, p, X, x)
    strain = abs(now) / P[bristle.side(levels_at(P, p), -now) + FS]
    K, _sigma1 = presliding(P, p)
    own = p + 1 + bristle.OWN
    if P[p] == INTEGRATED:
        if P[p + 1 + integrated.LAMPAERT] == 1.0:
            K *= steepening(strain, P[p + 1 + integrated.EXPONENT])
    elif P[p] == LUGRE:
        K *= 1.0 + strain
    elif P[p] == DAHL or P[p] == DAHL_STRIBECK:
        K = P[own] * (1.0 + strain) ** P[own + 1]
    return K


@in_line
def _tangent(
    P: Vector, p: int, X: Vector, x: int, stiffest: float, way: float
) -> tuple[float, float]:
    """dFh/dq, N m/rad, and dz/dq at the evaluated point, for motion in the direction `way`."""
    if P[p] != INTEGRATED:
        h = x + header_size(P, p)
        if X[h + bristle.DIRECTION] == -way:
            return stiffest, 1.0
        K, _sigma1 = presliding(P, p)
        if P[p] == DAHL or P[p] == DAHL_STRIBECK:
            K = P[p + 1 + bristle.OWN]
        return K * X[h + bristle.RATE], X[h + bristle.RATE]
    h, k = x + HEADER, p + 1 + integrated.KNOTS
    if X[h + DIRECTION] == -way:
        return stiffest, 1.0
    first = X[h + VIRGIN] == 1.0 and X[h + N_MIN] == 1.0 and X[h + N_MAX] == 1.0
    scale = 0.5 if first and P[p + 1 + integrated.MASING] == 1.0 else 1.0
    risen = max(0.0, way * (X[h + FH] - X[h + FB])) / scale
    rate = X[h + RATE]
    return slope(P, k, segment_of_torque(P, k, risen)) * rate, rate


@in_line
def _is_full(P: Vector, p: int, X: Vector, x: int) -> bool:
    """Whether the stacks have no room for another extremum."""
    h = x + HEADER
    return bool(P[p] == INTEGRATED and max(X[h + N_MIN], X[h + N_MAX]) >= CAPACITY)


@compiled
def secant(P: Vector, p: int, X: Vector, x: int, h: float, w: float) -> tuple[float, float, float]:
    """Constant part of the torque, N m, K, N m/rad, and D, N m s/rad, for a step that ends with w.

    A torque that falls while the joint moves is no spring and no damper: what is expected of it
    over the step belongs to the constant part.

    Args: h: s, the step. w: rad/s, expected at its end.
    """
    _at_zero, sigma1 = presliding(P, p)
    stiffest = _stiffest(P, p, X, x)
    side = bristle.side(levels_at(P, p), w)
    Fs, sigma2 = P[side + FS], P[side + SIGMA2]
    now = hysteresis_torque(P, p, X, x)
    if abs(h * w) * stiffest <= REST * Fs or _is_full(P, p, X, x):
        return now, stiffest, sigma1 + sigma2
    K, rate = _tangent(P, p, X, x, stiffest, 1.0 if w > 0.0 else -1.0)
    if abs(h * w * K) > SMALL * Fs:
        end, rate = trial(P, p, X, x, h * w, h, w)
        K = min(STEEPEST * stiffest, (end - now) / (h * w))
    now += sigma1 * min(0.0, rate) * w
    return now, max(0.0, K), sigma1 * max(0.0, rate) + sigma2


@compiled
def implicit_step(
    P: Vector, p: int, X: Vector, x: int, h: float, J: float, impulse: float
) -> tuple[float, float, float, float]:
    """`secant` for the step whose final velocity follows from the impulse, and dz/dq at its end.

    Args: h: s, the step. J: kg m^2, the joint's inertia. impulse: N m s, r above.
    """
    _at_zero, sigma1 = presliding(P, p)
    stiffest = _stiffest(P, p, X, x)
    way = 1.0 if impulse > 0.0 else -1.0
    side = bristle.side(levels_at(P, p), impulse)
    Fs, sigma2 = P[side + FS], P[side + SIGMA2]
    now = hysteresis_torque(P, p, X, x)
    tangent, rate = _tangent(P, p, X, x, stiffest, way)
    D = sigma1 * max(0.0, rate) + sigma2
    r = way * impulse
    w = r / (J + h * (D + h * max(0.0, tangent)))
    if not h * w * stiffest > REST * Fs:
        return now, stiffest, sigma1 + sigma2, 1.0
    if h * w * abs(tangent) <= SMALL * Fs:
        now += sigma1 * min(0.0, rate) * way * w
        return now, max(0.0, tangent), D, 1.0
    if _is_full(P, p, X, x):
        return now, stiffest, sigma1 + sigma2, 1.0
    low, at_low = 0.0, -r
    high, at_high = 0.0, 0.0
    K = stiffest
    for _ in range(8):
        # rad/s: beyond, the law's search for events would not end
        if not w <= 1e10:
            break
        end, rate = trial(P, p, X, x, way * h * w, h, way * w)
        D = sigma1 * max(0.0, rate) + sigma2
        K = way * (end - now) / (h * w)
        miss = (J + h * (D + h * K)) * w - r
        # the torque at the expected end may miss 2% of the breakaway torque
        if abs(miss) <= 2e-2 * h * Fs:
            break
        rise = (miss - at_low) / (w - low)
        if miss > 0.0:
            high, at_high = w, miss
        else:
            low, at_low = w, miss
        slides = r / (J + h * D)
        if at_high > 0.0:
            w = (low * at_high - high * at_low) / (at_high - at_low)
        elif w < slides:
            # the curve is concave: a chord does not pass the solution that sticks, if there is one
            w = min(slides, w - miss / rise) if rise > 0.0 else slides
        else:
            break
    now += sigma1 * min(0.0, rate) * way * w
    return now, min(STEEPEST * stiffest, max(0.0, K)), D, min(1.0, max(0.0, rate))
