"""Effects between motor and link, encoder on the motor: backlash, and an elastic gear or shaft.

Backlash: the link is driven through a gap. `share`, the part of the link's torque that passes
through the gap, is 1. If hard flanks bounce for long, the motor's motion does not determine every
impact, and a fit finds softer flanks that bounce less. `rotor_inertia` is inertia that the model
counts to the link but that turns with the motor.

Elasticity: the link oscillates on a spring behind the encoder.
"""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector, root_mean_square
from frictionjoint.compiled import compiled, pointer, room
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, GEAR, N_SIGNALS, SAG, SWAY, TIME, A, inertia_of

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
def gap_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
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


BACKLASH = Effect(
    name="backlash",
    effect_id=19,
    kernel=gap_torque,
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


@compiled
def _half_angle(w: float, h: float) -> float:
    """Phase of the resonance in half a sample, rad."""
    # 1.3 rad, half a phase: faster resonances are treated as equal
    return min(0.5 * w * h, 1.3)


@compiled
def _steeper(w: float, h: float) -> float:
    """Factor on the frequency so that the trapezoidal rule resonates at w."""
    angle = _half_angle(w, h)
    return angle / (math.sin(angle) * math.cos(angle)) if angle > 0.0 else 1.0


@compiled
def elastic_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """Torque that the spring transmits minus the torque that a rigid gear would transmit.

    With d = q_link - q_motor, small: d'' + 2 zeta w d' + w^2 d + sway d = -(a_motor + sag), because
    gravity acts at the link's position. The trapezoidal rule adds no damping, but it would
    resonate below w by a factor of (w h)^2/12, 2% at 20 Hz and 4 ms. With a step longer by tan(w
    h/2)/(w h/2) it resonates at w, and with J, zeta and sway larger by w h/sin(w h) with the right
    width and height. X[x] d over that factor, X[x+1] its rate, X[x+2] the last a_motor + sag.
    """
    w = 2.0 * math.pi * P[e]
    h = sig[DT]
    asked = sig[A] + sig[SAG]
    # gravity leaves a tenth of the stiffness at least: a hanging link does not fall
    softest = 0.1 * w * w
    if h <= 0.0:
        # deflected by its weight, at rest
        X[x] = -sig[SAG] / max(w * w + sig[SWAY], softest)
        X[x + 1] = 0.0
        X[x + 2] = asked
        return -P[e + 2] * (sig[SAG] + w * w * X[x])
    steeper = _steeper(w, h)
    damping = 2.0 * P[e + 1] * w * steeper
    stiffness = max(w * w + steeper * sig[SWAY], softest)
    h = 2.0 / w * math.tan(_half_angle(w, h))
    old = X[x + 1]
    rate = old * (1.0 - 0.5 * h * damping - 0.25 * h * h * stiffness)
    rate -= h * stiffness * X[x] + 0.5 * h * (X[x + 2] + asked)
    rate /= 1.0 + 0.5 * h * damping + 0.25 * h * h * stiffness
    X[x] += 0.5 * h * (old + rate)
    X[x + 1] = rate
    X[x + 2] = asked
    return -P[e + 2] * steeper * (asked + w * w * X[x] + damping * rate)


@compiled
def _free(P: Vector, d: float, rate: float, signals: Array, out: Vector) -> None:
    numbers, start = pointer(P, 0), 0
    sig, X = room(N_SIGNALS), room(3)
    w = 2.0 * math.pi * P[0]
    steeper = _steeper(w, signals[min(1, len(out) - 1), DT])
    X[0], X[1] = d / steeper, rate / steeper
    out[0] = -P[2] * (w * w * d + 2.0 * P[1] * w * rate)
    for k in range(1, len(out)):
        sig[DT], sig[SWAY] = signals[k, DT], signals[k, SWAY]
        out[k] = elastic_torque(numbers, start, sig, X, start)


def free_swing(shape: Shape, start: tuple[float, float], signals: Array) -> Array:
    """Torque per unit of J of a link that oscillates when a log begins, shape (n,).

    Args:
        shape: resonance, damping ratio. start: d, x, and d', x/s, at the first sample and
            as driven by the motor's motion. signals: shape (n, N_SIGNALS).
    """
    out = np.empty(len(signals))
    _free(np.array([*shape, 1.0]), *start, signals, out)
    return out


def _resonances(signals: Array) -> list[Shape]:
    nyquist = 0.5 / float(np.median(np.diff(signals[:, TIME])))
    frequencies = 2.0 * 1.35 ** np.arange(10)
    return [(float(f), zeta) for f in frequencies if f < 0.5 * nyquist for zeta in (0.03, 0.15)]


JOINT_ELASTICITY = Effect(
    name="joint-elasticity",
    title="elastic gear or shaft",
    effect_id=20,
    kernel=elastic_torque,
    coefficients=("link_inertia",),
    units=("T s^2/x",),
    cause="compliant gear or shaft between motor and link, encoder on the motor",
    form="what a spring transmits to a hanging link of inertia J, less what a rigid gear would",
    source="Spong (1987), two-mass model solved for the link",
    signature="a resonance of the torque at one frequency, at any amplitude",
    separating_motion="fast motion with frequencies around the resonance, 3 to 30 Hz",
    shape=("resonance", "damping_ratio"),
    shape_units=("Hz", "1"),
    shapes=_resonances,
    needs=(A,),
    # the link is part of the joint's inertia
    bounds=((0.0, 1.0),),
    # gears and shafts are lightly damped; stronger damping means another effect, such as backlash
    shape_bounds=((0.5, float("inf")), (0.005, 0.2)),
    of_inertia=True,
    acts="mechanism",
    free=free_swing,
)
