"""The numbers of a fitted model as one vector: law, effects, controller, motor, inertia."""

from collections import Counter
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import LOAD, inertia_of
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.layout import layout_of
from frictionjoint.identify.rounding import rounded
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import DriveTiming, EffectTerm, Timing

# standard deviation of a prior from earlier logs: in their standard errors, which leave out what is
# wrong in every log alike, and over the number itself
PRIOR_ERRORS, PRIOR_SIZE = 10.0, 0.5


def with_term(prepared: Prepared, fitted: Fit, term: EffectTerm, coefficients: Array) -> Fit:
    """A fit with one more effect, with given coefficients, N m.

    A damping of the law that belongs to the effect starts at zero, see `layout_of`.
    """
    terms = (*fitted.terms, term)
    layout = layout_of(prepared, fitted.shape, terms)
    known = dict(zip(fitted.names, fitted.beta, strict=True))
    names = layout.names[layout.linear]
    beta = np.array([known.get(name, 0.0) for name in names])
    beta[layout.coefficients(len(terms) - 1)] = coefficients / fitted.gain
    return replace(fitted, terms=terms, layout=layout, beta=beta)


class Vector:
    """Numbers that a refinement varies, in this order: gain, coefficients, law, shape numbers.

    Args:
        prepared: the logs of the fit. fitted: defines names and structure. cov: of its parameters,
            in the order of its Jacobian. armature: of the MJCF: the sum is never negative.
        begin: a fit with the same structure as the start; None: `fitted`.
    Attributes:
        start: start of the search, shape (p,). low, high: bounds. unit: of the prior. All are
            rounded: a simulation in which a joint sticks is not continuous, and a search would
            carry the last bit of a fit into the second digit of its result.
    """

    def __init__(
        self, prepared: Prepared, fitted: Fit, cov: Array, armature: float, begin: Fit | None = None
    ) -> None:
        self.armature = armature
        self.fitted = fitted
        self.layout = fitted.layout
        self.has_gain = "load" in fitted.names
        self.low, self.high = (rounded(x) for x in self._bounds(prepared))
        self.start = rounded(self._of(begin or fitted))
        error = np.sqrt(np.maximum(np.diag(cov), 0.0))
        error[: self.layout.linear.stop] *= fitted.gain
        if self.has_gain:
            error[0] *= 1.0 / abs(fitted.beta[0]) / fitted.gain
        size = np.maximum(np.abs(self.start), 1e-12)
        # a level that the balance puts at zero may still improve the motion
        levels = slice(self.has_gain, len(self.layout.base))
        names = fitted.names[levels]
        # where the torque fit found no level
        torque = 0.05 * fitted.target_rms
        least = [torque if n == "Fc" else torque / prepared.top_speed for n in names]
        size[levels] = np.maximum(size[levels], least)
        if self.has_gain:
            size[0] = 1.0
        # the law's numbers are logarithms and ratios
        at = self.layout.shape
        size[at] = np.maximum(size[at], 1.0)
        error = np.where(np.isfinite(error), error, np.inf)
        # an inertia's error is one of the whole, of which a delay leaves little in the balance
        for i, term in enumerate(fitted.terms):
            if term.effect.is_inertia:
                at = self.layout.coefficients(i)
                whole = max(inertia_of(s.signals, LOAD) for s in prepared.segments)
                size[at], error[at] = np.maximum(size[at], whole), np.inf
        self.unit: Array = np.clip(PRIOR_ERRORS * error, 0.05 * size, PRIOR_SIZE * size)
        # a lag of nothing in the balance is as open as when in its steps a simulation acts
        for i, term in enumerate(fitted.terms):
            if isinstance(term, Timing):
                at = self.layout.numbers(i)
                # s: a simulation in steps of 1 ms holds a torque for half a step on average
                self.unit[at] = np.maximum(self.unit[at], 0.5e-3)
        self.unit = rounded(self.unit)

    def _of(self, fitted: Fit) -> Array:
        """Numbers of a fit with this structure, within the bounds, shape (p,)."""
        linear = fitted.beta[self.has_gain :] * fitted.gain
        gain = [np.log(fitted.gain)] if self.has_gain else []
        law = fitted.shape.vector()
        shapes = [n for t in fitted.terms for n in t.free_shape]
        found = np.array([*gain, *linear, *law, *shapes])
        return np.asarray(np.clip(found, self.low, self.high))

    def _bounds(self, prepared: Prepared) -> tuple[Array, Array]:
        pairs = [(-np.inf, np.inf)] * self.has_gain
        names = self.fitted.names[self.has_gain : len(self.layout.base)]
        # a law has a level, however small
        least_level = 1e-6 * self.fitted.target_rms
        pairs += [(least_level if name == "Fc" else 0.0, np.inf) for name in names]
        for term in self.fitted.terms:
            bounds = () if term.effect.of_inertia else term.effect.bounds
            least = -self.armature if term.effect.is_inertia else -np.inf
            pairs += bounds or ((least, np.inf),) * len(term.coefficients)
        of_law = self.fitted.shape.bounds(prepared.bounding_speed, prepared.span)
        pairs += zip(*of_law, strict=True)
        for term in self.fitted.terms:
            # a length, a speed or a frequency is not zero
            limits, scale = term.limits, 1e-3
            if isinstance(term, DriveTiming):  # a simulation knows no torque before its cause
                limits, scale = ((0.0, 0.05),), 0.0
            for x, (least, most) in zip(term.free_shape, limits, strict=True):
                pairs.append((max(least, scale * x) if least == 0.0 else least, most))
        low, high = np.array(pairs).T
        return low, high

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers, shape (p,); those of a term contain its name, which is unique."""
        count: Counter[str] = Counter()
        places: dict[str, str] = {}
        for i, term in enumerate(self.layout.terms):
            places[str(i)] = f"{term.name} {count[term.name]}"
            count[term.name] += 1
        split = (name.partition(".") for name in self.layout.names)
        return tuple(f"{places.get(first, first)}{dot}{rest}" for first, dot, rest in split)

    def carried(self, other: "Vector", values: Array) -> Array:
        """Numbers of another model's vector in this one; numbers that it lacks keep their start."""
        known = dict(zip(other.names, values, strict=True))
        pairs = zip(self.names, self.start, strict=True)
        found: Array = np.array([known.get(name, x) for name, x in pairs])
        return np.clip(found, self.low, self.high)

    def covariance(self, cov: Array) -> Array:
        """Covariance of a fit's own parameters, converted to this vector, shape (p, p).

        Undetermined numbers get no variance.
        """
        silent = ~np.isfinite(np.diag(cov))
        known = np.where(np.isfinite(cov), cov, 0.0)
        known[silent] = known[:, silent] = 0.0
        slopes = self._slopes(self.fitted)
        return np.asarray(slopes @ known @ slopes.T)

    def own_covariance(self, fitted: Fit, cov: Array) -> Array:
        """Covariance of the numbers, converted to a fit's own parameters, (p, p)."""
        slopes = np.linalg.inv(self._slopes(fitted))
        return np.asarray(slopes @ cov @ slopes.T)

    def _slopes(self, fitted: Fit) -> Array:
        """Derivatives of the numbers by a fit's own parameters, shape (p, p).

        A fit has the reciprocal of the gain, and coefficients in N m divided by the gain.
        """
        slopes, n = np.eye(len(self.layout.names)), self.layout.linear.stop
        slopes[range(n), range(n)] = fitted.gain
        if self.has_gain:
            slopes[:n, 0] = -(fitted.gain**2) * fitted.beta
            slopes[0, 0] = -fitted.gain
        return slopes

    def fit(self, x: Array) -> Fit:
        """The model at a point; its residual and Jacobian are those of the torque fit."""
        f, k = self.fitted, int(self.has_gain)
        gain = float(np.exp(x[0])) if k else f.gain
        n = self.layout.linear.stop
        beta = np.concatenate([[1.0] * k, x[k:n]]) / gain
        terms = replace(self.layout, terms=f.terms).moved_terms(x[n:])
        shape = f.shape.moved(x[self.layout.shape])
        return replace(f, shape=shape, terms=terms, beta=beta, gain=gain)
