"""Effects that change the friction level: with load, direction, changes of speed, and rest.

A change reaches the torque by motion, not by time: the level limits the torque of a stuck contact;
it does not move the contact. While the joint is at rest the torque stays constant when the level
changes. When the joint moves, the torque follows the
level over the presliding distance. To first order in the change this is what LuGre's bristle does:
with dz/dx = 1 - sigma0 z/S, a level S + s adds the torque E with dE/d|x| = (s h - E) sigma0/S,
where h = sigma0 z/S.
"""

import math
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.effect import Effect, Shape
from frictionjoint.effects.signals import DT, GEAR, ONSET, SHARE, H, Q, V

# lengths over which a change of the level is reached, over the travel, where a fit starts
REACHES = (1e-4, 1e-3)


@compiled
def within_one(h: float) -> float:
    """Fh/Fc without its Stribeck part, within +-1."""
    return min(1.0, max(-1.0, h))


@compiled
def reached(
    start: float, level: float, h: float, reach: float, sig: Vector, X: Vector, x: int
) -> float:
    """Torque of a level s, approached over `reach` of motion (0: immediately).

    Along a log E approaches s h. In a simulation that E would lag behind h in each vibration and
    return more work than it takes: a joint at rest would creep. There a level above zero is a
    bristle of its own (Dahl, 1968), which only dissipates.

    Args:
        start: the level at the first sample. h: Fh/Fc, or within +-1. X[x]: E; X[x+1]: last
            position.
    """
    target, dq = level * h, sig[Q] - X[x + 1]
    if sig[ONSET] > 0.0 and level > 0.0:
        reach += sig[ONSET]
        sig[SHARE] = sig[ONSET] / reach
        target = level * max(1.0, abs(h))
        if dq < 0.0:
            target = -target
    if sig[DT] <= 0.0:
        X[x] = start * h
    elif reach > 0.0:
        X[x] = X[x] - (target - X[x]) * math.expm1(-abs(dq) / reach)
    elif dq != 0.0:
        X[x] = target
    X[x + 1] = sig[Q]
    return X[x]


def reaches(signals: Array) -> list[Shape]:
    """Initial lengths, relative to the travel of a log."""
    span = float(np.ptp(signals[:, Q]))
    return [(part * span,) for part in REACHES if span > 0.0]


@compiled
def load_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c |load| H, reached over `reach` of motion: the whole level grows, with its Stribeck part."""
    load = abs(sig[GEAR])
    return P[e + 1] * reached(load, load, sig[H], P[e], sig, X, x)


@compiled
def load_coulomb_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c |load| H1, reached over `reach` of motion; H1 = H within +-1."""
    load = abs(sig[GEAR])
    return P[e + 1] * reached(load, load, within_one(sig[H]), P[e], sig, X, x)


@compiled
def load_stribeck_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(c + cs exp(-|v|/vs)) |load| H1, reached over `reach` of motion; H1 = H within +-1."""
    level = abs(sig[GEAR]) * (P[e + 2] + P[e + 3] * math.exp(-abs(sig[V]) / P[e + 1]))
    return reached(level, level, within_one(sig[H]), P[e], sig, X, x)


def _reaches_and_falls(signals: Array) -> list[Shape]:
    fastest = float(np.quantile(np.abs(signals[:, V]), 0.99))
    lengths = reaches(signals) if fastest > 0.0 else []
    return [(length, part * fastest) for (length,) in lengths for part in (0.03, 0.15)]


LOAD_DEPENDENT = Effect(
    name="load-dependent",
    title="friction that grows with load",
    effect_id=7,
    kernel=load_torque,
    coefficients=("c",),
    units=("1",),
    cause="tooth and bearing friction proportional to the normal force of the transmitted torque",
    form="c |tau_load| Fh/Fc, reached over `reach` of motion",
    source="Bittencourt and Gunnarsson (2012); Duclusaud et al. (2024)",
    signature="odd in velocity, even in load",
    separating_motion="the same motion at two loads, or at two poses of different gravity torque",
    entry="scales the friction level",
    shape=("reach",),
    shape_units=("x",),
    shapes=reaches,
    needs=(GEAR,),
    of_size=True,
    bounds=((0.0, 2.0),),
    shape_bounds=((0.0, float("inf")),),
)

# only the Coulomb part grows
LOAD_COULOMB = replace(
    LOAD_DEPENDENT,
    effect_id=22,
    kernel=load_coulomb_torque,
    form="c |tau_load| Fh/Fc within +-1, reached over `reach` of motion",
    source="Bittencourt and Gunnarsson (2012); with Dahl's law the loss in MuJoCo's issue 3528",
)
# the Coulomb part and a separate Stribeck part grow
LOAD_STRIBECK = replace(
    LOAD_DEPENDENT,
    effect_id=25,
    kernel=load_stribeck_torque,
    coefficients=("c", "cs"),
    units=("1", "1"),
    form="(c + cs exp(-|v|/vs)) |tau_load| Fh/Fc within +-1, reached over `reach` of motion",
    source="Bittencourt and Gunnarsson (2012); Duclusaud et al. (2024), model M4",
    shape=("reach", "vs"),
    shape_units=("x", "x/s"),
    shapes=_reaches_and_falls,
    bounds=((0.0, 2.0), (0.0, 4.0)),
    shape_bounds=((0.0, float("inf")), (0.0, float("inf"))),
)
LOAD_FORMS = (LOAD_DEPENDENT, LOAD_COULOMB, LOAD_STRIBECK)


@compiled
def direction_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """(dF |H| + dsigma2 |v|): half the difference between the directions."""
    return P[e] * abs(sig[H]) + P[e + 1] * abs(sig[V])


@compiled
def direction_by_motion_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """dF sgn(v) H, reached over `reach` of motion, + dsigma2 |v|."""
    way = 1.0 if sig[V] >= 0.0 else -1.0
    return P[e + 1] * reached(way, way, sig[H], P[e], sig, X, x) + P[e + 2] * abs(sig[V])


DIRECTION_ASYMMETRY = Effect(
    name="direction-asymmetry",
    title="friction that differs with direction",
    effect_id=5,
    kernel=direction_torque,
    coefficients=("level", "viscous"),
    units=("T", "T s/x"),
    cause="gear tooth flanks, seals and preload that act differently in the two directions",
    form="dF |Fh/Fc| + dsigma2 |v|, half the difference between the directions",
    source="Ganseman et al. (1997), own parameters for each direction",
    signature="even in velocity, zero at rest before breakaway, grows with speed",
    separating_motion="both directions at two speeds, with stops in between",
    entry="scales the friction level",
)

# equal in sliding; after a reversal the difference does not follow the hysteresis torque through
# zero, but stays until the joint has moved to the level of the other direction
DIRECTION_BY_MOTION = replace(
    DIRECTION_ASYMMETRY,
    effect_id=23,
    kernel=direction_by_motion_torque,
    form="dF sgn(v) Fh/Fc, reached over `reach` of motion, + dsigma2 |v|",
    shape=("reach",),
    shape_units=("x",),
    shapes=reaches,
    shape_bounds=((0.0, float("inf")),),
)


@compiled
def lag_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c H1 (E delayed with the time constant tau - E), E = exp(-(v/Vs)^2), H1 = H within +-1.

    Only the level is delayed. At a reversal friction changes direction without delay.
    X[x] delayed E, X[x+1] torque per unit of c, X[x+2] last position.
    """
    ratio = sig[V] / P[e + 1]
    level = math.exp(-ratio * ratio)
    if sig[DT] <= 0.0:
        X[x] = level
    else:
        X[x] += (level - X[x]) * -math.expm1(-sig[DT] / P[e])
    return P[e + 3] * reached(0.0, X[x] - level, within_one(sig[H]), P[e + 2], sig, X, x + 1)


