"""Least squares on simulated motion, starting from the torque fit, and the decision to use it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.refine.guard import balanced_without_each, clearly_less, of_logs
from frictionjoint.refine.tried import Tried, by_windows, tried
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import Course

# a law's number by which its level falls with the speed, Fs / Fc - 1
_FALL = "excess"


@dataclass(frozen=True)
class Refined:
    """A refinement, and the decision to use it.

    Attributes:
        found: the refined numbers and their evidence.
        before: mean absolute error of each log, see `guard.of_logs`, of models fitted to the torque
            of other kinds of logs, rad (m), shape (logs,); `found.left_out` is that of the refined
            ones.
        taken: whether the refined model is used, because it clearly predicts unlike motion better.
    """

    found: Tried
    before: Array
    taken: bool

    @property
    def fit(self) -> Fit:
        """The refined model, or the torque fit if that is kept."""
        vector = self.found.vector
        return vector.fit(self.found.values) if self.taken else vector.fitted

    @property
    def left_out(self) -> Array:
        """Error of each log of the model that was selected, fitted to other kinds of logs."""
        return self.found.left_out if self.taken else self.before

    @property
    def gain_error(self) -> float:
        """Relative standard error of the drive's gain; 0 if it is known."""
        return float(np.sqrt(self.found.cov[0, 0])) if self.found.vector.has_gain else 0.0


def refine(
    prepared: Prepared,
    fitted: Fit,
    courses: Sequence[Course],
    progress: Callable[[str], None] = lambda text: None,
) -> Refined:
    """Refine all numbers of a fitted model by the motion of its logs.

    Args:
        courses: the logs it was fitted to.
    """
    cov = stated_covariance(prepared, fitted)
    begins = [fitted, *without_stribeck(prepared, fitted)]
    armature = courses[0].run.load.armature
    vectors = [Vector(prepared, fitted, cov, armature, each) for each in begins]
    vector, x = by_windows(vectors, courses, progress)
    found = tried(vector, courses, [x], progress)
    progress("checking the refinement on logs left out")
    return judged(prepared, found, courses)


def without_stribeck(prepared: Prepared, fitted: Fit) -> list[Fit]:
    """A fit whose friction level does not decrease with speed; none if the given fit is such a fit.

    A torque fit can use this decrease to absorb any other error, at speeds where friction does not
    decrease, and a local search cannot leave that minimum.
    """
    shape = fitted.shape
    numbers = dict(zip(shape.variables, shape.vector(), strict=True))
    flat = {name: 0.0 if name.startswith(_FALL) else x for name, x in numbers.items()}
    if flat == numbers:
        return []
    level = shape.moved(np.array(list(flat.values())))
    return [refit(prepared, fitted.terms, level, ROUGH, 1)]


def judged(prepared: Prepared, found: Tried, courses: Sequence[Course]) -> Refined:
    """Refined numbers compared with the torque fit they started from."""
    left = balanced_without_each(prepared, found.vector.fitted, courses, found.masks)
    before = of_logs(left, courses)
    return Refined(found, before, clearly_less(found.left_out, before))
