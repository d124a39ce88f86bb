"""Initial friction state of each log: unmeasured, hence estimated.

A joint at rest under a load holds it by a presliding torque that depends on the motion before the
log. A law that starts at zero is wrong until the joint has slid, unless the torque at the first
sample is free. The link of an elastic joint may oscillate until its damping stops it. Both are
properties of the log, like its first position, so they are estimated for predicted logs too.
"""

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from frictionjoint.arrays import Array, Index
from frictionjoint.identify.basis import lengths
from frictionjoint.identify.design import Balance
from frictionjoint.identify.fit import IN_MOTION, Fit
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import Term, swing_columns
from frictionjoint.measured.lowpass import REACH
from frictionjoint.threads import side_by_side

# trial torques at the first sample over Fc
_TRIALS = np.linspace(-1.5, 1.5, 7)
# fraction of a log's squares that another start must take away
_TELLS = 0.01


def with_starts(prepared: Prepared, fitted: Fit) -> Prepared:
    """The logs with initial states that minimise a fit's residual; `prepared` if none is better."""
    begun = []
    for i, held in enumerate(_starts(prepared, fitted)):
        own = prepared.segments[i]
        segment = own if held == own.held else replace(own, held=held)
        swing = _swing(replace(prepared, segments=(segment,)), fitted)
        begun.append(segment if swing == own.swing else replace(segment, swing=swing))
    if all(a is b for a, b in zip(begun, prepared.segments, strict=True)):
        return prepared
    return prepared.begun(begun)


