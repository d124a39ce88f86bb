"""Stiff presliding at a coarse step: the torque of the step's end instead of its start.

MuJoCo adds a passive torque explicitly. A presliding stiffness K on an inertia J then chatters
from h sqrt(K/J) = 2 on. Here the joint's own step is solved implicitly:

    v+ = v + h (f - F(q + h v+, v+)) / J

with f, all other torque on the joint, as it was over the last step: f = J (v - v-)/h + F-. At rest
v = v- and F = f, so a held load is held exactly; nothing creeps. In a single joint f is what acted,
and the step is the implicit Euler step of the joint with its friction.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.law.kernel import commit, hold_row, row_size

# (h**2 K + h sigma1) / J from which on the explicit torque is left: half of where it oscillates
STIFF = 0.25
_MOST = 60


@compiled
def _miss(
    P: Vector, p: int, S: Vector, s: int, h: float, f: float, J: float, v: float, end: float
) -> tuple[float, float]:
    """How far a guess of the velocity at the end misses, and the torque there."""
    F = hold_row(P, p, S, s, h * end, h, end)
    return end - v - h * (f - F) / J, F


@compiled
def torque_ahead(
    P: Vector,
    p: int,
    X: Vector,
    x: int,
    S: Vector,
    s: int,
    h: float,
    f: float,
    J: float,
    v: float,
) -> float:
    """Torque at the end of a step that begins at the evaluated point of the law's row X[x:].

    Args:
        S, s: room for a row, to try in. h: s, the step. f: N m, all other torque. J: kg m^2.
        v: rad/s at the step's beginning.
    """
    for i in range(row_size(P, p)):
        S[s + i] = X[x + i]
    commit(P, p, S, s)
    low = high = v
    at_low, F = _miss(P, p, S, s, h, f, J, v, v)
    at_high = at_low
    reach = abs(at_low)
    # torque rises with displacement, but for the Stribeck effect: mostly one reach is enough
    for _ in range(8):
        if at_low <= 0.0 <= at_high:
            break
        if at_low > 0.0:
            low -= reach
            at_low, F = _miss(P, p, S, s, h, f, J, v, low)
        else:
            high += reach
            at_high, F = _miss(P, p, S, s, h, f, J, v, high)
        reach *= 2.0
    side = 0
    for _ in range(_MOST):  # Illinois variant of false position
        if at_low == at_high:
            break
        end = (low * at_high - high * at_low) / (at_high - at_low)
        miss, F = _miss(P, p, S, s, h, f, J, v, end)
        if abs(miss) <= 1e-15 + 1e-12 * abs(v) or high - low < 1e-18:
            break
        if miss > 0.0:
            high, at_high = end, miss
            at_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, at_low = end, miss
            at_high *= 0.5 if side == -1 else 1.0
            side = -1
    return F
