"""warm-up-drift: level and viscosity that relax in time; the temperature is not measured."""

import math
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, TIME, H, V

# s; oil, grease and the metal around them do not warm faster. A shorter memory comes from the
# motion, not from heat.
_FASTEST = 5.0


@compiled
def torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """exp(-(t + X[x])/tau) (a Fh/Fc + b v); X[x] earlier operation, s, 0 in a log."""
    return math.exp(-(sig[TIME] + X[x]) / P[e]) * (P[e + 1] * sig[H] + P[e + 2] * sig[V])


@compiled
def warmth(before: float, h: float, v: float, dt: float, tau: float) -> float:
    """Heat from friction that has not yet dissipated: dw/dt = |h v| - w/tau."""
    steady = abs(h * v) * tau
    return steady + (before - steady) * math.exp(-dt / tau)


@compiled
def warmed_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """exp(-w/scale) (a Fh/Fc + b v); X[x] the warmth w, 0 in a log at its start."""
    if sig[DT] > 0.0:
        X[x] = warmth(X[x], sig[H], sig[V], sig[DT], P[e])
    return math.exp(-X[x] / P[e + 1]) * (P[e + 2] * sig[H] + P[e + 3] * sig[V])


def _time_constants(signals: Array) -> list[Shape]:
    duration = float(np.ptp(signals[:, TIME]))
    times = {max(_FASTEST, duration * part) for part in (0.1, 0.3, 1.0, 3.0)}
    return [(tau,) for tau in sorted(times)]


@compiled
def _warmest(signals: Array, tau: float) -> float:
    """Largest w of `warmed_torque`."""
    w, most = 0.0, 0.0
    for k in range(len(signals)):
        dt = signals[k, DT]
        w = warmth(w, signals[k, H], signals[k, V], dt, tau) if dt > 0.0 else 0.0
        most = max(most, w)
    return most


def _time_constants_and_warmths(signals: Array) -> list[Shape]:
    taus = [tau for (tau,) in _time_constants(signals)]
    most = [_warmest(signals, tau) for tau in taus]
    pairs = [(t, w) for t, w in zip(taus, most, strict=True) if w > 0.0]
    # a scale of the largest warmth is next to linear, a smaller one levels off
    return [(t, part * w) for t, w in pairs for part in (0.3, 1.0)]


EFFECT = Effect(
    name="warm-up-drift",
    title="warm-up",
    effect_id=9,
    coefficients=("level", "viscous"),
    units=("T", "T s/x"),
    cause="losses warm the lubricant while the joint works",
    form="exp(-t/tau) (a Fh/Fc + b v), t from the start of the log",
    source="Bittencourt and Gunnarsson (2012), thermal model of first order",
    signature="same motion, friction that changes slowly with time",
    separating_motion="the same motion repeated for several time constants, with a long pause",
    entry="scales the friction level",
    slow=True,
    shape=("tau",),
    shape_units=("s",),
    shapes=_time_constants,
    shape_bounds=((_FASTEST, float("inf")),),
)

BY_LOSS = replace(
    EFFECT,
    effect_id=21,
    form="exp(-w/scale) (a Fh/Fc + b v), dw/dt = |v Fh|/Fc - w/tau, cold at the start of the log",
    source="Bittencourt and Gunnarsson (2012), heated by the friction's own loss",
    signature="same motion, friction that changes slowly with the work done before",
    shape=("tau", "scale"),
    shape_units=("s", "x"),
    shapes=_time_constants_and_warmths,
    shape_bounds=((_FASTEST, float("inf")), (0.0, float("inf"))),
)