def settled(prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
    """A fit and the initial friction states of its logs, estimated alternately."""
    for _ in range(2):
        begun = with_starts(prepared, fitted)
        if begun is prepared:
            break
        prepared, fitted = begun, refit(begun, fitted.terms, fitted.shape, ROUGH)
    return prepared, fitted


def _starts(prepared: Prepared, fitted: Fit) -> list[float]:
    """Torque over Fc at the first sample of each log."""
    heads = replace(prepared, segments=_heads(prepared, fitted.shape))
    known = np.array([s.held for s in heads.segments])
    whole = [_squares(x) for x in prepared.by_log(_left(prepared, fitted))]
    left, before = _left(heads, fitted), _of_law(heads, fitted, known)

    def squares(held: Array) -> Array:
        # all but the law and what follows it stays as it is
        left_of_each = heads.by_log(left - (_of_law(heads, fitted, held) - before))
        return np.array([_squares(x) for x in left_of_each])

    tried = np.array([squares(np.full(len(heads), x)) for x in _TRIALS])
    own, best = squares(known), _TRIALS[np.argmin(tried, axis=0)]

    def start(i: int) -> float:
        """Of one log."""
        one, step = heads.subset([i]), _TRIALS[1] - _TRIALS[0]
        mine, its = heads.by_log(left)[i], heads.by_log(before)[i]
        found = minimize_scalar(
            lambda held: _squares(mine - (_of_law(one, fitted, np.array([held])) - its)),
            bounds=(best[i] - step, best[i] + step),
            method="bounded",
            options={"xatol": 0.01},
        )
        return float(found.x) if own[i] - found.fun > _TELLS * whole[i] else float(known[i])

    with side_by_side() as each:
        return list(each(start, range(len(heads))))


def _swing(one: Prepared, fitted: Fit) -> tuple[float, float]:
    """First deflection of an elastic joint in a log, and its rate; the residual is linear in it."""
    (segment,) = one.segments
    at = [i for i, t in enumerate(fitted.terms) if t.effect.free]
    inertia = float(fitted.term_coefficients(at[0])[0]) / fitted.gain if at else 0.0
    if inertia == 0.0:
        return segment.swing
    left = _left(one, fitted)
    free, sizes = swing_columns(segment, fitted.terms[at[0]])
    C = inertia * free
    change = np.linalg.lstsq(C, left, rcond=None)[0]
    if _squares(left) - _squares(left - C @ change) <= _TELLS * _squares(left):
        return segment.swing
    d, rate = np.array(segment.swing) + sizes * change
    return float(d), float(rate)


def swinging(prepared: Prepared, fitted: Fit, term: Term, columns: Array, free: Array) -> Prepared:
    """The logs with the free oscillations that a term, not part of the fit, would have if it were
    added; its columns, shape (n, 1), and its `swings_of`, shape (n, 2 k), are given."""
    X = np.column_stack([columns, free]) * fitted.weight[:, None]
    size = lengths(X)
    e = fitted.residual * fitted.weight
    # smaller singular values are rounding
    found = np.linalg.lstsq(X / size, e, rcond=1e-6)[0] / size
    if found[0] <= 0.0:
        return prepared
    logs = []
    for segment, share in zip(prepared.segments, found[1:].reshape(-1, 2) / found[0], strict=True):
        d, rate = swing_columns(segment, term)[1] * share
        logs.append(replace(segment, swing=(float(d), float(rate))))
    return replace(prepared, segments=tuple(logs))


def _left(one: Prepared, fitted: Fit) -> Array:
    """Residual of a fit on a log, in units of the drive."""
    balance = Balance(one, fitted.shape, fitted.terms)
    X, y = balance.columns(fitted.shape, fitted.terms, fitted.beta)
    return np.asarray(y - X @ fitted.beta)


def _of_law(prepared: Prepared, fitted: Fit, held: Array) -> Array:
    """Torque that depends on the law, given the torque over Fc at the first sample of each log."""
    balance = Balance(prepared, fitted.shape, fitted.terms)
    return balance.of_law(fitted.shape, fitted.terms, fitted.beta, held)


def _squares(x: Array) -> float:
    return float(np.sum(x**2))


def _heads(prepared: Prepared, shape: Shape) -> tuple[Segment, ...]:
    """The first parts of logs, until the law has become independent of its initial state."""
    whole = prepared.whole
    sides = [np.full(len(prepared), x) for x in _TRIALS[[0, -1]]]
    first, last = (whole.tracks.begun(held).along(shape)[0] for held in sides)
    apart = np.abs(last - first) > 1e-3
    return tuple(
        _head(s, np.flatnonzero(apart[own]))
        for s, own in zip(whole.logs, whole.places, strict=True)
    )


def _head(segment: Segment, apart: Index) -> Segment:
    """The first part of a log, with the samples at which the law depends on its initial state."""
    reach = int(REACH / (segment.bandwidth_hz * segment.dt)) + 1
    end = int(apart[-1]) + reach if apart.size else reach
    if end + reach >= len(segment.drive):
        return replace(segment, driven_along=segment.path)
    mask = segment.mask[: end + reach].copy()
    mask[end:] = False  # the filter's edge
    return replace(segment.each(lambda x: x[: end + reach]), mask=mask)


class Prediction(NamedTuple):
    """Torques on the kept samples of each log, N m: measured, with the gain of the fit if the
    drive's is unknown, predicted by the fit, and the law's part of that; and the weights."""

    measured: list[Array]
    predicted: list[Array]
    friction: list[Array]
    weight: list[Array]

    @property
    def error(self) -> Array:
        """Measured minus predicted, all logs concatenated, shape (n,)."""
        return np.concatenate(self.measured) - np.concatenate(self.predicted)

    @property
    def in_motion(self) -> NDArray[np.bool_]:
        """Samples whose torque the position determines, shape (n,); all if there are none."""
        found = np.asarray(np.concatenate(self.weight) ** 2 > IN_MOTION)
        return found if found.any() else ~found


@lru_cache(maxsize=8)
def predict(prepared: Prepared, fitted: Fit) -> Prediction:
    """Prediction of a fit for logs, without refitting; their initial states are estimated."""
    # the model's columns are those of the logs it was fitted to, powered off in parts or not
    like = replace(prepared, motor_off=prepared.voltage_driven and "sigma2" in fitted.names)
    begun = with_starts(like, fitted)
    balance = Balance(begun, fitted.shape, fitted.terms)
    X, y = balance.columns(fitted.shape, fitted.terms, fitted.beta)
    known = 0.0 if begun.gain_unknown else begun.balanced_load
    torques = (
        y * fitted.gain + known,
        X @ fitted.beta * fitted.gain + known,
        X[:, fitted.of_law] @ fitted.beta[fitted.of_law] * fitted.gain,
        begun.weight,
    )
    return Prediction(*(begun.by_log(x) for x in torques))
