"""Objective of a refinement: errors of simulated motion, and the prior from the torque fit."""

from collections.abc import Sequence
from copy import copy

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit
from frictionjoint.refine.motion import errors
from frictionjoint.refine.vector import Vector
from frictionjoint.replay.closed_loop import Course

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
