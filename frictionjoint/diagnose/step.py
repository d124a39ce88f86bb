"""One addition to a model, and what spoke for it."""

from dataclasses import dataclass

import numpy as np

from frictionjoint.diagnose.choice import Choice
from frictionjoint.diagnose.trace import Ranked, Ranking, margin, selection_frequency
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.terms import Term


@dataclass(frozen=True)
class Step:
    """One addition.

    Attributes:
        term: what was added (its shape as of the final fit is in the fit).
        evidence: the winner's row. runner_up: the next effect, or None.
        margin: difference in held-out gain to it. ties: effects the logs cannot tell from it.
        rivals: what explained nearly as much when it was added.
        frequency: share of resamples in which it stayed best.
        fit: the model after the joint refit. ranking: all candidates of this step.
    """

    term: Term
    evidence: Ranked
    runner_up: str | None
    margin: float
    ties: tuple[str, ...]
    rivals: tuple[Ranked, ...]
    frequency: float
    fit: Fit
    ranking: Ranking


def step_of(choice: Choice, fitted: Fit, ranking: Ranking, rng: np.random.Generator) -> Step:
    """The addition of what was chosen.

    Args:
        fitted: the model with it. ranking: all candidates it was chosen from.
    """
    winner = choice.winner
    others = [r for r in ranking.ranked if r is not winner and not r.candidate.smooth]
    runner = others[0] if others else None
    gap = margin(winner, runner, ranking.base_squares, rng)[0] if runner else 0.0
    kin = tuple(r for r in ranking.ranked if r.candidate.smooth == winner.candidate.smooth)
    return Step(
        winner.candidate.term,
        winner,
        runner.name if runner else None,
        gap,
        choice.ties,
        choice.rivals,
        selection_frequency(winner, kin, rng),
        fitted,
        ranking,
    )
