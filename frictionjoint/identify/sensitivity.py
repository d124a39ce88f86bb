"""Torque of a fitted model along any motion, and its derivatives by the parameters."""

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import LOAD, MOTOR, TIME, H, V
from frictionjoint.identify.design import Balance, with_track
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import delay_of


def full_signals(prepared: Prepared, shape: Shape, Fc: float, sigma2: float) -> list[Array]:
    """Signals of each log with H, RATE and MOTOR, the rigid body's torque plus friction, N m."""
    found = list(with_track(prepared.whole.tracks.along(shape), prepared.whole))
    for signals in found:
        signals[:, MOTOR] = signals[:, LOAD] + Fc * signals[:, H] + sigma2 * signals[:, V]
    return found


def driven(prepared: Prepared, fitted: Fit) -> Prepared:
    """Motions with the drive that a fitted law requires, without the fit's other terms."""
    segments = []
    signals = full_signals(prepared, fitted.shape, *fitted.levels)
    late = delay_of(fitted.terms)
    for s, x in zip(prepared.segments, signals, strict=True):
        drive, time = x[:, MOTOR] / fitted.gain, x[:, TIME]
        if late:
            # a position logged late goes with a drive that was earlier
            drive = CubicSpline(time, drive)(np.clip(time + late, time[0], time[-1]))
        segments.append(replace(s, drive=drive))
    return replace(prepared, segments=tuple(segments))


def sensitivities(prepared: Prepared, fitted: Fit) -> Array:
    """Jacobian of a fit's torque on other motions, whose drive a delay in the fit shifts: rows for
    the kept samples and columns as those of `fitted.jacobian`, N m, shape (n, p)."""
    found = Balance(prepared, fitted.shape, fitted.terms)
    X, _ = found.columns(fitted.shape, fitted.terms, fitted.beta)
    moves = found.moves(fitted.shape, fitted.terms, fitted.beta)
    return np.column_stack([X, moves]) * fitted.gain
