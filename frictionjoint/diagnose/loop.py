"""The closed loop: fit, trace the residual, add an effect, refit, until nothing is justified."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.candidates import (
    effect_candidates,
    periodic_candidates,
    signals_of,
    smooth_candidates,
)
from frictionjoint.diagnose.trace import (
    FLIPS,
    Ranked,
    Ranking,
    margin,
    rank,
    selection_frequency,
)
from frictionjoint.identify.fit import Fit, fit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.terms import Term

Array = NDArray[np.float64]

SIGNIFICANCE = 0.05
# A gain below this changes the rms by under 1.5%: real or not, nobody's simulation gets better.
SMALLEST_GAIN = 0.03
# No friction law is exact. Against plants with other laws (GMS, LuGre, elasto-plastic) the base
# fit leaves 3 to 8% of the friction torque; effects that bend the friction curve pick up to 4% of
# it, those that act on its edges up to 2.4%. So an effect must move the torque by a share of the
# friction's rms to be named.
SMALLEST_SHARE = 0.015
_LARGER_SHARES = {
    "nonlinear-viscous": 0.05,
    "frictional-lag": 0.05,
    "dwell-time": 0.05,
    "backlash": 0.05,
    "joint-elasticity": 0.03,
    "measurement-delay": 0.03,
}
_LARGE_GAIN = 0.5
# Effects within this share of the best gain, and within chance of it, count as equals.
_CLOSE = 0.1
_MOST_STEPS = 8


@dataclass(frozen=True)
class Step:
    """One addition.

    Attributes:
        term: what was added (its shape as of the final fit is in the fit).
        evidence: the winner's row. runner_up: the next effect, or None.
        margin: difference in held-out gain to it. ties: effects the logs cannot tell from it.
        frequency: share of resamples in which it stayed best.
        fit: the model after the joint refit. ranking: all candidates of this step.
    """

    term: Term
    evidence: Ranked
    runner_up: str | None
    margin: float
    ties: tuple[str, ...]
    frequency: float
    fit: Fit
    ranking: Ranking


@dataclass(frozen=True)
class Trace:
    """Outcome of the loop.

    Attributes:
        base: fit of the law alone. steps: additions in order. final: the last fit.
        unexplained: smooth curves that still explain something, best first.
        last_ranking: candidates against the final residual.
    """

    base: Fit
    steps: tuple[Step, ...]
    final: Fit
    unexplained: tuple[Ranked, ...]
    last_ranking: Ranking


def trace(
    prepared: Prepared,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> Trace:
    """Run the loop on prepared logs; uses these logs only, split into folds.

    Args:
        seed: of flips and resampling; equal seeds give equal results.
        progress: told what is being done.
    """
    rng = np.random.default_rng(seed)
    progress("base fit")
    base = fit(prepared, progress=progress)
    current, steps = base, []
    ranking = None
    for number in range(_MOST_STEPS):
        progress(f"step {number + 1}: trying candidates")
        # A motor driven by a voltage has a back-EMF: that is asked first and alone, for without
        # it the gain of the drive, and with it every torque, is off.
        known = "back-emf" if prepared.voltage_driven and number == 0 else None
        ranking = _rank_all(prepared, current, rng, known)
        chosen = _choose(ranking, current, rng)
        if chosen is None:
            if known:
                continue
            break
        winner, ties = chosen
        progress(f"step {number + 1}: adding {winner.name}")
        terms = (*current.terms, winner.candidate.term)
        # after a large change the old shape may sit in another valley: start from everywhere
        start = current.shape if winner.held_out_gain < _LARGE_GAIN else None
        refitted = fit(prepared, terms, start=start)
        others = [r for r in ranking.ranked if r is not winner and not r.candidate.smooth]
        runner = others[0] if others else None
        gap = margin(winner, runner, ranking.base_squares, rng)[0] if runner else 0.0
        named = tuple(r for r in ranking.ranked if not r.candidate.smooth)
        frequency = selection_frequency(winner, named, rng)
        current = refitted
        steps.append(
            Step(
                winner.candidate.term,
                winner,
                runner.name if runner else None,
                gap,
                ties,
                frequency,
                current,
                ranking,
            )
        )
    else:
        ranking = _rank_all(prepared, current, rng)
    steps, current = _without_idle(prepared, steps, current)
    assert ranking is not None
    return Trace(base, tuple(steps), current, _unexplained(ranking), ranking)


def _rank_all(
    prepared: Prepared, current: Fit, rng: np.random.Generator, only: str | None = None
) -> Ranking:
    blocks = make_blocks(current.residual, current.log_index)
    signals = signals_of(prepared, current)
    found = effect_candidates(prepared, signals, current.terms)
    if only:
        found = [c for c in found if c.term.name == only]
        return rank(found, current.jacobian, current.residual, current.log_index, blocks, rng)
    found += periodic_candidates(prepared, signals, current.residual, blocks, rng, FLIPS)
    found += smooth_candidates(prepared, signals)
    return rank(found, current.jacobian, current.residual, current.log_index, blocks, rng)


def _justified(row: Ranked) -> bool:
    return row.p_value <= SIGNIFICANCE and row.held_out_gain >= SMALLEST_GAIN


def _large_enough(row: Ranked, current: Fit) -> bool:
    """Whether an effect moves the torque by a share of the friction worth naming."""
    at = [current.names.index(n) for n in ("Fc", "sigma2") if n in current.names]
    friction = current.jacobian[:, at] @ current.beta[at]
    moved = np.sqrt(row.held_out_gain) * current.rms
    least = _LARGER_SHARES.get(row.name, SMALLEST_SHARE)
    return bool(moved >= least * np.sqrt(np.mean(friction**2)))


def _choose(
    ranking: Ranking, current: Fit, rng: np.random.Generator
) -> tuple[Ranked, tuple[str, ...]] | None:
    """The effect to add and those it is tied with; the simplest of those that tie with the best."""
    named = [
        r
        for r in ranking.ranked
        if not r.candidate.smooth and _justified(r) and _large_enough(r, current)
    ]
    if not named:
        return None
    best = named[0]
    tied = [best]
    for row in named[1:]:
        gap, tie = margin(best, row, ranking.base_squares, rng)
        if tie and gap < _CLOSE * best.held_out_gain:
            tied.append(row)
    size = [len(r.coefficients) + len(r.candidate.term.shape) for r in tied]
    winner = tied[int(np.argmin(size))]
    ties = tuple(
        r.name for r, k in zip(tied, size, strict=True) if r is not winner and k == min(size)
    )
    return winner, ties


def _without_idle(prepared: Prepared, steps: list[Step], current: Fit) -> tuple[list[Step], Fit]:
    """Drop additions that the later ones have made idle."""
    changed = True
    while changed and len(steps) > 1:
        changed = False
        for i in range(len(steps) - 1):
            terms = tuple(t for k, t in enumerate(current.terms) if k != i)
            without = fit(prepared, terms, start=current.shape)
            if 1.0 - (current.rms / without.rms) ** 2 < SMALLEST_GAIN:
                steps = [s for k, s in enumerate(steps) if k != i]
                current, changed = without, True
                break
    return steps, current


def _unexplained(ranking: Ranking) -> tuple[Ranked, ...]:
    return tuple(r for r in ranking.ranked if r.candidate.smooth and _justified(r))
