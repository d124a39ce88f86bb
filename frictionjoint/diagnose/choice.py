"""Selection among changes of a model, and the effects that tie with the selected one."""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from frictionjoint.decisions import SIGNIFICANCE, SMALLEST_GAIN, TIE
from frictionjoint.diagnose.moves import Move
from frictionjoint.diagnose.score import Scored
from frictionjoint.diagnose.state import distinguishable, improves, numbers_of
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.smooth import EncoderTerm
from frictionjoint.identify.terms import Term


class Tried(NamedTuple):
    """A change, the logs as weighted for its fit, and its score."""

    move: Move
    prepared: Prepared
    score: Scored


class Choice(NamedTuple):
    """The selected change, and names of effects that explain the logs equally well."""

    taken: Tried
    ties: tuple[str, ...] = ()


def chosen(now: Scored, tried: Sequence[Tried]) -> Choice | None:
    """The best justified change, and the effects it is tied with."""
    good = [t for t in tried if improves(t.score, now, _is_certain(t.move))]
    named = [t for t in good if not t.move.unnamed]
    singles = [t for t in named if len(t.move.added) == 1]
    best = _least(singles)
    pair = _least([t for t in named if len(t.move.added) > 1])
    # the second effect must explain enough to be accepted by itself
    if pair and (
        not best or (pair.score.better(best.score) and pair.score.gain(best.score) >= SMALLEST_GAIN)
    ):
        best = pair
    unnamed = _least([t for t in good if t.move.unnamed])
    # a curve adapts to any data, so it does not replace an effect that explains almost as much; it
    # may be added to it
    if unnamed and (not best or _much_before(unnamed, best, now)):
        return Choice(unnamed)
    if not best:
        return None
    if best is pair:
        return Choice(best)
    gain = best.score.gain(now)
    near = [
        t
        for t in singles
        if len(t.move.terms) == len(best.move.terms)
        and not distinguishable(best.score, t.score)
        and t.score.gain(now) >= (1.0 - TIE) * gain
    ]
    fewest = min(numbers_of(t.move.added[0].term) for t in near)
    simplest = best_of([t for t in near if numbers_of(t.move.added[0].term) == fewest], _total)
    (own,) = simplest.move.added
    others = (t.move.added[0] for t in near if t.move.added[0].term.name != own.term.name)
    ties = [other.term.name for other in others if not other.contains(own)]
    return Choice(simplest, tuple(ties))


def _is_certain(move: Move) -> bool:
    return all(c.term.effect.first for c in move.added)


def beyond_chance(move: Move) -> bool:
    """Whether a change is significant, over the whole family of candidates.

    Effects that are certain to exist are tested only for size.
    """
    asked = [move.seen.find(c.term).p_value for c in move.added if not c.term.effect.first]
    return min(asked, default=0.0) <= SIGNIFICANCE


def may_gain(move: Move) -> bool:
    """Whether a change may reduce the residual enough once it is refitted.

    A refit gains up to 2.7 times what screening predicts (177 refits on 15 test joints).
    """
    return _is_certain(move) or move.seen.gain(move) >= SMALLEST_GAIN / 3.0


def _much_before(unnamed: Tried, best: Tried, now: Scored) -> bool:
    """Whether an unnamed dependence explains so much that the best effect is only a part of it."""
    enough = (1.0 - TIE) * unnamed.score.gain(now)
    # an error of the encoder is a wave, not a curve that adapts to any data
    wave = isinstance(unnamed.move.added[0].term, EncoderTerm)
    clearly = unnamed.score.better if wave else partial(improves, unnamed.score)
    return clearly(best.score) and best.score.gain(now) < enough


def rivals_of(taken: Tried, tried: Sequence[Tried], now: Scored) -> tuple[Term, ...]:
    """Other effects that explain nearly as much."""
    least = (1.0 - TIE) * taken.score.gain(now)
    return tuple(
        t.move.added[0].term
        for t in tried
        if t is not taken and len(t.move.added) == 1 and not t.move.unnamed
        if t.score.gain(now) >= least
    )


def _least(tried: Sequence[Tried]) -> Tried | None:
    return best_of(tried, _total) if tried else None


def _total(tried: Tried) -> float:
    return tried.score.total
