"""Cross-validation of a refined model: whole kinds of logs are left out.

A kind is what a user will meet again: another gain, another load, another motion. Logs left out at
random resemble the others, and test only interpolation.

For each kind the refined numbers are moved to the minimum of the other logs, by a search that
starts with the known derivatives. The fit to torque is repeated without the kind too, because a
model knows the logs that it was fitted to. Both models simulate the left-out logs.
"""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares
from scipy.special import ndtr, ndtri, stdtrit

from frictionjoint.arrays import Array
from frictionjoint.control.kernel import COUNT
from frictionjoint.effects.signals import TIME
from frictionjoint.identify.early_checks import load_shows
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rounding import EQUAL
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.refine.objective import MOST_STEPS, Objective, Secant, differences, errors
from frictionjoint.replay.closed_loop import Course

Mask = NDArray[np.bool_]

# kinds of one sort; more are no kinds but single logs
_MOST_KINDS = 6
# rad (m): a smaller error, or standard error, of a position is none
_LEAST = 1e-9
# part of the positions that a band contains
BAND = 0.95


def kinds(courses: Sequence[Course]) -> list[Mask]:
    """Samples to leave out together, shape (all samples,) each: one mask per kind."""
    lengths = [len(c.position) for c in courses]
    if len(courses) == 1:
        n = lengths[0]
        # the last third of a single log is left out
        return [np.arange(n) >= round(2.0 / 3.0 * n)]
    of_log = np.repeat(np.arange(len(courses)), lengths)
    return [np.isin(of_log, group) for group in _groups(courses)]


def _groups(courses: Sequence[Course]) -> list[list[int]]:
    """Groups of logs of the same kind, for every quantity in which logs differ."""
    names = sorted({name for c in courses for name in c.figures})
    found: dict[tuple[tuple[int, ...], ...], None] = {}
    for name in names:
        values: dict[Hashable, list[int]] = {}
        for i, c in enumerate(courses):
            values.setdefault(c.figures.get(name), []).append(i)
        if 1 < len(values) <= _MOST_KINDS:
            found[tuple(sorted(tuple(group) for group in values.values()))] = None
    if not found:  # nothing is said of the logs: each is of its own kind
        few = min(len(courses), _MOST_KINDS)
        found[tuple(tuple(range(k, len(courses), few)) for k in range(few))] = None
    return [list(group) for groups in found for group in groups]


def without_each(
    objective: Objective, z: Array, J: Array, masks: Sequence[Mask]
) -> tuple[Array, Array]:
    """Numbers fitted without each kind, (kinds, p), and their errors on it, see `on_each`, from the
    refined numbers z in units of the objective, of whole logs, and its derivatives J there."""
    moved = np.array([_without(objective, z, J, mask) for mask in masks])
    return moved, on_each(objective, moved, masks)


def on_each(objective: Objective, moved: Array, masks: Sequence[Mask]) -> Array:
    """Errors on each kind of the numbers fitted without it, `moved`, (kinds, p), in units of the
    objective, which may be another one of the same numbers; rad (m), NaN elsewhere, (kinds, n)."""
    return np.where(masks, [objective.errors(x) for x in moved], np.nan)


def balanced_without_each(
    prepared: Prepared, fitted: Fit, courses: Sequence[Course], masks: Sequence[Mask]
) -> Array:
    """Error on each kind of logs, of a torque fit without it, rad (m), NaN elsewhere, (kinds, n).

    If the drive was measured, the torque fit uses all logs: this fit is the prior of the refined
    parameters and largely determines them, so a comparison must use the same logs.
    """
    if courses[0].window_s is not None:
        return np.where(masks, np.concatenate(errors(courses, fitted, None)), np.nan)
    rows = []
    for mask in masks:
        other = refit(_kept(prepared, courses, mask), fitted.terms, fitted.shape, ROUGH)
        # without the load in what is left no torque is known: then that of all logs
        errors_there = errors(courses, other if load_shows(other) else fitted, None)
        rows.append(np.where(mask, np.concatenate(errors_there), np.nan))
    return np.array(rows)


def _kept(prepared: Prepared, courses: Sequence[Course], mask: Mask) -> Prepared:
    """The logs, or the part of a single log, that are not left out."""
    if len(courses) > 1:
        parts = enumerate(_by_log(mask, courses))
        return prepared.subset([i for i, part in parts if not part.any()])
    (s,), (course,) = prepared.segments, courses
    kept = s.signals[:, TIME] < course.time[int(np.argmax(mask))] - course.time[0]
    return replace(prepared, segments=(replace(s, mask=s.mask & kept),))


def spread(z: Array, moved: Array, masks: Sequence[Mask]) -> Array:
    """Covariance of numbers from their values without each kind (jackknife), shape (p, p).

    It contains errors that differ between kinds, which the errors of single samples do not. If logs
    differ in kind in several ways, it is the mean of those.
    """
    found, ways, begin = np.zeros((len(z), len(z))), 0, 0
    for end in range(1, len(masks) + 1):
        if np.sum(masks[begin:end]) < len(masks[begin]) and end < len(masks):
            continue
        step = moved[begin:end] - z
        count = max(len(step), 2)
        found += (count - 1) / count * step.T @ step
        ways, begin = ways + 1, end
    return found / ways


