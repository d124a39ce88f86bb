"""warm-up-drift: level and viscosity that fall as the joint warms; the temperature is not measured.

Three forms: they relax in time, with the warmth that sliding leaves, or with the warmth that the
whole loss leaves, viscous friction included. Over a log a small warmth is next to linear, and then
its scale cannot be told from the coefficients: in the last form it is a reference.
"""

import math
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, LOAD, MOTOR, TIME, H, V

# s; oil, grease and the metal around them do not warm faster. A shorter memory comes from the
# motion, not from heat.
_FASTEST = 5.0


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """exp(-(t + X[x])/tau) (a Fh/Fc + b v); X[x] earlier operation, s, 0 in a log."""
    return math.exp(-(sig[TIME] + X[x]) / P[e]) * (P[e + 1] * sig[H] + P[e + 2] * sig[V])


@compiled
def warmth(before: float, h: float, v: float, dt: float, tau: float, ratio: float) -> float:
    """Heat from friction that has not yet dissipated: dw/dt = |v| (|h| + ratio |v|) - w/tau."""
    steady = (abs(h * v) + ratio * v * v) * tau
    return steady + (before - steady) * math.exp(-dt / tau)


@compiled
def warmed_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """exp(-w/scale) (a Fh/Fc + b v); X[x] the warmth w, 0 in a log at its start."""
    if sig[DT] > 0.0:
        X[x] = warmth(X[x], sig[H], sig[V], sig[DT], P[e], 0.0)
    return math.exp(-X[x] / P[e + 1]) * (P[e + 2] * sig[H] + P[e + 3] * sig[V])


@compiled
def heated_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """exp(-w/scale) (a Fh/Fc + b v); X[x] the warmth w by the whole loss, 0 as a log starts."""
    if sig[DT] > 0.0:
        X[x] = warmth(X[x], sig[H], sig[V], sig[DT], P[e + 2], P[e + 1])
    return math.exp(-X[x] / P[e]) * (P[e + 3] * sig[H] + P[e + 4] * sig[V])


def _time_constants(signals: Array) -> list[Shape]:
    duration = float(np.ptp(signals[:, TIME]))
    times = {max(_FASTEST, duration * part) for part in (0.1, 0.3, 1.0, 3.0)}
    return [(tau,) for tau in sorted(times)]


@compiled
def _warmest(signals: Array, tau: float, ratio: float) -> float:
    """Largest w of `warmed_torque`, or of `heated_torque`."""
    w, most = 0.0, 0.0
    for k in range(len(signals)):
        dt = signals[k, DT]
        w = warmth(w, signals[k, H], signals[k, V], dt, tau, ratio) if dt > 0.0 else 0.0
        most = max(most, w)
    return most


def _warmths(signals: Array, ratio: float) -> list[tuple[float, float]]:
    """Time constants, each with the largest w, where the joint warms at all."""
    pairs = [(tau, _warmest(signals, tau, ratio)) for (tau,) in _time_constants(signals)]
    return [(tau, w) for tau, w in pairs if w > 0.0]


def _warmths_by_loss(signals: Array) -> list[Shape]:
    # a scale of the largest warmth is next to linear, a smaller one levels off
    return [(tau, part * w) for tau, w in _warmths(signals, 0.0) for part in (0.3, 1.0)]


def _warmths_by_whole_loss(signals: Array) -> list[Shape]:
    # the law's friction, which MOTOR contains, is Fc H + sigma2 V
    friction = signals[:, MOTOR] - signals[:, LOAD]
    Fc, sigma2 = np.linalg.lstsq(signals[:, [H, V]], friction, rcond=None)[0].tolist()
    ratio = max(0.0, sigma2 / Fc) if Fc > 0.0 else 0.0
    return [(part * w, ratio, tau) for tau, w in _warmths(signals, ratio) for part in (1.0, 3.0)]


EFFECT = Effect(
    name="warm-up-drift",
    title="warm-up",
    effect_id=9,
    kernel=torque,
    coefficients=("level", "viscous"),
    units=("T", "T s/x"),
    cause="losses warm the lubricant while the joint works",
    form="exp(-t/tau) (a Fh/Fc + b v), t from the start of the log",
    source="Bittencourt and Gunnarsson (2012), thermal model of first order",
    signature="same motion, friction that changes slowly with time",
    separating_motion="the same motion repeated for several time constants, with a long pause",
    entry="scales the friction level",
    slow=True,
    decays_over="tau",
    shape=("tau",),
    shape_units=("s",),
    shapes=_time_constants,
    shape_bounds=((_FASTEST, float("inf")),),
)

BY_LOSS = replace(
    EFFECT,
    effect_id=21,
    kernel=warmed_torque,
    form="exp(-w/scale) (a Fh/Fc + b v), dw/dt = |v Fh|/Fc - w/tau, cold at the start of the log",
    source="Bittencourt and Gunnarsson (2012), heated by the friction's own loss",
    signature="same motion, friction that changes slowly with the work done before",
    shape=("tau", "scale"),
    decays_over="scale",
    shape_units=("s", "x"),
    shapes=_warmths_by_loss,
    shape_bounds=((_FASTEST, float("inf")), (0.0, float("inf"))),
)

BY_WHOLE_LOSS = replace(
    BY_LOSS,
    effect_id=33,
    kernel=heated_torque,
    form="exp(-w/scale) (a Fh/Fc + b v), dw/dt = |v| (|Fh|/Fc + ratio |v|) - w/tau, cold at the "
    "start of the log",
    shape=("scale", "ratio", "tau"),
    shape_units=("x", "s/x", "s"),
    shape_fixed=2,
    shapes=_warmths_by_whole_loss,
    shape_bounds=((0.0, float("inf")), (0.0, float("inf")), (_FASTEST, float("inf"))),
)
FORMS = (EFFECT, BY_LOSS, BY_WHOLE_LOSS)
