"""Models judged by the motion that they simulate."""

from collections.abc import Callable

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.state import State, without
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.start import settled
from frictionjoint.identify.weights import reweighed

# mean square error of each run of logs simulated with a fit to them, rad^2 (m^2), or None
Replayed = Callable[[Prepared, Fit], Array | None]


def drop_what_moves_worse(state: State, replayed: Replayed) -> None:
    """Leave out, one after the other, effects without which the simulated motion is nearer.

    Its torque speaks for an effect. Against it speaks the mean square of all runs, which a few that
    stick a moment too soon or too late may make, together with most of the runs, which they do not;
    and the motion must come nearer by a larger factor than the torque goes away.
    """
    while state.fit.effects:
        now = replayed(state.prepared, state.fit)
        if now is None:
            return
        least, best = now.sum() * state.fit.drive_rms**2, None
        for term in state.fit.effects:
            other = without(state, term)
            errors = replayed(state.prepared, other)
            if errors is None or not nearer(errors, now) or np.median(now - errors) <= 0.0:
                continue
            product = errors.sum() * other.drive_rms**2
            if product < least:
                least, best = product, other
        if best is None:
            return
        state.prepared, state.fit = reweighed(state.prepared, best)


def nearer(errors: Array, now: Array) -> bool:
    """Whether runs come nearer: by a part of the rms, and by a paired standard error."""
    gained = now - errors
    enough = errors.sum() < (1.0 - CLEARLY) ** 2 * now.sum()
    return bool(enough and gained.sum() > np.std(gained) * np.sqrt(len(gained)))


def moving_nearest(state: State, replayed: Replayed) -> bool:
    """The law from another valley, where the simulated motion is nearer.

    What else is wrong with a drive that a controller reconstructs bends the law: several valleys
    leave as much of the torque, and move quite differently.

    Returns:
        whether one was taken.
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
