"""What a refinement makes small: errors of simulated motion, and what the balance said before."""

from collections.abc import Sequence
from copy import copy

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.closed_loop import Course
from frictionjoint.identify.fit import Fit
from frictionjoint.refine.motion import errors
from frictionjoint.refine.vector import Vector

# samples with one error in common: as one number a tenth of a second
_CORRELATED = 10.0
# rad, least error that counts as small
_LEAST = 1e-4


class Objective:
    """Soft errors of all samples, then the prior's, at numbers in units of the prior.

    A soft loss (as the square where an error is small, as its size where it is large) keeps a
    single missed breakaway from deciding.

    Args:
        window_s: s between restarts from the measured motion; None: whole logs.
        x: where the search begins, in the vector's own numbers: what is a small error there.
    """

    def __init__(
        self, vector: Vector, courses: Sequence[Course], window_s: float | None, x: Array
    ) -> None:
        self.vector, self.courses, self.window_s = vector, courses, window_s
        self.size = max(float(np.median(np.abs(self.errors(self.units(x))))), _LEAST)
        self._last: tuple[bytes, Array] | None = None

    def of(self, courses: Sequence[Course]) -> "Objective":
        """The same of some of the logs alone."""
        some = copy(self)
        some.courses, some._last = courses, None
        return some

    def units(self, x: Array) -> Array:
        """Numbers of the vector in units of the prior from its start."""
        return np.asarray((x - self.vector.start) / self.vector.unit)

    def numbers(self, z: Array) -> Array:
        """Inverse of `units`, within the bounds: a search rounds, and no law has less than none."""
        x = self.vector.start + z * self.vector.unit
        return np.clip(x, self.vector.low, self.vector.high)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Of the numbers, in units of the prior."""
        return self.units(self.vector.low) - 1e-9, self.units(self.vector.high) + 1e-9

    def errors(self, z: Array) -> Array:
        """Simulated minus measured position, rad (m), of all logs one after the other."""
        return np.concatenate(self.errors_of(self.vector.fit(self.numbers(z))))

    def errors_of(self, fitted: Fit) -> list[Array]:
        """Of any model, one array a log."""
        return errors(self.courses, fitted, self.window_s)

    def soft(self, e: Array) -> Array:
        """Errors as the search counts them."""
        x = e / self.size
        return np.asarray(np.sign(e) * np.sqrt(2.0 * (np.sqrt(1.0 + x**2) - 1.0) / _CORRELATED))

    def __call__(self, z: Array) -> Array:
        """Soft errors, then the numbers themselves, shape (samples + p,)."""
        key = z.tobytes()
        if self._last is None or self._last[0] != key:
            self._last = key, np.concatenate([self.soft(self.errors(z)), z])
        return self._last[1]
