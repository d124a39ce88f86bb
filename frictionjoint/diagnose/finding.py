"""Outcome of the search: effects with their evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

from frictionjoint.diagnose.detection_limit import DetectionLimit
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.diagnose.other_laws import Comparison
from frictionjoint.effects.effect import Effect
from frictionjoint.identify.fit import Fit, without_scale
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.smooth import NotGiven, as_delivered
from frictionjoint.identify.terms import Term


@dataclass(frozen=True)
class Finding:
    """An effect that was added to the model."""

    term: Term  # with its final shape
    look: Look = field(repr=False)  # all candidates of the step that chose it
    row: Looked = field(repr=False)  # its own
    # fraction of the squared residual that it removes from motion unlike the motion it was fitted
    # to; its shape numbers were chosen without that motion too
    gain: float
    ties: tuple[str, ...]  # effects that the logs cannot distinguish from it
    rivals: tuple[Term, ...]  # effects nearly as good
    fit: Fit = field(repr=False)  # the model right after it was added
    forms: tuple[Effect, ...] = ()  # its other forms that explain as much
    # the best other effect fitted in its place on the final model, and the difference of their
    # gains; None: see `look`
    against: tuple[str, float] | None = None

    @property
    def runner_up(self) -> tuple[str | None, float]:
        """Name of the next best effect, and the difference of the gains."""
        if self.against:
            return self.against
        rows = (r for r in self.look.rows if not r.candidate.unnamed and r.name != self.term.name)
        runner = next(rows, None)
        gain = self.look.gain(runner) if runner else 0.0
        return runner and runner.name, self.look.gain(self.row) - gain

    def tied_with(self, term: Term) -> Self:
        """The finding with one more tie; another wave of the same effect is not a tie."""
        if term.name in (self.term.name, *self.ties):
            return self
        rivals = tuple(t for t in self.rivals if t.name != term.name)
        return replace(self, ties=(*self.ties, term.name), rivals=(*rivals, term))


def finding_of(findings: Sequence[Finding], term: Term) -> Finding:
    """The finding of an effect of a model.

    Several waves share a name and were added one by one; each has the one of the nearest wave.
    """
    alike = [f for f in findings if f.term.name == term.name]
    if not term.effect.is_wave:
        return alike[-1]
    return min(alike, key=lambda f: abs(f.term.shape[0] - term.shape[0]))


@dataclass(frozen=True)
class Trace:
    """Outcome of the search."""

    prepared: Prepared  # the logs with their final weights
    base: Fit  # of the law alone
    findings: tuple[Finding, ...]  # added effects in order
    final: Fit
    # quantities on which the residual depends without a named effect, with the fraction of the
    # squared residual that they explain
    unexplained: tuple[tuple[str, float], ...]
    hints: tuple[str, ...]  # possible causes of these, one sentence each
    last_look: Look  # candidates against the final residual
    other_laws: Comparison  # the final effects with each other law
    detection_limit: DetectionLimit
    not_given: tuple[NotGiven, ...] = ()  # measured torque that did not act
    causes: Mapping[str, str] = field(default_factory=dict)  # of `unexplained`, where known

    def as_fitted(self, kept_back: Prepared) -> Prepared:
        """Held-out logs, corrected for the instrument errors that were found in the fitted logs."""
        if self.prepared.band.sensor_saturates:
            kept_back = kept_back.without_limits()
        return as_delivered(kept_back, self.not_given)

    def without_scale(self) -> "Trace":
        """The trace in units of the drive, if the logs do not determine the gain."""
        return replace(
            self,
            base=without_scale(self.base),
            findings=tuple(replace(f, fit=without_scale(f.fit)) for f in self.findings),
            final=without_scale(self.final),
            other_laws=self.other_laws.over(self.final.gain),
            detection_limit=self.detection_limit.over(self.final.gain),
        )
