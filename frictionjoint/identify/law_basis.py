"""Any friction law as columns, so that a linear fit shows about what it is.

Elements in parallel that stick and slip have the memory of presliding (Prandtl 1928; Iwan 1966). A
function of speed times an element is what sliding does to it, and the velocity of an element that
sticks is what damps it. A law is a sum of such columns with coefficients that are not negative.
That is a poor model, but it has one minimum, which shows where a search for the law should begin.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import Q, V
from frictionjoint.identify.design import Balance
from frictionjoint.identify.law_start import falls
from frictionjoint.identify.layout import layout_of
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.smooth import elastic_plastic
from frictionjoint.identify.terms import Term

# reaches of the elements: how many, the least and the largest over the travel
_ELEMENTS, _SHORTEST, _LONGEST = 8, 1e-5, 0.1


@dataclass(frozen=True)
class LinearLaw:
    """A law fitted as columns; a level is in units of the drive.

    Attributes:
        reaches: displacement from rest to slipping of each element, rad (m), shape (k,).
        levels: of each element: constant, and what falls with speed, see `falls`, shape (1 + f, k).
        rms: of the weighted residual. residual: on the kept samples, shape (n,).
    """

    reaches: Array
    levels: Array
    rms: float
    residual: Array

    @property
    def level(self) -> float:
        """At rest."""
        return float(self.levels.sum())

    def sticking(self, s: Segment, top_speed: float) -> tuple[Array, Array]:
        """Fraction of the level that sticks along a log, and its stiffness, each of shape (n,)."""
        sticks = np.abs(_elements(s, self.reaches)) < 1.0
        each = falls(np.abs(s.signals[:, V]) / top_speed) @ self.levels
        total = np.maximum(each.sum(axis=1), np.finfo(float).tiny)
        return (each * sticks).sum(axis=1) / total, (each * sticks) @ (1.0 / self.reaches)


@dataclass(frozen=True)
class LawBasis:
    """The columns of laws along some logs."""

    prepared: Prepared

    @cached_property
    def reaches(self) -> Array:
        """Displacements from rest to slipping of the elements, rad (m), shape (k,)."""
        span = self.prepared.span
        resolved = max(s.noise.resolution for s in self.prepared.segments)
        least = min(max(_SHORTEST * span, resolved), 0.1 * _LONGEST * span)
        return np.geomspace(least, _LONGEST * span, _ELEMENTS)

    @cached_property
    def columns(self) -> Array:
        """Levels, element by element and fall by fall, then damping, shape (n, (2 + f) k)."""
        return np.concatenate([s.lowpass(self._along(s))[s.kept] for s in self.prepared.segments])

    def _along(self, s: Segment) -> Array:
        z = _elements(s, self.reaches)
        v = s.signals[:, V]
        fall = falls(np.abs(v) / self.prepared.top_speed)
        levels = (fall[:, :, None] * z[:, None, :]).reshape(len(v), -1)
        return np.hstack([levels, (np.abs(z) < 1.0) * v[:, None]])

    def fitted(
        self, nominal: Shape, terms: tuple[Term, ...], weight: Array, damped: bool = True
    ) -> LinearLaw:
        """The law that leaves least of the logs together with some terms.

        Args:
            nominal: a law for what follows one. weight: of each kept sample, shape (n,).
            damped: whether its elements are.
        """
        others, y = Balance(self.prepared, nominal, terms).columns(nominal, terms)
        names = layout_of(self.prepared, nominal, terms).base
        others = np.delete(others, [names.index(x) for x in ("Fc", "sigma1") if x in names], 1)
        known = len(set(names) & {"load", "sigma2"})
        free = others[:, known:]  # terms have any sign
        own = self.columns
        if not damped:
            own = own[:, : -len(self.reaches)]
        X = np.hstack([own, others[:, :known], free, -free])
        size = np.linalg.norm(X * weight[:, None], axis=0)
        size[size == 0.0] = 1.0
        R = np.asarray(np.linalg.qr(np.column_stack([X / size, y]) * weight[:, None], mode="r"))
        beta = nnls(R[:, :-1], R[:, -1], maxiter=20 * X.shape[1])[0] / size
        residual = y - X @ beta
        of_law = beta[: own.shape[1]].reshape(-1, len(self.reaches))
        rms = root_mean_square(residual * weight)
        return LinearLaw(self.reaches, of_law[:-1] if damped else of_law, rms, residual)


def _elements(s: Segment, reaches: Array) -> Array:
    """Torque of elements of level 1 along a log, shape (n, k)."""
    return elastic_plastic(np.ascontiguousarray(s.signals[:, Q]), reaches)
