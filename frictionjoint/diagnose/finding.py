"""What the search found: effects with their evidence, and what these logs could have shown."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from scipy.special import chdtri

from frictionjoint.diagnose.blocks import correlation_time
from frictionjoint.diagnose.decisions import APART, DISCREPANCY, SMALLEST_GAIN
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.effects.effect import Effect
from frictionjoint.identify.fit import Fit, without_scale
from frictionjoint.identify.instruments import NotGiven, as_given
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import Term


@dataclass(frozen=True)
class Finding:
    """An effect that joined the model.

    Attributes:
        term: at its final shape. look: all candidates when it was chosen; row: its own.
        gain: fraction of the squares left that it takes from motion unlike that it was fitted to,
            its shape numbers chosen without that motion too.
        ties: effects that the logs cannot distinguish from it. rivals: effects nearly as good.
        fit: the model right after it joined. forms: its other forms that leave as much.
        against: the best other effect that was fitted in its place on the final model, and by how
            much more this one takes away, as a fraction; None: see `look`.
    """

    term: Term
    look: Look = field(repr=False)
    row: Looked = field(repr=False)
    gain: float
    ties: tuple[str, ...]
    rivals: tuple[Term, ...]
    fit: Fit = field(repr=False)
    forms: tuple[Effect, ...] = ()
    against: tuple[str, float] | None = None

    @property
    def runner_up(self) -> str | None:
        """Name of the next best effect."""
        runner = self._next_of_look
        return self.against[0] if self.against else runner and runner.name

    @property
    def margin(self) -> float:
        """Gain beyond the runner-up's."""
        if self.against:
            return self.against[1]
        runner = self._next_of_look
        return self.look.gain(self.row) - (self.look.gain(runner) if runner else 0.0)

    @property
    def _next_of_look(self) -> Looked | None:
        rows = (r for r in self.look.rows if not r.candidate.unnamed and r.name != self.term.name)
        return next(rows, None)

    def tied_with(self, term: Term) -> Self:
        """The same with an effect that explains as much; another wave of it is no other."""
        if term.name in (self.term.name, *self.ties):
            return self
        rivals = tuple(t for t in self.rivals if t.name != term.name)
        return replace(self, ties=(*self.ties, term.name), rivals=(*rivals, term))


def with_changed(
    findings: Sequence[Finding],
    effects: Sequence[Term],
    term: Term,
    change: Callable[[Finding], Finding],
) -> list[Finding]:
    """Findings of a model's effects with that of one term changed.

    Waves of a periodic effect, which have one name, came in one by one.
    """
    alike = [t for t in effects if t.name == term.name]
    places = [k for k, f in enumerate(findings) if f.term.name == term.name]
    at = places[min(alike.index(term), len(places) - 1)]
    return [change(f) if k == at else f for k, f in enumerate(findings)]


@dataclass(frozen=True)
class Sight:
    """The smallest effect that the logs would have shown.

    Attributes:
        torque: rms, N m. duration: s of the logs; needed: s of such motion that would show an
            effect that takes half of what is left.
    """

    torque: float
    duration: float
    needed: float

    @property
    def too_short(self) -> bool:
        """Whether even an effect that makes half of what is left would not have been found."""
        return self.needed > self.duration


@dataclass(frozen=True)
class Trace:
    """Outcome of the search.

    Attributes:
        prepared: the logs as they were weighted last.
        base: fit of the law alone. findings: additions in order. final: the last fit.
        unexplained: quantities without a named effect, with the fraction of squares they explain.
        hints: what those suggest, a sentence each.
        last_look: candidates against the final residual.
        other_laws: what each leaves in motion with the same additions, N m, least first.
        sight: what could have been seen.
        not_given: torque that the logs hold and that did not act.
    """

    prepared: Prepared
    base: Fit
    findings: tuple[Finding, ...]
    final: Fit
    unexplained: tuple[tuple[str, float], ...]
    hints: tuple[str, ...]
    last_look: Look
    other_laws: tuple[tuple[str, float], ...]
    sight: Sight
    not_given: tuple[NotGiven, ...] = ()

    def as_fitted(self, kept_back: Prepared) -> Prepared:
        """Logs held out with what was found of the instruments in those that were fitted."""
        if self.prepared.band.sensor_saturates:
            kept_back = kept_back.without_limits()
        return as_given(kept_back, self.not_given)

    def without_scale(self) -> "Trace":
        """The same in units of the drive, where the logs do not determine the gain."""
        return replace(
            self,
            base=without_scale(self.base),
            findings=tuple(replace(f, fit=without_scale(f.fit)) for f in self.findings),
            final=without_scale(self.final),
            other_laws=tuple((law, x / self.final.gain) for law, x in self.other_laws),
            sight=replace(self.sight, torque=self.sight.torque / self.final.gain),
        )


def sight(prepared: Prepared, fitted: Fit, look: Look) -> Sight:
    """What the logs could have shown.

    A score of blocks that are alike reaches at most their number, so an effect of fraction g gives
    about B g / (1 - g) for B independent blocks, and must exceed what chance reaches over the
    whole family.
    """
    e = fitted.residual * fitted.weight
    longest = max(correlation_time(e[fitted.log_index == i]) for i in np.unique(fitted.log_index))
    blocks = max(2.0, len(e) / (2.0 * longest))
    needed = float(chdtri(1, np.exp(-look.chance))) if look.chance > 0.0 else 0.0
    # of all that is asked of an effect what asks most: more than chance, a part of what is left,
    # and more than a law errs by
    fraction = max(needed / (needed + blocks), SMALLEST_GAIN)
    left = fitted.drive_rms * fitted.error_unit
    friction = float(np.sqrt(np.mean((fitted.friction * fitted.weight) ** 2)))
    duration = sum(len(s.drive) * s.dt for s in prepared.segments)
    enough = needed * (1.0 - APART) / APART
    return Sight(
        max(float(np.sqrt(fraction / (1.0 - fraction))) * left, DISCREPANCY * friction),
        duration,
        duration * enough / blocks,
    )
