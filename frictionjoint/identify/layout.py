"""Index and range of each parameter of a model: linear coefficients, then nonlinear numbers."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import Term


@dataclass(frozen=True)
class Layout:
    """Parameters of a law with terms."""

    # of the law's linear coefficients: load (if the drive's gain is unknown), sigma2, Fc, sigma1
    base: tuple[str, ...]
    law: tuple[str, ...]  # names of the numbers of its shape
    terms: tuple[Term, ...]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters: `Fc`, `law.log Vs`, those of term i as `i.name`."""
        linear = [f"{i}.{c}" for i, t in enumerate(self.terms) for c in t.coefficients]
        shapes = [f"{i}.shape{k}" for i, t in enumerate(self.terms) for k in range(_free(t))]
        return (*self.base, *linear, *(f"law.{v}" for v in self.law), *shapes)

    @property
    def linear(self) -> slice:
        """Slice of all linear coefficients."""
        return slice(0, len(self.base) + sum(len(t.coefficients) for t in self.terms))

    @property
    def shape(self) -> slice:
        """Slice of the numbers of the law's shape."""
        return slice(self.linear.stop, self.linear.stop + len(self.law))

    def coefficients(self, i: int) -> slice:
        """Slice of the linear coefficients of term i."""
        first = len(self.base) + sum(len(t.coefficients) for t in self.terms[:i])
        return slice(first, first + len(self.terms[i].coefficients))

    def numbers(self, i: int) -> slice:
        """Slice of the free shape numbers of term i."""
        at, linear = self.searched(i), self.linear.stop
        return slice(linear + at.start, linear + at.stop)

    def searched(self, i: int) -> slice:
        """Slice of the free shape numbers of term i among the nonlinear numbers."""
        first = len(self.law) + sum(_free(t) for t in self.terms[:i])
        return slice(first, first + _free(self.terms[i]))

    def moved_terms(self, x: Array) -> tuple[Term, ...]:
        """The terms at other nonlinear numbers of the model, shape (k,)."""
        numbers = [tuple(x[self.searched(i)].tolist()) for i in range(len(self.terms))]
        pairs = zip(self.terms, numbers, strict=True)
        return tuple(term.with_shape(own) if own else term for term, own in pairs)

    def of_term(self, i: int) -> list[int]:
        """Indices of all parameters of term i."""
        whole = range(len(self.names))
        return [*whole[self.coefficients(i)], *whole[self.numbers(i)]]

    @cached_property
    def _tied(self) -> list[int]:
        """Indices of the coefficients of effects tied to the load's coefficient.

        A gap transmits the torque of the whole link. A free coefficient would measure how well the
        motion of the link can be predicted: if impacts scatter, least squares reduce it, and a
        model with a part of a link has no physical meaning.
        """
        tied = (i for i, term in enumerate(self.terms) if term.effect.of_load)
        return [k for i in tied for k in range(self.linear.stop)[self.coefficients(i)]]

    def with_load(self, X: Array) -> Array:
        """Columns by all or the linear parameters, shape (n, p), with those of tied effects zero
        and added to the load's column if the gain is unknown; `X` itself if there are none."""
        if not self._tied:
            return X
        found = X.copy()
        if "load" in self.base:
            found[:, self.base.index("load")] += X[:, self._tied].sum(axis=1)
        found[:, self._tied] = 0.0
        return found

    def less_load(self, X: Array, y: Array) -> Array:
        """A target minus the effects that are tied to a known load, shape (n,)."""
        known = self._tied and "load" not in self.base
        return y - X[:, self._tied].sum(axis=1) if known else y

    def with_sizes(self, beta: Array) -> Array:
        """Coefficients, with those of tied effects set from the load's, shape (k,)."""
        if self._tied:
            beta = beta.copy()
            beta[self._tied] = beta[self.base.index("load")] if "load" in self.base else 1.0
        return beta


def _free(term: Term) -> int:
    return len(term.free_shape)


def layout_of(prepared: Prepared, law: Shape, terms: tuple[Term, ...]) -> Layout:
    """Layout of a model of these logs.

    A voltage-driven joint has sigma2 only if the logs contain motion with the motor off: otherwise
    a torque linear in velocity is the effect `back-emf`, which a log of voltages cannot distinguish
    from viscous friction. It has sigma1 only with that effect in the model: on a soft transition
    curve this damping would imitate it.
    """
    voltage = prepared.voltage_driven
    damped = law.damped and (not voltage or any(t.effect.opposes_voltage for t in terms))
    used = {
        "load": prepared.gain_unknown,
        "sigma2": prepared.motor_off or not voltage,
        "Fc": True,
        "sigma1": damped,
    }
    return Layout(tuple(name for name, on in used.items() if on), law.variables, terms)


def term_bounds(prepared: Prepared, term: Term) -> list[tuple[float, float]]:
    """Range of each coefficient of a term, in units of the drive."""
    unit = 1.0
    if term.effect.of_inertia:
        unit = float(np.median([s.noise.inertia for s in prepared.segments]))
    # with an unknown gain only the sign of a bound survives
    survives = not prepared.gain_unknown or unit != 1.0
    return [
        (lo * unit if lo == 0.0 or survives else -np.inf, hi * unit if survives else np.inf)
        for lo, hi in term.bounds or ((-np.inf, np.inf),) * len(term.coefficients)
    ]