def _lags(signals: Array) -> list[Shape]:
    top = float(np.quantile(np.abs(signals[:, V]), 0.99))
    reach = 5e-4 * float(np.ptp(signals[:, Q]))
    taus, speeds = (0.01, 0.03, 0.08), (0.03, 0.08, 0.2)
    return [(tau, share * top, reach) for tau in taus for share in speeds if top > 0.0]


FRICTIONAL_LAG = Effect(
    name="frictional-lag",
    title="lag of the lubricant film",
    effect_id=17,
    kernel=lag_torque,
    coefficients=("level",),
    units=("T",),
    cause="the lubricant film takes time to build up or collapse",
    form="c Fh/Fc (E late by a first order with time constant tau - E), E = exp(-(v/Vs)^2), "
    "reached over `reach` of motion",
    source="Hess and Soom (1990)",
    signature="a loop in the torque-velocity plane at low speed that widens with frequency",
    separating_motion="unidirectional oscillating velocity near Vs at three frequencies",
    bounds=((0.0, float("inf")),),
    entry="scales the friction level",
    shape=("tau", "Vs", "reach"),
    shape_units=("s", "x/s", "x"),
    shapes=_lags,
    shape_bounds=((0.005, 1.0), (0.0, float("inf")), (0.0, float("inf"))),
)


@compiled
def dwell_torque(P: Vector, e: int, sig: Vector, X: Vector, x: int) -> float:
    """c times the fraction r of the contact that has aged, reached over `reach` of motion.

    dr/dt = (1 - r)/tau - |v| r/slip: rest ages the contact, sliding renews it.
    X[x] r, X[x+1] torque per unit of c, X[x+2] last position.
    """
    h = sig[DT]
    if h <= 0.0:
        X[x] = 1.0  # the joint has been at rest for long before the log
    else:
        rate = 1.0 / P[e] + abs(sig[V]) / P[e + 1]
        steady = 1.0 / (P[e] * rate)
        X[x] = steady + (X[x] - steady) * math.exp(-rate * h)
    return P[e + 3] * reached(0.0, X[x], sig[H], P[e + 2], sig, X, x + 1)


def _rests(signals: Array) -> list[Shape]:
    span = float(np.ptp(signals[:, Q]))
    slips = (1e-4, 5e-4, 2e-3, 8e-3)  # over the travel
    return [(tau, x * span, 0.1 * x * span) for tau in (0.2, 1.0) for x in slips]


DWELL_TIME = Effect(
    name="dwell-time",
    title="stiction that grows at rest",
    effect_id=18,
    kernel=dwell_torque,
    coefficients=("level",),
    units=("T",),
    cause="contact creep and lubricant squeezed out at rest",
    form="c r Fh/Fc, reached over `reach` of motion; dr/dt = (1 - r)/tau - |v| r/slip",
    source="Rabinowicz (1958); Dieterich (1979), ageing that saturates",
    signature="only the first breakaway after a rest, larger after longer rests",
    separating_motion="the same start after rests of 1, 10 and 100 s",
    entry="scales the friction level",
    shape=("tau", "slip", "reach"),
    shape_units=("s", "x", "x"),
    shapes=_rests,
    bounds=((0.0, float("inf")),),
    shape_bounds=((0.1, float("inf")), (0.0, float("inf")), (0.0, float("inf"))),
)
