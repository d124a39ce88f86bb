"""The control law of one tick, for logs and simulations.

    e     = target - position, 0 inside the dead band; the target has a speed limit
    u     = kp e + ki (integral of e) - kd v + kff (target's velocity), within the limit;
            nothing at all within a dead band that cuts
    u     = left u while |e| or |u| is above the protection's threshold
    drive = supply u minus the supply's sag for a duty; otherwise u

Block ``B``: see the names below. State ``S``: memory of a controller between ticks.
"""

import math

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, in_line

(
    KP,  # drive per rad
    KI,  # per rad s
    KD,  # per rad/s
    KFF,  # per rad/s of the target
    SUPPLY,  # V at full duty; 1 where the output is no duty
    LIMIT,  # of |u|
    DEADBAND,  # rad
    SHIFTED,  # form of the dead band
    PERIOD,  # s between ticks
    COUNT,  # rad
    DIFFERENTIATED,  # whether the velocity is the difference of counts between ticks
    DROP_ERROR,  # error at which the protection acts, rad
    DROP_OUTPUT,  # |u| at which it acts
    DROP_LEFT,  # remaining fraction of u
    SAG,  # for a duty: supply resistance relative to the winding's
    SAG_EMF,  # and back-EMF, V s/rad
    SLEW,  # speed limit of the target, rad/s
    MEASURED,  # 1 where there is no controller: the target is the drive itself, as measured
) = range(18)
BLOCK = MEASURED + 1

STARTED, TICK, HELD, INTEGRAL, SEEN, TARGET = range(6)
STATE = TARGET + 1


@in_line
def tick(B: Vector, S: Vector, t: float, target: float, q: float, v: float, supply: float) -> float:
    """Drive from time t on: V, N m, or the unit of the controller output.

    Args:
        target: known to the controller at t, rad. q, v: rad, rad/s. supply: relative to that of
            the block, 1 if it is not measured.
    """
    if B[MEASURED] == 1.0:
        return target
    first = S[STARTED] == 0.0
    dt = t - S[TICK]
    # times are sums of steps: a tick may be early by their rounding
    if not first and dt < B[PERIOD] - 1e-9:
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
        u = 0.0  # inside a band that cuts there is no output at any velocity
    asked = abs(u)
    if asked > B[LIMIT]:
        u = math.copysign(B[LIMIT], u)
        if B[KI] != 0.0:  # stops integral wind-up at the limit
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
