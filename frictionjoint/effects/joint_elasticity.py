"""joint-elasticity seen from the motor: the link oscillates on a spring behind the encoder."""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, pointer, room
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, N_SIGNALS, SAG, SWAY, TIME, A


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
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
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
        out[k] = torque(numbers, start, sig, X, start)


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


EFFECT = Effect(
    name="joint-elasticity",
    title="elastic gear or shaft",
    effect_id=20,
    kernel=torque,
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
