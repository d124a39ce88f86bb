"""What to add to a model, of all that was ranked: by chance, by size and by what is simplest."""

from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.trace import Ranked, Ranking, margin
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.smooth import SmoothTerm
from frictionjoint.identify.terms import Term

SIGNIFICANCE = 0.05
# Share of the residual's squares that an effect must take away: what takes less beside a residual
# that stays is as likely a by-product of whatever else is in it. Effects that bend the law's own
# curves gain more by chance, since the law is fitted anew with them.
SMALLEST_GAIN = 0.08
_OTHER_GAINS = {"dwell-time": 0.1, "nonlinear-viscous": 0.12}
# No friction law is exact. Against plants with other laws (GMS, LuGre, elasto-plastic) the base
# fit leaves 1 to 5% of the friction torque; effects that act on the edges of friction pick up to
# 1.2% of it. So an effect must move the torque by a share of the friction's rms to be named.
SMALLEST_SHARE = 0.008
_OTHER_SHARES = {
    "dwell-time": 0.005,
    "measurement-delay": 0.009,
    "nonlinear-viscous": 0.003,
    "frictional-lag": 0.011,
    "backlash": 0.02,
    "joint-elasticity": 0.025,
}
# Effects that the law's own parameters, or the gain, take for themselves: what they explain shows
# only when both are fitted at once.
LAW_BOUND = frozenset(("dwell-time", "frictional-lag", "nonlinear-viscous", "motor-saturation"))
# How much more an effect must explain beside a curve that has no name.
_DOUBT = 2.0
LARGE_GAIN = 0.5
# Effects within this share of the best gain, and within chance of it, count as equals.
_CLOSE = 0.05
# Two effects nearer than these are one to these logs, whatever the resampling says: shares of what
# the better one explains, and of what it leaves.
SAME, _SAME_LEFT = 0.02, 0.25
# An effect that explains less than this share of what a curve explains is not the cause: in trials
# the true effect reached 0.93 and more.
ENOUGH = 0.9


class Choice(NamedTuple):
    """What to add.

    Attributes:
        winner: to be added. ties: effects that the logs cannot tell from it, as simple as it is.
        rivals: all other effects that explain nearly as much as the best one.
    """

    winner: Ranked
    ties: tuple[str, ...] = ()
    rivals: tuple[Ranked, ...] = ()


def choose(ranking: Ranking, current: Fit, rng: np.random.Generator) -> Choice | None:
    """What to add, and the effects it is tied with.

    The simplest of the effects that the logs cannot tell from the best one, those last that must
    go to the end of their physical range for it. Where a curve without a name explains much more
    than any effect, none is the cause: the curve stands in for it.
    """
    worth = [r for r in ranking.ranked if worth_naming(r, current)]
    named = [r for r in worth if not r.candidate.smooth]
    if any(isinstance(t, SmoothTerm) for t in current.terms):
        # something without a name is at work, and its by-products look like effects
        named = [r for r in named if r.held_out_gain >= _DOUBT * least_gain(r.name)]
        named = [r for r in named if _moved(r, current) >= _DOUBT * _least_share(r.name)]
    smooth = [r for r in worth if r.candidate.smooth]
    if smooth and (not named or named[0].held_out_gain < ENOUGH * smooth[0].held_out_gain):
        return Choice(smooth[0])
    if not named:
        return None
    best = named[0]
    near = [r for r in named if r.held_out_gain >= (1.0 - _CLOSE) * best.held_out_gain]
    close = [r for r in near if r is best or _tied(best, r, ranking.base_squares, rng)]
    size = [(r.on_edge, numbers_of(r.candidate.term)) for r in close]
    winner = close[size.index(min(size))]
    ties = tuple(
        r.name
        for r, k in zip(close, size, strict=True)
        if r is not winner and k == min(size) and _tied(winner, r, ranking.base_squares, rng)
    )
    return Choice(winner, ties, tuple(r for r in near if r is not winner))


def numbers_of(term: Term) -> int:
    """How many numbers it takes: the fewer, the simpler."""
    return len(term.coefficients) + len(term.shape)


def least_gain(name: str) -> float:
    """Share of the residual's squares that an effect must take away, by its name."""
    return _OTHER_GAINS.get(name, SMALLEST_GAIN)


def justified(row: Ranked) -> bool:
    """By chance, size and form: a law bent with no time or exponent of its own is another law."""
    if row.on_edge and row.name in LAW_BOUND:
        return False
    return beyond_chance(row) and row.held_out_gain >= least_gain(row.name)


def beyond_chance(row: Ranked) -> bool:
    """By the test, or by half of the residual predicted on folds it was not fitted to.

    What acts in a few blocks only, as an end stop does, cannot pass a test that flips their signs.
    """
    return row.p_value <= SIGNIFICANCE or row.held_out_gain >= LARGE_GAIN


def large_enough(row: Ranked, current: Fit) -> bool:
    """Whether an effect moves the torque by a share of the friction worth naming."""
    return _moved(row, current) >= _least_share(row.name)


def worth_naming(row: Ranked, current: Fit) -> bool:
    """By itself: beyond chance, by what it takes of the residual and by what it moves."""
    return justified(row) and large_enough(row, current)


def _least_share(name: str) -> float:
    return _OTHER_SHARES.get(name, SMALLEST_SHARE)


def _moved(row: Ranked, current: Fit) -> float:
    """Torque that it explains, over the friction's rms."""
    explained = np.sqrt(max(0.0, row.held_out_gain)) * current.rms
    return float(explained / np.sqrt(np.mean(current.friction**2)))


def _tied(winner: Ranked, other: Ranked, base: Array, rng: np.random.Generator) -> bool:
    gap, chance = margin(winner, other, base, rng)
    g = winner.held_out_gain
    return chance or gap < min(SAME * g, _SAME_LEFT * (1.0 - g))
