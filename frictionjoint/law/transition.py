"""The transition curve Fd: odd, increasing, concave for z > 0, piecewise linear.

Ganseman, Swevers, Prajogo and Al-Bender (1997) fit the measured curve by three segments. A curve
is stored in ``P`` from ``k`` on as its number of knots N, then N knots (z_i, F_i, slope_i), where
slope_i belongs to the segment that ends in knot i. The first segment starts in (0, 0); beyond the
last knot the last slope goes on, so that the inverse exists for every torque.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import in_line

KNOT_STRIDE = 3


@in_line
def knot_torque(P: Vector, k: int, j: int) -> float:
    """Torque F_j of knot j; knot -1 is the origin."""
    if j < 0:
        return 0.0
    return P[k + 1 + KNOT_STRIDE * j + 1]


@in_line
def segment_of_torque(P: Vector, k: int, F: float) -> int:
    """Index of the segment with the torque F >= 0, F in (F_{j-1}, F_j]."""
    last = int(P[k]) - 1
    j = 0
    while j < last and knot_torque(P, k, j) < F:
        j += 1
    return j


@in_line
def slope(P: Vector, k: int, j: int) -> float:
    """Stiffness dFd/dz on segment j."""
    return P[k + 1 + KNOT_STRIDE * j + 2]
