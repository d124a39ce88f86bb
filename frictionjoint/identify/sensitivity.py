"""How a fitted model's torque moves with each of its parameters, along any motion."""

from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.design import balance, design, full_signals
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.terms import delay_of

_STEP = 1e-3


def driven(prepared: Prepared, fitted: Fit) -> Prepared:
    """Motions with the drive that they ask of a fitted law, without its other terms."""
    segments = []
    for s in prepared.segments:
        torque = balance(full_signals(s, fitted.shape, *fitted.levels), *fitted.levels)
        on_time = replace(s, drive=torque / fitted.gain)
        # a position logged late goes with a drive that was earlier
        segments.append(replace(s, drive=on_time.drive_before(-delay_of(fitted.terms))))
    return replace(prepared, segments=tuple(segments))


def sensitivities(prepared: Prepared, fitted: Fit) -> Array:
    """Jacobian of a fit's torque on other motions than those it was fitted to.

    Args:
        prepared: the motions; a delay, if the fit has one, moves their drive.
    Returns:
        shape (n, p), N m, columns in the order of `fitted.jacobian`, rows the kept samples.
    """
    X, y = design(prepared, fitted.shape, fitted.terms, beta=fitted.beta)
    model = X @ fitted.beta
    columns = []
    for name, x in zip(fitted.shape.variables, fitted.shape.vector(), strict=True):
        # the logarithm of a ratio of slopes must not rise above 0, nothing else below it
        h = -_STEP if name.startswith("log ") else _STEP
        at = fitted.shape.variables.index(name)
        moved = fitted.shape.vector()
        moved[at] = x + h
        other, _ = design(prepared, fitted.shape.moved(moved), fitted.terms, beta=fitted.beta)
        columns.append((other @ fitted.beta - model) / h)
    for i, term in enumerate(fitted.terms):
        for k, x in enumerate(term.free_shape):
            h = _STEP * abs(x) or 1e-9
            shape = tuple(y + h * (j == k) for j, y in enumerate(term.free_shape))
            terms = (*fitted.terms[:i], term.with_shape(shape), *fitted.terms[i + 1 :])
            other, later = design(prepared, fitted.shape, terms, beta=fitted.beta)
            columns.append(((other @ fitted.beta - later) - (model - y)) / h)
    return np.column_stack([X, *columns]) * fitted.gain
