"""Where a search is, and what decides whether its model needs an effect."""

from dataclasses import dataclass, field, replace
from functools import cached_property

from frictionjoint.diagnose.blocks import Blocks, make_blocks
from frictionjoint.diagnose.decisions import (
    APART,
    DISCREPANCY,
    DRIVE_DISCREPANCY,
    SMALLEST_GAIN,
    TIE,
)
from frictionjoint.diagnose.finding import Finding
from frictionjoint.diagnose.library import Candidate, library
from frictionjoint.diagnose.moves import Look
from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.diagnose.score import Scored
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import ROUGH, nearer, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import DriveTerm, Term, all_but

# of a search that only compares models
_TRIED_STEPS = 8


@dataclass(frozen=True)
class _Model:
    """A model of some logs, and what is asked of it more than once."""

    prepared: Prepared
    fit: Fit

    @cached_property
    def blocks(self) -> Blocks:
        """Without where the law may be wrong."""
        return make_blocks(self.prepared, self.fit)

    @cached_property
    def candidates(self) -> list[Candidate]:
        """What it may lack."""
        return library(self.prepared, self.fit, self.blocks)


@dataclass
class State:
    """Where a search is.

    Attributes:
        prepared: the logs as they are weighted now. fit: the model. findings: what was found.
        look: what was looked at last. laws: other ones beside its own.
        law_errs: whether the score leaves out where the law may be wrong, see
            `OtherLaws.errors`. What is found so is no error of the law; what only another law would
            explain as well, an effect may be after all, and is looked for afterwards.
    """

    prepared: Prepared
    fit: Fit
    findings: list[Finding]
    look: Look
    laws: OtherLaws
    law_errs: bool = True
    _known: _Model | None = field(default=None, repr=False)

    @property
    def blocks(self) -> Blocks:
        """Of the model as it is now."""
        return self._way(self._model)

    def blocks_of(self, prepared: Prepared, fitted: Fit) -> Blocks:
        """Of another model of these logs, which may be weighted otherwise."""
        return self._way(_Model(prepared, fitted))

    @property
    def either_way(self) -> tuple[Blocks, Blocks]:
        """Of the model as it is now, with and without where the law may be wrong."""
        own = self._model.blocks
        return replace(own, law_errors=self.laws.errors(self.fit)), own

    @property
    def candidates(self) -> list[Candidate]:
        """What the model as it is now may lack."""
        return self._model.candidates

    def under(self, prepared: Prepared) -> Fit:
        """The model fitted to its logs under other weights, from where it is, times and all."""
        return compared(prepared, self.fit.terms, self.fit.shape)

    def _way(self, model: _Model) -> Blocks:
        errors = self.laws.errors(model.fit) if self.law_errs else None
        return replace(model.blocks, law_errors=errors)

    @property
    def _model(self) -> _Model:
        """The model as it is now."""
        known = self._known
        if known is None or known.fit is not self.fit or known.prepared is not self.prepared:
            known = self._known = _Model(self.prepared, self.fit)
        return known

    def forget_dropped(self) -> None:
        """Keep only the findings of effects that the model still has."""
        names = {t.name for t in self.fit.effects}
        self.findings = [f for f in self.findings if f.term.name in names]


def compared(
    prepared: Prepared, terms: tuple[Term, ...], law: Shape, closeness: float = ROUGH
) -> Fit:
    """A model fitted as closely as comparing it needs."""
    return refit(prepared, terms, law, closeness, _TRIED_STEPS)


def without(state: State, term: Term) -> Fit:
    """The model without one of its effects."""
    return with_fewer(state, all_but(state.fit.effects, term))


def with_fewer(state: State, terms: tuple[Term, ...]) -> Fit:
    """The model with some of its effects, the law from the nearest of where it may start."""
    laws = state.laws.starts(state.fit.shape)
    return compared(state.prepared, terms, nearer(state.prepared, terms, laws))


def apart(one: Scored, other: Scored) -> bool:
    """Whether the logs distinguish a model from one that leaves more."""
    return one.better(other) and one.gain(other) >= APART


def as_much(one: Scored, other: Scored) -> bool:
    """Whether a model explains hardly less than another that leaves less."""
    return not other.better(one) or other.gain(one) < TIE


def needed(now: Scored, other: Scored, first: bool = False) -> bool:
    """Whether a model predicts better than another, and by more than the law's own error.

    That is measured by what remains: a law beside which hardly anything does is more exact than
    laws usually are. None is needed with a number that is impossible and not the other's too.

    Args:
        first: what it has besides comes first: it is known to be there, and only its size is not,
            so that to predict better at all is enough.
    """
    small = now.moved(other) < DISCREPANCY and now.gain(other) < 1.0 - TIE
    if small or now.impossible - other.impossible:
        return False
    if first:
        return now.better(other, 0.0)
    return now.gain(other) >= SMALLEST_GAIN and now.better(other)


def is_small(term: Term, now: Scored, other: Scored) -> bool:
    """Whether an effect of the drive moves less of it than a law that errs may ask of one."""
    return isinstance(term, DriveTerm) and now.of_drive(other) < DRIVE_DISCREPANCY


def numbers_of(term: Term) -> int:
    """How many numbers are estimated: the fewer, the simpler."""
    return len(term.coefficients) + len(term.free_shape)
