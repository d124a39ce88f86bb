"""A candidate of a search: a term with its columns."""

from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.smooth import SmoothTerm
from frictionjoint.identify.terms import EffectTerm, Term


@dataclass(frozen=True)
class Candidate:
    """A term with its columns on the kept samples.

    Attributes:
        term: effect with given shape numbers, or an unnamed dependence.
        columns: after the torque filter, N m per coefficient, shape (n, k).
        bounds: of each coefficient, N m; none if empty.
        among: number of lines of the residual's spectrum that it was chosen from.
        begun: columns of its possible state at the start of each log, shape (n, m); None: no state.
    """

    term: Term
    columns: Array
    bounds: tuple[tuple[float, float], ...] = ()
    among: float = 1.0
    begun: Array | None = None

    @property
    def unnamed(self) -> bool:
        """Whether it is a dependence without a physical name."""
        return is_unnamed(self.term)

    def contains(self, other: "Candidate") -> bool:
        """Whether another candidate is this one with some coefficients fixed."""
        left = np.linalg.lstsq(self.columns, other.columns, rcond=None)[0]
        rest = other.columns - self.columns @ left
        return bool(np.linalg.norm(rest) < 1e-3 * np.linalg.norm(other.columns))


def without_columns(term: Term) -> Candidate:
    """A term as a candidate that is fitted, not screened by columns."""
    return Candidate(term, np.zeros((0, 0)))


def kind_of(term: Term) -> tuple[str, str]:
    """Key that is common to all shapes of one effect."""
    return term.name, "effect" if isinstance(term, EffectTerm) else type(term).__name__


def is_unnamed(term: Term) -> bool:
    """Whether a term is a dependence without a physical name."""
    return isinstance(term, SmoothTerm)


def named_of(terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """Terms with a physical name."""
    return tuple(t for t in terms if not is_unnamed(t))
