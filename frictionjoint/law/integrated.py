"""One step of the integrated friction model, integrated in displacement.

Ganseman, Swevers, Prajogo and Al-Bender (1997):

    F     = Fh(z) + sigma1 dz/dt + sigma2 v
    Fh(z) = Fb + Fd(z)
    dz/dt = v (1 - sgn(r) |r|**n)      r = Fd(z) / (S(v) - Fb)      variant ganseman1997
                                       r = Fh(z) / S(v)             variant lampaert2002

The state is Fh itself: Fd is invertible in closed form, so z = Fd^-1(Fh - Fb) carries nothing
more, and Fh is continuous by construction through reversals, closings and resets. Within one
step the motion has one direction and one speed, S is constant, and the step is a chain of exact
pieces between events (a knot of Fd, a closing loop, a reset), each located in displacement. So
the result does not depend on how a motion at constant speed is cut into steps.

Everything is written for motion in the positive direction; the other one is its mirror image.

Decisions where the paper is silent
* A reset fires on the inequality Fh >= (1 - RESET_MARGIN) S(v), not on dz/dt = 0: at constant
  speed Fh only approaches S, and when S falls below Fb inside presliding r would change sign and
  the torque would diverge. Past the reset the base is a limit, so S - Fb > 0 and r > 0 always.
* Fb jumps when a loop closes while S does not; in the 1997 form dz/dt, and with it sigma1 dz/dt,
  jumps. That is the published law; the 2002 form has no such jump because Fb is not in its r.
* The 1997 form is not passive at small n: below zero torque (mirrored) r is still positive, and
  the plastic part of the motion takes Fh's own work back. At a constant level no cycle is known to
  gain from it; a cycle whose legs have different levels can (lab/paper/weaknesses.py). That is
  the published law, and stays. In the 2002 form Fh r >= 0, so plastic motion only dissipates.
* A loop that opened on the first-loading curve returns to it when it closes: wiping out holds for
  the first loading as for every other curve.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law.bristle import total
from frictionjoint.law.memory import (
    BOUND,
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
from frictionjoint.law.relaxation import advance, distance, rate
from frictionjoint.law.stribeck import FS, stribeck_level
from frictionjoint.law.transition import knot_torque, segment_of_torque, slope

RESET_MARGIN = 1e-3
# far more than `advance` and `distance` differ by
SHORT = 1e-6

# Layout of P[p:]; a direction block is Fs, Fc, Vs, delta, sigma2 (see stribeck). From sigma1 to the
# end of these blocks it is that of `bristle`.
LAMPAERT, MASING, EXPONENT, SIGMA1, POSITIVE = range(5)
NEGATIVE = POSITIVE + 5
KNOTS = NEGATIVE + 5

_KNOT, _CLOSING, _RESET = range(3)


@compiled
def start(P: Vector, p: int, X: Vector, h: int, s: int) -> None:
    """State of a joint at rest that never moved: Fh = 0, the stacks hold only the limits."""
    for i in range(HEADER):
        X[h + i] = 0.0
    X[h + N_MIN] = 1.0
    X[h + N_MAX] = 1.0
    X[h + VIRGIN] = 1.0
    X[h + RATE] = 1.0
    X[s] = -P[p + NEGATIVE + FS]
    X[s + CAPACITY] = P[p + POSITIVE + FS]


@compiled
def set_limits(P: Vector, p: int, X: Vector, h: int, s: int) -> None:
    """Adapt header `h` and its stacks at `s` to parameters that were changed.

    Extrema beyond the new limits are removed together with their partners, and the torque is
    limited. The curve then continues.
    """
    lowest, highest = -P[p + NEGATIVE + FS], P[p + POSITIVE + FS]
    m, M = s, s + CAPACITY
    X[m] = lowest
    X[M] = highest
    n_min, n_max = int(X[h + N_MIN]), int(X[h + N_MAX])
    k = 1
    while k < max(n_min, n_max):
        inside = (k >= n_min or lowest < X[m + k] < highest) and (
            k >= n_max or lowest < X[M + k] < highest
        )
        if inside:
            k += 1
            continue
        for i in range(k, n_min - 1):
            X[m + i] = X[m + i + 1]
        for i in range(k, n_max - 1):
            X[M + i] = X[M + i + 1]
        n_min -= 1 if k < n_min else 0
        n_max -= 1 if k < n_max else 0
    X[h + N_MIN] = n_min
    X[h + N_MAX] = n_max
    X[h + FH] = min(max(X[h + FH], lowest), highest)
    if X[h + DIRECTION] != 0.0 and not _on_virgin(X, h):
        X[h + FB] = X[m + n_min - 1] if X[h + DIRECTION] > 0.0 else X[M + n_max - 1]
    elif _on_virgin(X, h):
        X[h + FB] = 0.0


@in_line
def _on_virgin(X: Vector, h: int) -> bool:
    return X[h + VIRGIN] == 1.0 and X[h + N_MIN] == 1.0 and X[h + N_MAX] == 1.0


@in_line
def _reverse(P: Vector, p: int, X: Vector, h: int, s: int, direction: float) -> None:
    """Store the torque at the turning point as an extremum and as the base of the new curve."""
    Fh = X[h + FH]
    from_masing_virgin = P[p + MASING] == 1.0 and _on_virgin(X, h)
    n_min = int(X[h + N_MIN])
    n_max = int(X[h + N_MAX])
    # On the Masing first-loading curve the loop closes at the mirror image of its extremum.
    if direction < 0.0 or from_masing_virgin:
        X[s + CAPACITY + n_max] = abs(Fh) if from_masing_virgin else Fh
        X[h + N_MAX] = n_max + 1
    if direction > 0.0 or from_masing_virgin:
        X[s + n_min] = -abs(Fh) if from_masing_virgin else Fh
        X[h + N_MIN] = n_min + 1
    X[h + FB] = Fh


@in_line
def _close(P: Vector, p: int, X: Vector, h: int, s: int, direction: float) -> None:
    """Remove the closed loop's two extrema; the motion continues on the curve outside the loop."""
    n_min = X[h + N_MIN] - 1.0
    n_max = X[h + N_MAX] - 1.0
    # The first Masing extremum also stands, mirrored, on the other stack: both leave together.
    if P[p + MASING] == 1.0 and X[h + VIRGIN] == 1.0 and min(n_min, n_max) == 1.0:
        n_min = n_max = 1.0
    X[h + N_MIN] = n_min
    X[h + N_MAX] = n_max
    if _on_virgin(X, h):
        X[h + FB] = 0.0
    elif direction > 0.0:
        X[h + FB] = X[s + int(n_min) - 1]
    else:
        X[h + FB] = X[s + CAPACITY + int(n_max) - 1]


