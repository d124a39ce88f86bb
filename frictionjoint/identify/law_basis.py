"""Friction laws as linear regressors, so that a linear fit gives a rough estimate of the law.

Parallel elements that stick and slip have presliding memory (Prandtl 1928; Iwan 1966). The torque
of an element times a function of speed represents its change with sliding speed. The velocity of an
element while it sticks represents its damping. A law is a sum of these regressors with non-negative
coefficients. This model is rough, but its fit has a single minimum, which shows where a search for
the law should begin.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import Q, V
from frictionjoint.identify.basis import lengths
from frictionjoint.identify.design import Balance
from frictionjoint.identify.law_start import falls
from frictionjoint.identify.layout import layout_of
from frictionjoint.identify.rival_shape import ELEMENTS
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.smooth import elastic_plastic
from frictionjoint.identify.terms import Term

# displacements over the travel at which the elastic-plastic elements of `plain_friction` slip
_REACHES = np.array([1e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0])


@dataclass(frozen=True)
class LinearLaw:
    """A law fitted by linear regression; levels are in units of the drive."""

    reaches: Array  # displacement from rest to slipping of each element, rad (m), shape (k,)
    levels: Array  # of each element, constant and falling with speed, see `falls`, shape (1 + f, k)
    rms: float  # of the weighted residual
    residual: Array  # on the kept samples, shape (n,)

    @property
    def level(self) -> float:
        """Friction level at rest, in units of the drive."""
        return float(self.levels.sum())

    def sticking(self, s: Segment, top_speed: float) -> tuple[Array, Array]:
        """Fraction of the level that sticks along a log, and its stiffness, each of shape (n,)."""
        sticks = np.abs(elastic_plastic(s.signals[:, Q], self.reaches)) < 1.0
        each = falls(np.abs(s.signals[:, V]) / top_speed) @ self.levels
        total = np.maximum(each.sum(axis=1), np.finfo(float).tiny)
        return (each * sticks).sum(axis=1) / total, (each * sticks) @ (1.0 / self.reaches)


@dataclass(frozen=True)
class LawBasis:
    """The regressors of laws along some logs."""

    prepared: Prepared

    @cached_property
    def reaches(self) -> Array:
        """Displacements from rest to slipping of the elements, rad (m), shape (k,), from what the
        position resolves up to a tenth of the travel."""
        span = self.prepared.span
        resolved = max(s.noise.resolution for s in self.prepared.segments)
        least = min(max(1e-5 * span, resolved), 0.1 * 0.1 * span)
        return np.geomspace(least, 0.1 * span, ELEMENTS)

    @cached_property
    def columns(self) -> Array:
        """Regressors of levels, by function of `falls` and element, and damping, (n, (2 + f) k)."""
        parts = (s.balanced(self._along(s)) for s in self.prepared.segments)
        return self.prepared.columns.get("law", lambda: np.concatenate(list(parts)))

    def _along(self, s: Segment) -> Array:
        z = elastic_plastic(s.signals[:, Q], self.reaches)
        v = s.signals[:, V]
        fall = falls(np.abs(v) / self.prepared.top_speed)
        levels = (fall[:, :, None] * z[:, None, :]).reshape(len(v), -1)
        return np.hstack([levels, (np.abs(z) < 1.0) * v[:, None]])

    def fitted(
        self, nominal: Shape, terms: tuple[Term, ...], weight: Array, damped: bool = True
    ) -> LinearLaw:
        """Least-squares fit of the law, damped or not, together with some terms, which may follow a
        nominal law, with a weight of each kept sample, shape (n,)."""
        others, y = Balance(self.prepared, nominal, terms).columns(nominal, terms)
        names = layout_of(self.prepared, nominal, terms).base
        others = np.delete(others, [names.index(x) for x in ("Fc", "sigma1") if x in names], 1)
        known = len(set(names) & {"load", "sigma2"})
        free = others[:, known:]  # coefficients of terms can have either sign
        own = self.columns
        if not damped:
            own = own[:, : -len(self.reaches)]
        X = np.hstack([own, others[:, :known], free, -free])
        size = lengths(X * weight[:, None])
        R = np.asarray(np.linalg.qr(np.column_stack([X / size, y]) * weight[:, None], mode="r"))
        beta = nnls(R[:, :-1], R[:, -1], maxiter=20 * X.shape[1])[0] / size
        residual = y - X @ beta
        of_law = beta[: own.shape[1]].reshape(-1, len(self.reaches))
        rms = root_mean_square(residual * weight)
        return LinearLaw(self.reaches, of_law[:-1] if damped else of_law, rms, residual)


def top_speed(segments: Sequence[Segment]) -> float:
    """Top speed of logs without the fastest 1% of samples of each, rad/s (m/s); 1 if none move."""
    return float(np.max([np.quantile(np.abs(s.signals[:, V]), 0.99) for s in segments])) or 1.0


def plain_friction(s: Segment, top: float) -> Array:
    """A smooth sign of the velocity, and elastic-plastic elements, shape (n, 7)."""
    q, v = s.signals[:, Q], s.signals[:, V]
    # below 2% of the top speed friction is changing its side
    side = np.clip(v / (0.02 * top), -1.0, 1.0)
    reaches = _REACHES * (float(np.ptp(q)) or 1.0)
    return np.column_stack([side, elastic_plastic(q, reaches)])
