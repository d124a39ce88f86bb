"""backlash: the link is driven through a gap, encoder on the motor.

`share`, the part of the link's torque that passes through the gap, is 1. If hard flanks bounce for
long, the motor's motion does not determine every impact, and a fit finds softer flanks that bounce
less. `rotor_inertia` is inertia that the model counts to the link but that turns with the motor.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector, root_mean_square
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, GEAR, SWAY, TIME, A, inertia_of

# fraction of a step that counts as zero
_NEAR = 1e-6


@compiled
def _step(p: float, rate: float, half: float, longest: float) -> float:
    """Length of a step: up to where the link meets or leaves a flank, at most the longest."""
    if rate == 0.0:
        return longest
    along = p if rate > 0.0 else -p
    edge = -half if along < -half else half
    step = (edge - along) / abs(rate)
    return step if _NEAR * longest < step < longest else longest


@compiled
def _pushed(p: float, half: float, w: float) -> float:
    """Spring force of the flank at p, without damping; 0 in the gap."""
    if abs(p) <= half:
        return 0.0
    return -w * w * (p - half if p > 0.0 else p + half)


@compiled
def _at_rest(rigid: float, sway: float, half: float, w: float) -> float:
    """Position of the link at rest: hanging in the gap, or supported by a flank.

    Without gravity it may be anywhere in the gap; the middle is then the best guess.
    """
    if sway == 0.0:
        return 0.0
    if abs(rigid) < sway * half:
        return -rigid / sway
    return (-half if rigid >= 0.0 else half) - rigid / (w * w)


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """Torque that the flanks transmit minus the torque that a rigid gear would transmit.

    With p = J (q_link - q_motor), small: p'' = T - T_rigid - sway p, because gravity acts at the
    link's position, and T = -w^2 (p beyond the gap) - 2 zeta w p' while the flanks touch. Gap and
    p are scaled by the link's inertia J, so J need not be known. A step is half a step of p, one
    of p', half a step of p, and ends where the link meets a flank: T jumps there, and a late
    contact would change the bounce. X[x] p, X[x+1] p', X[x+2] last T_rigid.
    """
    half, w, zeta = 0.5 * P[e], 2.0 * math.pi * P[e + 1], P[e + 2]
    rigid, sway = sig[GEAR] - P[e + 3] * sig[A], sig[SWAY]
    h = sig[DT]
    if h <= 0.0:
        X[x] = _at_rest(rigid, sway, half, w)
        X[x + 1] = 0.0
        X[x + 2] = rigid
        return 0.0
    p, rate, last = X[x], X[x + 1], X[x + 2]
    # at most a quarter of the period of the flanks' resonance over 2 pi
    longest = h / float(1 + int(h * w / 0.25))
    left, impulse = h, 0.0
    while left > _NEAR * h:
        dt = _step(p, rate, half, min(longest, left))
        p += 0.5 * dt * rate
        of_rigid = rigid - (rigid - last) * (left - 0.5 * dt) / h
        asked = of_rigid + sway * p
        push = _pushed(p, half, w)
        free = rate - dt * asked
        brake = zeta * w * dt
        rate = ((1.0 - brake) * rate + dt * (push - asked)) / (1.0 + brake) if push != 0.0 else free
        if (rate - free) * p > 0.0:  # flanks only push
            rate = free
        impulse += rate - free - dt * of_rigid
        p += 0.5 * dt * rate
        left -= dt
    X[x] = p
    X[x + 1] = rate
    X[x + 2] = rigid
    return P[e + 4] * impulse / h


def _gaps(signals: Array) -> list[Shape]:
    """Gaps that take ten to a hundred milliseconds to cross under the usual torque.

    The flanks start soft and well damped: the link's motion is computed from the motor's motion,
    and with hard flanks a small error in the time of an impact changes all later bounces.
    """
    usual = root_mean_square(signals[:, GEAR])
    nyquist = 0.5 / float(np.median(np.diff(signals[:, TIME])))
    flanks = [f for f in (8.0, 16.0) if f < 0.5 * nyquist]
    inertia = inertia_of(signals, GEAR)
    return [
        (0.5 * usual * t * t, f, 0.45, part * inertia)
        for t in (0.01 * 1.3**k for k in range(10))
        for f in flanks
        for part in (0.0, 0.3)
    ]


EFFECT = Effect(
    name="backlash",
    effect_id=19,
    kernel=torque,
    coefficients=("share",),
    units=("1",),
    cause="play between gear teeth",
    form="torque of a link driven through a gap with springy flanks, less that of a rigid gear",
    source="Nordin and Gutman (2002), dead-zone model",
    signature="no torque for some milliseconds after the transmitted torque changes sign, then "
    "an impact",
    separating_motion="slow motion in both directions through positions where gravity changes sign",
    shape=("gap_times_inertia", "flank_resonance", "damping_ratio", "rotor_inertia"),
    shape_units=("T s^2", "Hz", "1", "T s^2/x"),
    shapes=_gaps,
    needs=(GEAR, A),
    bounds=((0.0, 1.5),),
    shape_bounds=((0.0, float("inf")), (0.5, float("inf")), (0.02, 1.0), (0.0, float("inf"))),
    of_load=True,
    # flanks without play are an elastic gear, however well determined
    vanishes=("gap_times_inertia", 0.0),
    leaps=True,
    acts="mechanism",
)
