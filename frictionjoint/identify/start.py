"""Initial friction state of each log: unmeasured, hence estimated.

A joint at rest under a load holds it by a presliding torque that came of the motion before the
log. A law that begins at zero is wrong until the joint has slid; with the torque of the first
sample free, it is not. The link of an elastic joint may swing, for as long as its damping lets it.
Both belong to the log as its first position does, so of a log that is only predicted they are
estimated too.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from frictionjoint.arrays import Array
from frictionjoint.identify.design import Balance, law_track, lengths, load_torque
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.reversals import path_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.swing import swing_columns, swings
from frictionjoint.identify.terms import Term
from frictionjoint.threads import side_by_side

# squared weight from which on a sample counts as in motion
IN_MOTION = 0.5
# trial torques at the first sample over Fc, and how near to the best one is near enough
_TRIALS, _NEAR = np.linspace(-1.5, 1.5, 7), 0.01
# fraction of a log's squares that another start must take away
_TELLS = 0.01
# H of two starts that have become the same, and how far the filter reaches, in periods of its
# corner
_ALIKE, _REACH = 1e-3, 2.0
_PASSES = 2
# singular values below this fraction of the largest hold nothing
_DEPENDENT = 1e-6


def with_starts(prepared: Prepared, fitted: Fit) -> Prepared:
    """The logs with the states at their first samples that leave a fit least.

    Returns:
        `prepared` itself where no log determines a better start than it has.
    """
    with side_by_side() as each:
        begun = list(each(lambda i: _begun(prepared.subset([i]), fitted), range(len(prepared))))
    if all(a is b for a, b in zip(begun, prepared.segments, strict=True)):
        return prepared
    return replace(prepared, segments=tuple(begun))


def _begun(one: Prepared, fitted: Fit) -> Segment:
    """A log with its start; the log itself where it determines no better one than it has."""
    (own,) = one.segments
    held = _start(one, fitted)
    segment = own if held == own.held else replace(own, held=held)
    swing = _swing(replace(one, segments=(segment,)), fitted)
    return segment if swing == own.swing else replace(segment, swing=swing)


def settled(prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
    """A fit and the initial friction state of its logs, each estimated with the other."""
    for _ in range(_PASSES):
        begun = with_starts(prepared, fitted)
        if begun is prepared:
            break
        prepared, fitted = begun, refit(begun, fitted.terms, fitted.shape, ROUGH)
    return prepared, fitted


def _start(one: Prepared, fitted: Fit) -> float:
    """Torque over Fc at the first sample of a log."""
    whole = _squares(_left(one, fitted))
    head = replace(one, segments=(_head(one.segments[0], fitted.shape),))
    left, before = _left(head, fitted), _of_law(head, fitted)

    def squares(held: float) -> float:
        # all but the law and what follows it stays as it is
        return _squares(left - (_of_law(_held(head, held), fitted) - before))

    tried = [squares(held) for held in _TRIALS]
    best = _TRIALS[int(np.argmin(tried))]
    step = _TRIALS[1] - _TRIALS[0]
    near = (best - step, best + step)
    found = minimize_scalar(squares, bounds=near, method="bounded", options={"xatol": _NEAR})
    own = one.segments[0].held
    return float(found.x) if squares(own) - found.fun > _TELLS * whole else own


def _swing(one: Prepared, fitted: Fit) -> tuple[float, float]:
    """Deflection of an elastic joint at the first sample of a log, and its rate.

    What is left of the log is linear in both.
    """
    (segment,) = one.segments
    at = [i for i, t in enumerate(fitted.terms) if swings(t)]
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
    """The logs with the swings that a term would find in them if it came in.

    Args:
        term: not of the fit. columns: of the term, shape (n, 1). free: its `swing_columns`, two
            for each log, shape (n, 2 k).
    """
    X = np.column_stack([columns, free]) * fitted.weight[:, None]
    size = lengths(X)
    e = fitted.residual * fitted.weight
    found = np.linalg.lstsq(X / size, e, rcond=_DEPENDENT)[0] / size
    if found[0] <= 0.0:
        return prepared
    logs = []
    for segment, share in zip(prepared.segments, found[1:].reshape(-1, 2) / found[0], strict=True):
        d, rate = swing_columns(segment, term)[1] * share
        logs.append(replace(segment, swing=(float(d), float(rate))))
    return replace(prepared, segments=tuple(logs))


def _left(one: Prepared, fitted: Fit) -> Array:
    """What a fit leaves of a log, in units of the drive."""
    balance = Balance(one, fitted.shape, fitted.terms)
    X, y = balance.columns(fitted.shape, fitted.terms, fitted.beta)
    return np.asarray(y - X @ fitted.beta)


def _of_law(one: Prepared, fitted: Fit) -> Array:
    """What depends on the law in a log, in units of the drive."""
    balance = Balance(one, fitted.shape, fitted.terms)
    return balance.of_law(fitted.shape, fitted.terms, fitted.beta, 0)


def _squares(x: Array) -> float:
    return float(np.sum(x**2))


def _held(one: Prepared, held: float) -> Prepared:
    return replace(one, segments=(replace(one.segments[0], held=float(held)),))


def _head(segment: Segment, shape: Shape) -> Segment:
    """A log as far as its start matters: until the law from either side has become the same."""
    first, last = (law_track(replace(segment, held=h), shape)[:, 0] for h in _TRIALS[[0, -1]])
    apart = np.flatnonzero(np.abs(last - first) > _ALIKE)
    reach = int(_REACH / (segment.bandwidth_hz * segment.dt)) + 1
    end = int(apart[-1]) + reach if apart.size else reach
    if end + reach >= len(segment.drive):
        return replace(segment, driven_along=segment.path)
    mask = segment.mask[: end + reach].copy()
    mask[end:] = False  # the filter's edge
    signals = segment.signals[: end + reach]
    return replace(
        segment,
        signals=signals,
        driven_along=path_of(signals, segment.noise.resolution),
        drive=segment.drive[: end + reach],
        driven=segment.driven[: end + reach],
        mask=mask,
        others={name: x[: end + reach] for name, x in segment.others.items()},
        unknown=None if segment.unknown is None else segment.unknown[: end + reach],
    )


class Prediction(NamedTuple):
    """Torques on the kept samples of each log, N m.

    Attributes:
        measured: by the gain of the fit where the drive's is not known. predicted: by the fit.
        friction: of the law alone, a part of what is predicted.
        weight: of each sample, as the logs have it.
    """

    measured: list[Array]
    predicted: list[Array]
    friction: list[Array]
    weight: list[Array]

    @property
    def error(self) -> Array:
        """Measured less predicted, log after log, shape (n,)."""
        return np.concatenate(self.measured) - np.concatenate(self.predicted)

    @property
    def in_motion(self) -> NDArray[np.bool_]:
        """The samples whose torque the position determines, shape (n,); all, if that are none."""
        found = np.asarray(np.concatenate(self.weight) ** 2 > IN_MOTION)
        return found if found.any() else ~found


def predict(prepared: Prepared, fitted: Fit) -> Prediction:
    """Prediction of a fit for logs, without refitting; their initial states are estimated."""
    found = Prediction([], [], [], [])
    law = [fitted.names.index(n) for n in ("Fc", "sigma1", "sigma2") if n in fitted.names]
    # the model's columns are those of the logs it was fitted to, let go or not
    like = replace(prepared, let_go=prepared.voltage_driven and "sigma2" in fitted.names)
    begun = with_starts(like, fitted)
    for i in range(len(begun)):
        one = begun.subset([i])
        balance = Balance(one, fitted.shape, fitted.terms)
        X, y = balance.columns(fitted.shape, fitted.terms, fitted.beta)
        known = 0.0 if begun.gain_unknown else load_torque(one.segments[0])
        found.measured.append(y * fitted.gain + known)
        found.predicted.append(X @ fitted.beta * fitted.gain + known)
        found.friction.append(X[:, law] @ fitted.beta[law] * fitted.gain)
        found.weight.append(one.segments[0].kept_weight)
    return found
