"""Objective of a refinement, errors of simulated motion and the prior from the torque fit, and its
derivatives.

Motion is simulated in windows that start from the measured one, or over whole logs. Derivatives are
differences at first. Each step then shows how the errors change along it, at the cost of one
simulation; Broyden's update (1965) puts that into the derivatives and leaves all other directions
unchanged. If they do not predict a step, differences are computed again. New ones need not be
better: at the boundary between sticking and sliding, a small difference misses the effect of a
step.
"""

from collections.abc import Callable, Sequence
from copy import copy

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.terms import drive_changes
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import Course, joint_model
from frictionjoint.simulate.one_joint import simulate
from frictionjoint.threads import side_by_side

# s, longest window: a stick that came too early is forgotten with it
LONGEST_WINDOW_S = 1.0


def errors(courses: Sequence[Course], fitted: Fit, window_s: float | None) -> list[Array]:
    """Simulated minus measured position at the samples of each log, rad (m), with `window_s` s
    between restarts from the measured motion, or those of the course; None: whole logs."""
    model, changes = joint_model(fitted), drive_changes(fitted.terms)

    def one(course: Course) -> Array:
        run = course.changed(changes)
        length = course.window_s or window_s
        if length is None:
            found = simulate(model, run)
        else:
            window = max(2, round(length / run.step))
            found = simulate(model, run, course.motion, window)
        # rad (m): a run gone astray must not outweigh all others
        e = np.clip(course.at_samples(found) - course.position, -10.0, 10.0)
        return e if course.counts is None else np.where(course.counts, e, 0.0)

    with side_by_side() as each:
        return list(each(one, courses))


def window_squares(courses: Sequence[Course], fitted: Fit) -> Array:
    """Mean square of the errors of each window, rad^2 (m^2), shape (k,)."""
    found = []
    for course, e in zip(courses, errors(courses, fitted, LONGEST_WINDOW_S), strict=True):
        window = ((course.time - course.time[0]) / LONGEST_WINDOW_S).astype(int)
        count = np.bincount(window)
        found.append((np.bincount(window, e**2) / np.maximum(count, 1))[count > 0])
    return np.concatenate(found)


# steps of a search by simulation
MOST_STEPS = 10
# decimals of the numbers that are simulated, in units of the prior, see `Vector`
_DECIMALS = 5


class Objective:
    """Soft errors of all samples, then those of the prior, at numbers in units of the prior.

    A soft loss (quadratic for small errors, linear for large ones) keeps a single missed breakaway
    from dominating.

    Args:
        window_s: s between restarts from the measured motion; None: whole logs.
        x: start of the search, in the vector's own numbers; it sets the scale of small errors.
    """

    def __init__(
        self, vector: Vector, courses: Sequence[Course], window_s: float | None, x: Array
    ) -> None:
        self.vector, self.courses, self.window_s = vector, courses, window_s
        # rad
        self.size = max(float(np.median(np.abs(self.errors(self.units(x))))), 1e-4)
        self._last: tuple[bytes, Array] | None = None

    def of(self, courses: Sequence[Course]) -> "Objective":
        """The objective for some of the logs."""
        some = copy(self)
        some.courses, some._last = courses, None
        return some

    def units(self, x: Array) -> Array:
        """Numbers of the vector in units of the prior from its start."""
        return np.asarray((x - self.vector.start) / self.vector.unit)

    def numbers(self, z: Array) -> Array:
        """Inverse of `units`, rounded, and clipped to the bounds."""
        x = self.vector.start + np.round(z, _DECIMALS) * self.vector.unit
        return np.clip(x, self.vector.low, self.vector.high)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Bounds of the numbers, in units of the prior."""
        return self.units(self.vector.low) - 1e-9, self.units(self.vector.high) + 1e-9

    def errors(self, z: Array) -> Array:
        """Simulated minus measured position, rad (m), of all logs concatenated."""
        return np.concatenate(self.errors_of(self.vector.fit(self.numbers(z))))

    def errors_of(self, fitted: Fit) -> list[Array]:
        """Errors of any model, one array per log."""
        return errors(self.courses, fitted, self.window_s)

    def soft(self, e: Array) -> Array:
        """Errors after the soft loss."""
        x = e / self.size
        # ten neighbouring samples share one error, as a tenth of a second would
        return np.asarray(np.sign(e) * np.sqrt(2.0 * (np.sqrt(1.0 + x**2) - 1.0) / 10.0))

    def __call__(self, z: Array) -> Array:
        """Soft errors, then the numbers themselves, shape (samples + p,)."""
        key = z.tobytes()
        if self._last is None or self._last[0] != key:
            self._last = key, np.concatenate([self.soft(self.errors(z)), z])
        return self._last[1]


class Secant:
    """Jacobian of a residual within bounds for a search, called at each accepted point; `last` is
    the last point with its residual and derivatives, if known, and `new` whether these are
    differences. Known derivatives stay in use unless differences may be computed `again`."""

    def __init__(
        self,
        residual: Callable[[Array], Array],
        bounds: tuple[Array, Array],
        last: tuple[Array, Array, Array] | None,
        again: bool = True,
    ) -> None:
        self.residual, self.bounds, self.last, self.again = residual, bounds, last, again
        self.new = False

    def __call__(self, z: Array) -> Array:
        """Shape (n, p)."""
        r = self.residual(z)
        J = self._updated(z, r)
        self.new = J is None
        if J is None:
            J = differences(self.residual, self.bounds, z, r)
        self.last = z.copy(), r, J
        return J

    def _updated(self, z: Array, r: Array) -> Array | None:
        if self.last is None:
            return None
        z0, r0, J0 = self.last
        step = z - z0
        change = r - r0
        missed = change - J0 @ step
        if not step.any():
            return J0
        if self.again and np.linalg.norm(missed) > np.linalg.norm(change):
            return None
        return np.asarray(J0 + np.outer(missed, step / (step @ step)))


def differences(
    residual: Callable[[Array], Array], bounds: tuple[Array, Array], z: Array, r: Array
) -> Array:
    """Derivatives of a residual, which is r at z, by differences within bounds, shape (n, p)."""
    columns, step = [], 0.02
    for i in range(len(z)):
        h = step if z[i] + step <= bounds[1][i] else -step
        moved = z.copy()
        moved[i] += h
        columns.append((residual(moved) - r) / h)
    return np.column_stack(columns)
