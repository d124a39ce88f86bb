"""Least squares on simulated motion, starting from the torque fit, and the decision to use it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

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
    """Result of a refinement.

    Attributes:
        fit: refined, or the torque fit if the refined one does not clearly predict unlike motion
            better.
        taken: whether it is the refined one. names: of the numbers in `values`.
        values, cov: of the refined numbers, shapes (p,) and (p, p); see `vector.Vector`.
        left_out: mean absolute error of each log, see `guard.of_logs`, of models fitted to other
            kinds of logs, before and after, shape (logs,) each, rad (m).
        near: the same of the refined numbers in windows from the measured motion, shape (logs,).
        near_fitted: in those windows, of the model fitted to all logs, shape (logs,).
    """

    fit: Fit
    taken: bool
    values: Array
    cov: Array
    left_out: tuple[Array, Array]
    near: Array
    near_fitted: Array
    vector: Vector

    @property
    def stands(self) -> Array:
        """`left_out` of the model that was selected."""
        before, after = self.left_out
        return after if self.taken else before

    @property
    def gain_error(self) -> float:
        """Relative standard error of the drive's gain; 0 if it is known."""
        return float(np.sqrt(self.cov[0, 0])) if self.vector.has_gain else 0.0

    @property
    def guard(self) -> tuple[float, float]:
        """Means of `left_out`."""
        before, after = self.left_out
        return float(np.mean(before)), float(np.mean(after))


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
    refined = judged(prepared, found, courses)
    return refined if refined.taken else replace(refined, fit=fitted)


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
    fitted = found.vector.fitted
    left = balanced_without_each(prepared, fitted, courses, found.masks)
    before = of_logs(left, courses)
    taken = clearly_less(found.left_out, before)
    return outcome(found, taken, before)


def outcome(found: Tried, taken: bool, before: Array) -> Refined:
    """The result of a refinement after the decision to use it or not.

    Args:
        before: see `Refined.left_out`.
    """
    vector = found.vector
    return Refined(
        vector.fit(found.values) if taken else vector.fitted,
        taken,
        found.values,
        found.cov,
        (before, found.left_out),
        found.near,
        found.near_fitted,
        vector,
    )
