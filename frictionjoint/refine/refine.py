"""Least squares on simulated motion, from the balance fit, and the guard around it.

Windows come first: short runs from the measured motion are smooth in the parameters where a whole
log is not, for a joint that sticks once too early is somewhere else for the rest of it. Whole logs
come last, for they are what is judged. A soft loss keeps a single missed breakaway from deciding.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from frictionjoint.arrays import Array
from frictionjoint.diagnose.closed_loop import Course
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.refine.motion import WINDOW_S, errors, mean_absolute
from frictionjoint.refine.vector import Vector

# units of the prior by which a number is moved for a derivative
_STEP = 0.02
# every so many logs one is left out by the guard
_FOLDS = 4
# steps of each stage
_MOST = 8


@dataclass(frozen=True)
class Refined:
    """Outcome of a refinement.

    Attributes:
        fit: refined, or the balance's own where that predicts unlike motion better.
        taken: whether it is the refined one. names: of the numbers in `values`.
        values, cov: of the refined numbers, shapes (p,) and (p, p); see `vector.Vector`.
        guard: mean absolute errors on logs left out, before and after, rad (m).
    """

    fit: Fit
    taken: bool
    values: Array
    cov: Array
    guard: tuple[float, float]
    vector: Vector


def refine(
    prepared: Prepared,
    fitted: Fit,
    cov: Array,
    courses: Sequence[Course],
    progress: Callable[[str], None] = lambda text: None,
) -> Refined:
    """Refine all numbers of a fitted model by the motion of its logs.

    Args:
        cov: of the fit's parameters, in the order of its jacobian. courses: of the logs it was
            fitted to.
    """
    vector = Vector(prepared, fitted, cov, courses[0].run.load.armature)
    kept = [c for i, c in enumerate(courses) if i % _FOLDS or len(courses) == 1]
    left_out = [c for i, c in enumerate(courses) if i % _FOLDS == 0]
    progress("refine: guard")
    trial, _ = _search(vector, kept, vector.start, progress)
    before = mean_absolute(left_out, fitted)
    after = mean_absolute(left_out, vector.fit(trial))
    progress("refine: all logs")
    values, found = _search(vector, courses, trial, progress, whole_only=True)
    taken = after < before
    refined = vector.fit(values) if taken else fitted
    return Refined(refined, taken, values, found, (before, after), vector)


def _search(
    vector: Vector,
    courses: Sequence[Course],
    x: Array,
    progress: Callable[[str], None],
    whole_only: bool = False,
) -> tuple[Array, Array]:
    """Numbers and their covariance."""
    J = np.zeros((0, len(x)))
    for window in (None,) if whole_only else (WINDOW_S, None):
        size = _noise(courses, vector.fit(x), window)

        def residual(z: Array, window: float | None = window, size: float = size) -> Array:
            e = np.concatenate(errors(courses, vector.fit(vector.start + z * vector.unit), window))
            # as one number a tenth of a second: samples between those add nothing
            soft = np.sign(e) * np.sqrt(2.0 * (np.sqrt(1.0 + (e / size) ** 2) - 1.0))
            return np.concatenate([soft / np.sqrt(_CORRELATED), z])

        low, high = (b - vector.start for b in (vector.low, vector.high))
        bounds = (low / vector.unit - 1e-9, high / vector.unit + 1e-9)
        z = (x - vector.start) / vector.unit
        what = "whole logs" if window is None else f"windows of {window:g} s"
        progress(f"refine: {what}, {1e3 * size:.3g} mrad")
        found = least_squares(
            residual, np.clip(z, *bounds), bounds=bounds, diff_step=None, max_nfev=_MOST,
            jac=_Jacobian(residual, bounds), ftol=1e-3, xtol=1e-3,
        )  # fmt: skip
        x, J = vector.start + found.x * vector.unit, found.jac
    x = np.clip(x, vector.low, vector.high)
    cov = np.linalg.pinv(J.T @ J) * np.outer(vector.unit, vector.unit)
    return x, np.asarray(cov)


# samples with one error in common
_CORRELATED = 10.0


class _Jacobian:
    """One-sided differences with a step of the prior, away from bounds."""

    def __init__(self, residual: Callable[[Array], Array], bounds: tuple[Array, Array]) -> None:
        self.residual, self.bounds = residual, bounds

    def __call__(self, z: Array) -> Array:
        here = self.residual(z)
        columns = []
        for i in range(len(z)):
            h = _STEP if z[i] + _STEP <= self.bounds[1][i] else -_STEP
            moved = z.copy()
            moved[i] += h
            columns.append((self.residual(moved) - here) / h)
        return np.column_stack(columns)


def _noise(courses: Sequence[Course], fitted: Fit, window: float | None) -> float:
    """Typical error, rad: what counts as small in the soft loss."""
    e = np.abs(np.concatenate(errors(courses, fitted, window)))
    return max(float(np.median(e)), 1e-4)