def uncertain(told: Array, U: Array, wider: float) -> Array:
    """Covariance of numbers in units of the prior if the logs' errors are `wider` by a factor, from
    J'J of the derivatives of their soft errors, `told`, and the covariance between kinds of logs,
    U, shape (p, p) each. Numbers that the logs do not determine keep the prior, however large the
    errors are."""
    return np.asarray(np.linalg.inv(told / wider**2 + np.eye(len(told))) + U)


def missing_width(
    objective: Objective, z: Array, cov: Callable[[float], Array], errors: Array
) -> float:
    """Factor on the logs' errors for which prediction bands cover the left-out logs; at least 1.

    An error common to all logs does not appear in the variation of the parameters. It appears in
    the errors on left-out kinds of logs, beyond the rounding of the encoder. Errors within a log
    are not independent. So with few logs the factor is as uncertain as a variance from so few
    numbers, and the band is Student's.

    Args:
        cov: covariance of the numbers for a factor on the logs' errors, shape (p, p).
        errors: on left-out kinds, NaN elsewhere, (kinds, n).
    """
    moves = differences(objective.errors, objective.bounds, z, objective.errors(z))
    counts = [np.full(len(c.position), c.run.block[COUNT]) for c in objective.courses]
    kind, sample = np.nonzero(np.isfinite(errors))
    off, moves = errors[kind, sample], moves[sample]
    # so far apart all is as the prior has it
    widest = 1e4
    half = np.maximum(0.5 * np.concatenate(counts)[sample], _LEAST)

    def missed(wider: float) -> float:
        squares = np.sum(moves @ cov(wider) * moves, axis=1)
        width = np.sqrt(np.maximum(squares, _LEAST**2))
        low, high = (ndtr((x - off) / width) for x in (-half, half))
        return BAND - EQUAL - float(np.mean(held(low, high)))

    if missed(1.0) <= 0.0:
        return 1.0
    most = 2.0
    while missed(most) > 0.0 and most < widest:
        most *= 2.0
    edge, few = 0.5 + 0.5 * BAND, len(of_logs(errors, objective.courses)) - 1
    student = float(stdtrit(few, edge) / ndtri(edge))
    if most >= widest:
        return student * most
    return student * float(brentq(missed, 0.5 * most, most, rtol=1e-3))


def held(low: Array, high: Array) -> Array:
    """Fraction of the encoder readings inside a prediction band.

    A reading represents all positions that are rounded to it. It counts with the fraction of its
    probability that is inside the band. So the band of a correct prediction contains `BAND` of the
    readings for any encoder. `low` and `high` are the predicted probabilities of less than each
    reading, and of no more than it.
    """
    least, most = 0.5 - 0.5 * BAND, 0.5 + 0.5 * BAND
    inside = np.clip(high, least, most) - np.clip(low, least, most)
    return np.asarray(inside / np.maximum(high - low, np.finfo(float).tiny))


def of_logs(errors: Array, courses: Sequence[Course]) -> Array:
    """Mean absolute error of each log over all kinds that leave it out, shape (logs,).

    For a single log: of each part that was left out.
    """
    if len(courses) == 1:
        left_out = errors[0, ~np.isnan(errors[0])]
        # ten parts of it count as logs
        parts = np.array_split(left_out, min(10, len(left_out)))
        return np.array([np.mean(np.abs(part)) for part in parts])
    return np.array([np.nanmean(np.abs(part)) for part in _by_log(errors, courses)])


def _by_log(x: NDArray[Any], courses: Sequence[Course]) -> list[NDArray[Any]]:
    """Values of all samples, the last axis, as one array per log."""
    return np.split(x, np.cumsum([len(c.position) for c in courses])[:-1], axis=-1)


def gains(after: Array, before: Array) -> Array:
    """Logarithm of the ratio by which the error of each log decreased, shape (logs,).

    Their ratios count: where a model does not hold, as beyond a limit of the drive that the other
    logs do not reach, errors are large and say nothing about the motion in which it does.
    """
    return np.log(np.maximum(before, _LEAST) / np.maximum(after, _LEAST))


def clearly_less(after: Array, before: Array) -> bool:
    """Whether errors of logs decreased by more than the standard error of their mean gain."""
    gained = gains(after, before)
    return bool(gained.sum() > np.std(gained) * np.sqrt(len(gained)))


def _without(objective: Objective, z: Array, J: Array, mask: Mask) -> Array:
    """Numbers fitted without some samples; a log without remaining samples is not simulated."""
    courses = objective.courses
    some = [not part.all() for part in _by_log(mask, courses)]
    there = np.repeat(some, [len(c.position) for c in courses])
    rest = objective.of([c for c, kept in zip(courses, some, strict=True) if kept])
    numbers = np.ones(len(z), dtype=bool)
    kept = np.concatenate([~mask[there], numbers])

    def residual(x: Array) -> Array:
        return np.asarray(rest(x)[kept])

    known = J[np.concatenate([~mask, numbers])]
    # differences would cost more than all the rest, and move the numbers little further
    secant = Secant(residual, objective.bounds, (z, residual(z), known), again=False)
    found = least_squares(
        residual, z, jac=secant, bounds=objective.bounds, max_nfev=MOST_STEPS, ftol=1e-3, xtol=1e-3
    )
    return np.asarray(found.x)
