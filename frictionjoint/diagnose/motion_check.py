"""Comparison of models by simulated motion."""

from collections.abc import Callable

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import CLEARLY
from frictionjoint.diagnose.state import State
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.start import settled
from frictionjoint.identify.weights import reweighed

# mean square error of each run of logs simulated with a fit to them, rad^2 (m^2), or None
Replayed = Callable[[Prepared, Fit], Array | None]


def nearer(errors: Array, now: Array) -> bool:
    """Whether the errors of simulated runs are clearly smaller: by a fraction of the rms, and by a
    paired standard error."""
    gained = now - errors
    enough = errors.sum() < (1.0 - CLEARLY) ** 2 * now.sum()
    return bool(enough and gained.sum() > np.std(gained) * np.sqrt(len(gained)))


def moving_nearest(state: State, replayed: Replayed) -> bool:
    """Use another local minimum of the law if its simulated motion is nearer to the logs; return
    whether one is used.

    Errors in a reconstructed drive bias the law: several local minima explain the torque equally
    well and simulate quite different motions.
    """
    now = replayed(state.prepared, state.fit)
    if now is None:
        return False
    best, least = None, now
    for other in state.laws.near(state.prepared, state.fit):
        errors = replayed(state.prepared, other)
        if errors is not None and nearer(errors, now) and errors.sum() < least.sum():
            best, least = other, errors
    if best is None:
        return False
    moved = refit(state.prepared, best.effects, best.shape, ROUGH)
    prepared, moved = reweighed(*settled(*reweighed(state.prepared, moved)))
    errors = replayed(prepared, moved)
    if errors is None or not nearer(errors, now):
        return False
    state.prepared, state.fit = prepared, moved
    return True