@in_line
def _reset(X: Vector, h: int, s: int, direction: float) -> None:
    """Clear the memory after full sliding; the base becomes the limit opposite to the motion."""
    X[h + N_MIN] = 1.0
    X[h + N_MAX] = 1.0
    X[h + VIRGIN] = 0.0
    X[h + BOUND] = 0.0
    X[h + FB] = X[s] if direction > 0.0 else X[s + CAPACITY]


@in_line
def closing_torque(X: Vector, h: int, s: int, direction: float) -> float:
    """Torque, mirrored, at which the innermost open loop closes; infinite without one."""
    if direction > 0.0:
        tops = int(X[h + N_MAX])
        return X[s + CAPACITY + tops - 1] if tops > 1 else math.inf
    tops = int(X[h + N_MIN])
    return -X[s + tops - 1] if tops > 1 else math.inf


@in_line
def _slide(
    P: Vector, p: int, X: Vector, h: int, s: int, direction: float, S: float, dx: float
) -> None:
    """Move by dx > 0 in `direction` at the constant level S > 0; f and b are mirrored torques."""
    n = P[p + EXPONENT]
    k = p + KNOTS
    last = int(P[k]) - 1
    lampaert = P[p + LAMPAERT] == 1.0
    reset_torque = (1.0 - RESET_MARGIN) * S
    f = direction * X[h + FH]
    j = -1  # segment of Fd; -1 asks for it anew because the base has changed
    r = 1.0
    while True:
        wiped = X[h + VIRGIN] == 0.0 and X[h + N_MIN] == 1.0 and X[h + N_MAX] == 1.0
        if not wiped and f >= reset_torque:
            _reset(X, h, s, direction)
            wiped = True
            j = -1
        b = direction * X[h + FB]
        # First loading under Masing's rule is Fd(2z)/2: torques of the knots halve, slopes stay.
        scale = 0.5 if P[p + MASING] == 1.0 and _on_virgin(X, h) else 1.0
        span = S if lampaert else S - b
        origin = 0.0 if lampaert else b
        r = (f - origin) / span
        if r == 1.0:
            break
        if j < 0:
            j = segment_of_torque(P, k, max(0.0, (f - b) / scale))
        event = _KNOT
        if r < 1.0:
            target = b + scale * knot_torque(P, k, j) if j < last else math.inf
            top = closing_torque(X, h, s, direction)
            if top <= target:
                target, event = top, _CLOSING
            if not wiped and reset_torque < target:
                target, event = reset_torque, _RESET
        else:
            # S has fallen below Fh: the torque relaxes down to S through the knots below.
            target = b + scale * knot_torque(P, k, j - 1) if j > 0 else -math.inf
        K = slope(P, k, j)
        stop = (target - origin) / span
        # where the step ends clearly short of the target its distance need not be known
        near = abs(stop - r) <= SHORT
        end = r if near else advance(r, dx * K / span, n)
        if not near and abs(end - r) + SHORT < abs(stop - r):
            r = end
            f = origin + r * span
            break
        reach = distance(r, stop, n) * span / K
        if dx < reach:
            r = advance(r, dx * K / span, n) if near else end
            f = origin + r * span
            break
        # Rounding can put a target a bit behind f; it is then reached at once.
        dx -= max(0.0, reach)
        f = target
        X[h + FH] = direction * f
        if event == _CLOSING:
            _close(P, p, X, h, s, direction)
            j = -1
        elif event == _KNOT:
            j += 1 if r < 1.0 else -1
    X[h + FH] = direction * f
    X[h + RATE] = rate(r, n)


