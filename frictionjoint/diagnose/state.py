"""State of a search, and the criteria for accepting an effect."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import APART, LEAST_MOVED, LEAST_MOVED_OF_DRIVE, SMALLEST_GAIN, TIE
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.finding import Finding, finding_of
from frictionjoint.diagnose.library import library
from frictionjoint.diagnose.moves import Kind, Look, Move
from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.diagnose.score import Scored
from frictionjoint.identify.blocks import Blocks, make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import ROUGH, nearer, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.starts import COMPARING_STEPS
from frictionjoint.identify.terms import DriveTerm, Term, Timing, all_but

# changes of a model after which a search ends
MOST_CHANGES = 16


@dataclass(frozen=True)
class _Model:
    """A model of some logs, with results that are used more than once."""

    prepared: Prepared
    fit: Fit
    # changes that were made and taken back, because nothing that they added was needed
    refused: set[Kind] = field(default_factory=set)

    @cached_property
    def blocks(self) -> Blocks:
        """Blocks without the direction of possible errors of the law."""
        return make_blocks(self.prepared, self.fit)

    @cached_property
    def candidates(self) -> list[Candidate]:
        """Effects that it may lack."""
        return library(self.prepared, self.fit, self.blocks)


@dataclass
class State:
    """State of a search."""

    prepared: Prepared  # the logs with their present weights
    fit: Fit  # the model
    findings: list[Finding]  # accepted effects
    look: Look  # the last step
    laws: OtherLaws
    # whether the score excludes the direction of possible errors of the law, see
    # `OtherLaws.errors`: effects found this way are no errors of the law; effects that another law
    # could imitate are looked for afterwards
    law_errs: bool = True
    # torque of dependences without a name that were removed from the model, N m, shape (n, 1) each,
    # at the samples of the logs: the score excludes these directions, because what is known to be
    # missing is no evidence against the effects that are named
    unnamed: tuple[Array, ...] = ()
    # by name, why an effect was removed from the model
    left_out: dict[str, str] = field(default_factory=dict, repr=False)
    # the same of effects removed from a finished model, which are not added again
    excluded: dict[str, str] = field(default_factory=dict, repr=False)
    _known: _Model | None = field(default=None, repr=False)

    @property
    def blocks(self) -> Blocks:
        """Blocks of the present model."""
        return self._way(self._model)

    def blocks_of(self, prepared: Prepared, fitted: Fit) -> Blocks:
        """Blocks for another model of these logs, which may weight the samples differently."""
        return self._way(_Model(prepared, fitted))

    @property
    def either_way(self) -> tuple[Blocks, Blocks]:
        """Blocks of the present model, with and without the direction of the law's errors."""
        own = self._model.blocks
        return self._apart_from(own, self.laws.errors(self.fit)), self._apart_from(own)

    @property
    def candidates(self) -> list[Candidate]:
        """Effects that the present model may lack."""
        return self._model.candidates

    def refuse(self, move: Move) -> None:
        """Do not try a change of the present model again."""
        self._model.refused.add(move.kind)

    def refuses(self, move: Move) -> bool:
        """Whether a change was taken back, or adds an effect that a finished model did without."""
        again = any(c.term.name in self.excluded for c in move.added)
        return again or move.kind in self._model.refused

    def under(self, prepared: Prepared) -> Fit:
        """The model refitted to its logs with other weights, including its time offsets."""
        return compared(prepared, self.fit.terms, self.fit.shape)

    def _way(self, model: _Model) -> Blocks:
        errors = (self.laws.errors(model.fit),) if self.law_errs else ()
        return self._apart_from(model.blocks, *errors)

    def _apart_from(self, blocks: Blocks, *errors: Array) -> Blocks:
        """The blocks with some directions of errors, and with `unnamed`."""
        directions = (*errors, *self.unnamed)
        return replace(blocks, law_errors=np.hstack(directions)) if directions else blocks

    @property
    def _model(self) -> _Model:
        known = self._known
        if known is None or known.fit is not self.fit or known.prepared is not self.prepared:
            known = self._known = _Model(self.prepared, self.fit)
        return known

    def forget_dropped(self) -> None:
        """Keep only the findings of effects that the model still contains."""
        kept = [finding_of(self.findings, t) for t in self.fit.effects]
        self.findings = [f for f in self.findings if any(f is k for k in kept)]


def compared(
    prepared: Prepared, terms: tuple[Term, ...], law: Shape, closeness: float = ROUGH
) -> Fit:
    """A model fitted with the accuracy that a comparison needs."""
    return refit(prepared, terms, law, closeness, COMPARING_STEPS)


def without(state: State, term: Term) -> Fit:
    """The model without one of its effects."""
    return with_fewer(state, all_but(state.fit.effects, term))


def with_fewer(state: State, terms: tuple[Term, ...]) -> Fit:
    """The model with some of its effects; the law starts from its nearest starting shape."""
    laws = state.laws.starts(state.fit.shape)
    return compared(state.prepared, terms, nearer(state.prepared, terms, laws))


def distinguishable(one: Scored, other: Scored) -> bool:
    """Whether the logs distinguish a model from one with a larger residual."""
    return one.better(other) and one.gain(other) >= APART


def as_good(one: Scored, other: Scored) -> bool:
    """Whether a model is almost as good as another with a smaller residual."""
    return not other.better(one) or other.gain(one) < TIE


def improves(now: Scored, other: Scored, first: bool = False) -> bool:
    """Whether a model predicts better than another, by more than the law's own error.

    The residual measures that error: a law with a tiny residual is more exact than laws usually
    are. A model with an impossible number that the other one does not have is never accepted.

    Args:
        first: whether its additional effect is certain to exist. Then any better prediction
            suffices.
    """
    small = now.moved(other) < LEAST_MOVED and now.gain(other) < 1.0 - TIE
    if small or now.impossible - other.impossible:
        return False
    if first:
        return now.better(other, 0.0)
    return now.gain(other) >= SMALLEST_GAIN and now.better(other)


def is_small(term: Term, now: Scored, other: Scored) -> bool:
    """Whether an effect of the drive is below the error of a law, or any effect below that of a
    drive computed from a controller's file."""
    of_drive = isinstance(term, DriveTerm) or (now.fit.commanded and not term.effect.first)
    return of_drive and now.of_drive(other) < LEAST_MOVED_OF_DRIVE


def numbers_of(term: Term) -> int:
    """Number of estimated parameters; the model with fewer is the simpler one."""
    return len(term.coefficients) + len(term.free_shape)


def size_of(fitted: Fit) -> int:
    """Number of estimated parameters of all effects, and of time offsets beyond half a sample,
    which may stand for another effect."""
    late = sum(isinstance(t, Timing) and t.is_long for t in fitted.terms)
    return late + sum(map(numbers_of, fitted.effects))
