"""The hysteresis memory: a stack of minima m and a stack of maxima M of the hysteresis torque.

The 1997 paper calls this *local* memory; later papers, and this package, call the same property
*nonlocal* memory, because the torque depends on extrema far back and not on the present state
alone (Lampaert, Swevers and Al-Bender, 2002).

Header of a state (``X[h:h+HEADER]``), with Fh and Fb in N m:

    FH          hysteresis torque Fh(z)
    FB          base Fb of the present curve
    DIRECTION   -1, 0 (never moved) or 1: sign of the last nonzero displacement
    N_MIN       number of minima on m, the limit -Fs_neg included
    N_MAX       number of maxima on M, the limit Fs_pos included
    VIRGIN      1 until the first reset: below the stacks lies the first-loading curve
    RATE        dz/dx at the end of the last step, for sigma1 dz/dt
    FORGOTTEN   number of pairs given up for want of room
    BOUND       most that giving them up can have changed Fh, in N m

The stacks follow at ``X[s:s+2*CAPACITY]``, minima first. A step writes at most one new extremum,
into the slot above the top: the stacks of the state it started from stay whole, which lets a step
be evaluated any number of times before it is committed.
"""

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled

FH, FB, DIRECTION, N_MIN, N_MAX, VIRGIN, RATE, FORGOTTEN, BOUND = range(9)
HEADER = BOUND + 1
CAPACITY = 24


@compiled
def make_room(X: Vector, h: int, s: int) -> None:
    """Remove one pair of extrema from a full stack, so that a step always finds a free slot.

    The pair is the one whose loss changes the torque least. While pair k is missing, a curve that
    passes its extremum keeps the inner, stiffer base until the next outer extremum. Curves are
    concave, so the torque is too large by at most the distance between the neighbouring extrema on
    that side. The sum over all removed pairs bounds the error (X[h + BOUND]). The bound is zero
    again after a reset clears the memory.
    """
    n_min = int(X[h + N_MIN])
    n_max = int(X[h + N_MAX])
    if max(n_min, n_max) < CAPACITY:
        return
    m = s
    M = s + CAPACITY
    pairs = min(n_min, n_max)
    best, least = 1, 1e300
    for k in range(1, pairs):
        gap = max(X[M + k - 1] - X[M + k], X[m + k] - X[m + k - 1])
        if gap < least:
            best, least = k, gap
    for k in range(best, n_min - 1):
        X[m + k] = X[m + k + 1]
    for k in range(best, n_max - 1):
        X[M + k] = X[M + k + 1]
    X[h + N_MIN] = n_min - 1
    X[h + N_MAX] = n_max - 1
    X[h + FORGOTTEN] += 1.0
    X[h + BOUND] += least
