"""Candidates of a search: terms with their columns on the kept samples of the logs."""

from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import MOTOR
from frictionjoint.identify.design import columns_of_term
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.sensitivity import full_signals
from frictionjoint.identify.smooth import SmoothTerm
from frictionjoint.identify.terms import EffectTerm, Term


@dataclass(frozen=True)
class Candidate:
    """A term with its columns on the kept samples."""

    term: Term  # effect with given shape numbers, or an unnamed dependence
    columns: Array  # after the torque filter, N m per coefficient, shape (n, k)
    bounds: tuple[tuple[float, float], ...] = ()  # of each coefficient, N m; none if empty
    among: float = 1.0  # number of lines of the residual's spectrum that it was chosen from
    # columns of its possible state at the start of each log, shape (n, m); None: no state
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


def signals_of(prepared: Prepared, fitted: Fit) -> list[Array]:
    """Signals of each log under the fitted law; the torque of a motor under the whole model."""
    found = full_signals(prepared, fitted.shape, *fitted.levels)
    if not prepared.gain_unknown:
        return found
    for s, signals in zip(prepared.segments, found, strict=True):
        # with all columns made first: a term may look at the torque of the law
        signals[:, MOTOR] += sum(
            [
                term.columns(s, signals) @ fitted.term_coefficients(i)
                for i, term in enumerate(fitted.terms)
                if term.coefficients and not term.effect.on_motor
            ],
            np.zeros(len(signals)),
        )
    return found


def columns_of(prepared: Prepared, signals: list[Array], term: Term) -> Array:
    """Columns of a term on the kept samples of all logs.

    A delay shifts the drive and has no column of its own; its first order is the rate of the drive.
    """
    if not term.coefficients:
        parts = [s.balanced_drive(0.0, 1) for s in prepared.segments]
        return np.concatenate(parts)[:, None]
    (whole,) = prepared.bundles(1)

    def made() -> Array:
        return columns_of_term(term, signals, whole)

    # what no fit changes is looked at again and again
    fixed = isinstance(term, EffectTerm) and not (term.follows_law or term.effect.on_motor)
    if not fixed:
        return made()
    swings = tuple(s.swing for s in prepared.segments)
    return prepared.columns.get(("term", term, swings), made)
