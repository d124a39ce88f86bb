"""Least squares on simulated motion, starting from the torque fit, and the decision to use it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit, without_scale
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import Estimate, law_estimates, term_estimates
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.refine.guard import balanced_without_each, gains, of_logs
from frictionjoint.refine.objective import LONGEST_WINDOW_S, errors
from frictionjoint.refine.tried import Tried, tried
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import Course, LoopErrors, Loops

# a law's number by which its level falls with the speed, Fs / Fc - 1
_FALL = "excess"


@dataclass(frozen=True)
class Refined:
    """A refinement, and the decision to use it."""

    near: Tried  # numbers refined on windows of the logs, and their evidence
    found: Tried  # numbers refined on whole logs, and their evidence
    # mean absolute error of each log, see `guard.of_logs`, of models fitted to the torque of other
    # kinds of logs, rad (m), shape (logs,); `found.left_out` is that of the refined ones
    before: Array
    taken: bool  # whether the refined model is used, because it predicts unlike motion better

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
    progress(f"refining by simulation of {LONGEST_WINDOW_S:g} s")
    vectors = [Vector(prepared, fitted, cov, armature, each) for each in begins]
    near = _nearest([on_windows(v, courses, [v.start]) for v in vectors], courses)
    progress("refining by simulation of whole logs")
    found = on_whole_logs(near, courses)
    progress("checking the refinement on logs left out")
    return judged(prepared, near, found, courses)


def on_windows(vector: Vector, courses: Sequence[Course], starts: Sequence[Array]) -> Tried:
    """A model refined on windows of the logs."""
    return tried(vector, courses, LONGEST_WINDOW_S, starts)


def on_whole_logs(near: Tried, courses: Sequence[Course]) -> Tried:
    """The same model refined on whole logs; itself where a measured drive allows windows only."""
    if courses[0].window_s is not None:
        return near
    return tried(near.vector, courses, None, [near.values])


def _nearest(models: Sequence[Tried], courses: Sequence[Course]) -> Tried:
    """The model with the smallest error on whole logs."""

    def error(model: Tried) -> float:
        found = errors(courses, model.vector.fit(model.values), None)
        return float(np.mean(np.abs(np.concatenate(found))))

    return min(models, key=error)


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


def judged(prepared: Prepared, near: Tried, found: Tried, courses: Sequence[Course]) -> Refined:
    """Refined numbers compared with the torque fit they started from."""
    left = balanced_without_each(prepared, found.vector.fitted, courses, found.masks)
    before = of_logs(left, courses)
    taken = bool(np.mean(gains(found.left_out, before)) > 0.0)
    return Refined(near, found, before, taken)


@dataclass(frozen=True)
class RefinedModel:
    """A refinement in a report."""

    taken: bool  # whether it is the result: left-out logs are predicted better than by the fit
    guard: tuple[float, float]  # mean absolute errors on left-out logs, before and after, rad (m)
    loops: LoopErrors | None  # whole logs in closed loop; None if the drive was measured
    parameters: dict[str, Estimate]  # by name, with standard errors

    @classmethod
    def of(cls, outcome: Refined, loops: Loops | None, slide: bool, scaled: bool) -> "RefinedModel":
        """From a refinement, used or not.

        Args:
            scaled: whether the gain of the drive is determined; otherwise all is in units of the
                drive.
        """
        numbers = outcome.found
        whole = numbers.vector.fit(numbers.values)
        cov = numbers.vector.own_covariance(whole, numbers.cov)
        fitted = whole if scaled else without_scale(whole)
        found = law_estimates(fitted, cov, slide)
        for i, term in enumerate(fitted.effects):
            found |= {
                f"{term.name} {name}": x
                for name, x in term_estimates(fitted, cov, i, slide).items()
            }
        errors = loops.errors([whole])[0] if loops else None
        guard = float(np.mean(outcome.before)), float(np.mean(numbers.left_out))
        return cls(outcome.taken, guard, errors, found)

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "taken": self.taken,
            "left_out_mae": {"before": self.guard[0], "after": self.guard[1]},
            **(self.loops.figures() if self.loops else {}),
            "parameters": self.parameters,
        }