@in_line
def _move(P: Vector, p: int, X: Vector, a: int, h: int, s: int, dq: float, S: float) -> None:
    """Header `h` after the displacement dq from header `a` at the level S."""
    if h != a:
        for i in range(HEADER):
            X[h + i] = X[a + i]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        if X[h + DIRECTION] == -direction:
            _reverse(P, p, X, h, s, direction)
        X[h + DIRECTION] = direction
        _slide(P, p, X, h, s, direction, S, abs(dq))


@compiled
def step(
    P: Vector, p: int, X: Vector, a: int, h: int, s: int, dq: float, dt: float, v: float
) -> float:
    """Friction torque after the displacement dq taken in the time dt, arriving with velocity v.

    Args:
        P, p: parameters and where the law's block begins; X: state, with header `a` of the
        starting point, header `h` of the result (may be `a`) and stacks at `s`; dq in rad, dt in
        s (0 only with dq = 0 or for a start), v in rad/s.
    Returns: F in N m, opposing the motion.
    """
    S = 0.0
    if dq != 0.0:
        side = p + POSITIVE if dq > 0.0 else p + NEGATIVE
        S = stribeck_level(P, side, abs(dq) / dt if dt > 0.0 else 0.0)
    _move(P, p, X, a, h, s, dq, S)
    return total(P, p + SIGMA1, X[h + FH], X[h + RATE], v)


@in_line
def undisturbed(
    P: Vector,
    p: int,
    f: float,
    b: float,
    wiped: bool,
    scale: float,
    top: float,
    S: float,
    dx: float,
) -> tuple[float, float, float]:
    """A motion by dx > 0 at the level S without an event; NaN if an event is possible.

    It makes the first checks of `_slide` and writes nothing.

    Args:
        f, b: Fh and Fb, mirrored. wiped: whether the memory is empty. scale: of the knots' torques.
        top: torque at which the innermost open loop closes, see `closing_torque`.
    Returns:
        Fh, mirrored, dz/dx and the slope of Fd, N m/rad, at its end.
    """
    reset_torque = (1.0 - RESET_MARGIN) * S
    origin = 0.0 if P[p + LAMPAERT] == 1.0 else b
    span = S - origin
    if not span > 0.0:
        return math.nan, 0.0, 0.0
    k = p + KNOTS
    j = segment_of_torque(P, k, max(0.0, (f - b) / scale))
    K = slope(P, k, j)
    r = (f - origin) / span
    # without rounding: where the torque is the level it stays so
    if r == 1.0:
        return S, 0.0, K
    n = P[p + EXPONENT]
    end = advance(r, dx * K / span, n)
    reached = S if end == 1.0 else origin + end * span
    if r < 1.0:
        target = top
        if j < int(P[k]) - 1:
            target = min(target, b + scale * knot_torque(P, k, j))
        if not wiped:
            target = min(target, reset_torque)
        # the torque stays below the level but for rounding, and rises at most by K; nearer to an
        # event only exactly
        below = S - 1e-13 * span <= target or (r >= 0.0 and f + (1.0 + SHORT) * K * dx < target)
        usual = below or reached + SHORT * span < target
    else:
        usual = wiped and (j == 0 or reached - SHORT * span > b + scale * knot_torque(P, k, j - 1))
    return reached if usual else math.nan, rate(end, n), K
