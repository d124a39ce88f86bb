"""The control law of one tick, the same along a log and in a simulation.

    e     = target - position, nothing within the dead band; the target no faster than its limit
    u     = kp e + ki (integral of e) - kd v + kff (target's velocity), within the limit;
            nothing at all within a dead band that cuts
    u     = left u while |e| or |u| is above the threshold of a protection
    drive = supply u of a duty, less what the supply sags; else u

Block ``B``: see the names below. State ``S``: what a controller remembers from tick to tick.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, in_line

# drive per rad, per rad s, per rad/s; per rad/s of the target
KP, KI, KD, KFF = range(4)
# V at full duty; 1 where the output is no duty
SUPPLY = 4
# of |u|; rad, and whether u begins at nothing beyond the dead band; s between ticks; rad a count
LIMIT, DEADBAND, SHIFTED, PERIOD, COUNT = range(5, 10)
# whether the velocity is that of the counts from tick to tick
DIFFERENTIATED = 10
# protection: of the error, rad, and of u; what is left of u beyond them
DROP_ERROR, DROP_OUTPUT, DROP_LEFT = 11, 12, 13
# of a duty: resistance of the supply over the winding's, and back-EMF, V s/rad
SAG, SAG_EMF = 14, 15
# of the target, rad/s
SLEW = 16
BLOCK = 17

STARTED, TICK, HELD, INTEGRAL, SEEN, TARGET = range(6)
STATE = 6
# s by which a tick may come early: times are sums of steps
_EARLY = 1e-9


@in_line
def tick(B: Vector, S: Vector, t: float, target: float, q: float, v: float, supply: float) -> float:
    """Drive from the time t on: V, N m, or whatever the controller puts out.

    Args:
        target: that the controller knows at t, rad. q, v: rad, rad/s. supply: over that of the
            block, 1 where it is not measured.
    """
    first = S[STARTED] == 0.0
    dt = t - S[TICK]
    if not first and dt < B[PERIOD] - _EARLY:
        return S[HELD]
    if B[COUNT] > 0.0:
        q = B[COUNT] * math.floor(q / B[COUNT] + 0.5)
    if first:
        S[STARTED] = 1.0
        S[INTEGRAL] = 0.0
        S[SEEN] = q
        S[TARGET] = target
        dt = 0.0
    way = B[SLEW] * dt
    if abs(target - S[TARGET]) > way:
        target = S[TARGET] + math.copysign(way, target - S[TARGET])
    e = target - q
    rate = 0.0
    if dt > 0.0:
        rate = (target - S[TARGET]) / dt
        if B[DIFFERENTIATED] == 1.0:
            v = (q - S[SEEN]) / dt
    elif B[DIFFERENTIATED] == 1.0:
        v = 0.0
    acting = e
    within = abs(e) <= B[DEADBAND]
    if within:
        acting = 0.0
    elif B[SHIFTED] == 1.0:
        acting = e - math.copysign(B[DEADBAND], e)
    S[INTEGRAL] += acting * dt
    u = B[KP] * acting + B[KI] * S[INTEGRAL] - B[KD] * v + B[KFF] * rate
    if within and B[DEADBAND] > 0.0 and B[SHIFTED] == 0.0:
        u = 0.0  # a band that cuts is silent, whatever the velocity
    asked = abs(u)
    if asked > B[LIMIT]:
        u = math.copysign(B[LIMIT], u)
        if B[KI] != 0.0:  # an integral that goes on winding would hold the limit for long
            S[INTEGRAL] -= acting * dt
    if abs(e) > B[DROP_ERROR] or asked > B[DROP_OUTPUT]:
        u *= B[DROP_LEFT]
    drive = B[SUPPLY] * supply * u
    if B[SAG] > 0.0:
        drive -= B[SAG] * u * u * (drive - B[SAG_EMF] * v)
    S[TICK] = t
    S[SEEN] = q
    S[TARGET] = target
    S[HELD] = drive
    return drive


@compiled
def along(
    B: Vector,
    time: Vector,
    target: Vector,
    position: Vector,
    velocity: Vector,
    supply: Vector,
    drive: Vector,
    S: Vector,
) -> None:
    """Fill `drive` along a log; all of shape (n,), S of shape (STATE,), zero at first."""
    for k in range(len(time)):
        drive[k] = tick(B, S, time[k], target[k], position[k], velocity[k], supply[k])


def one_tick(B: Array, S: Array, t: float, target: float, q: float, v: float) -> float:
    """One tick, for a simulation that steps in Python; S of shape (STATE,), zero at first."""
    drive = np.empty(1)
    one = np.ones(1)
    along(B, t * one, target * one, q * one, v * one, one, drive, S)
    return float(drive[0])
