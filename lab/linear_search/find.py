"""What a joint's model lacks, as its definition reads.

fix the law's columns, the weights and the time offset;
of all sets of effects in which every one is needed, take the smallest that is not apart from
the best, and of those as good the one with the fewest numbers; the others are its ties;
settle the weights beside all that it may be, and look again, until the names repeat.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frictionjoint.identify.segment import Prepared
from linear_search.columns import Models, WiderFall, causes, is_cause, moves_drive
from linear_search.decisions import APART, AS_GOOD, NEEDED_PART
from linear_search.experiment import Experiment, experiment
from linear_search.sets import Set, Sets
from linear_search.shapes import free_numbers

# looks under weights that the last one settled, and sets that the next one begins with
_LOOKS, _BEGUN = 3, 4
# of an explanation that is as good within its error, squares over the least at most
_WITHIN_ERROR = 1.3
# part of a set's columns that another may leave and still hold them
_SAME = 1e-3
# part of the squares by which a wider fall of the law must be needed to stay beside effects
_LAW_NEEDED = 0.05


class Found(NamedTuple):
    """The set that was chosen, and those the logs cannot distinguish from it.

    Attributes:
        first: the experiment before anything was named. experiment: the one that decided.
    """

    first: Experiment
    experiment: Experiment
    sets: Sets
    chosen: Set
    alike: tuple[Set, ...]

    @property
    def ties(self) -> list[tuple[str, ...]]:
        """Names of other sets that explain as much."""
        others = [s.names for s in self.alike if s.names and s.names != self.chosen.names]
        return list(dict.fromkeys(others))


def find(prepared: Prepared) -> Found:
    """Which effects of the catalogue the logs of a joint show."""
    first = own = experiment(prepared)
    found = _look(first, first, ())
    for _ in range(_LOOKS - 1):
        if not found.chosen.names:
            break
        may_be = [found.chosen, *(s for s in found.alike if s.names != found.chosen.names)]
        every = {c: None for s in may_be for c in s.models}
        beside = np.hstack([found.sets.columns[c].torque for c in every])
        own = experiment(prepared, beside, any(map(moves_drive, every)), own)
        before, found = found, _look(first, own, [s.models for s in may_be[:_BEGUN]])
        if found.chosen.names == before.chosen.names:
            break
    return found


def _look(first: Experiment, own: Experiment, begun: Sequence[Models]) -> Found:
    sets = Sets(own)
    return _decided(first, sets, sets.explored(begun))


def _decided(first: Experiment, sets: Sets, found: list[Set]) -> Found:
    """The simplest of the sets that the logs do not distinguish from the best."""
    best = sets.nothing
    for size in range(1, sets.most + 1):
        same = [s for s in found if len(causes(s.models)) == size]
        if same and _takes_place(sets, best, same[0]):
            best = same[0]
    count = len(causes(best.models))
    alike = [s for s in found if len(causes(s.models)) == count and not _apart(sets, best, s)] or [
        best
    ]
    good = [
        s
        for s in alike
        if s.total < AS_GOOD * best.total
        or (sets.gain(s, best).errors < 1.0 and s.total < _WITHIN_ERROR * best.total)
    ]
    chosen = min(good or [best], key=lambda s: (_numbers(sets, s.models), s.total))
    others = [s for s in alike if s is chosen or not _contains(sets, s, chosen)]
    return Found(first, sets.experiment, sets, _with_law_named(sets, chosen), tuple(others))


def _contains(sets: Sets, larger: Set, one: Set) -> bool:
    """Whether a set is another with more numbers: then it is no other explanation."""
    if _numbers(sets, larger.models) <= _numbers(sets, one.models):
        return False
    x, y = (sets.score.stacked(s.models)[0] for s in (one, larger))
    Q, _ = np.linalg.qr(y)
    return bool(np.linalg.norm(x - Q @ (Q.T @ x)) < _SAME * np.linalg.norm(x))


def _takes_place(sets: Sets, fewer: Set, more: Set) -> bool:
    """Whether a larger set is chosen: it leaves clearly less, or adds to the smaller one."""
    found = sets.gain(fewer, more)
    if not fewer.names or (found.part > NEEDED_PART and found.errors > 1.0):
        return True
    return set(fewer.names) < set(more.names) and more.total < fewer.total


def _apart(sets: Sets, one: Set, other: Set) -> bool:
    """Whether the logs distinguish a set from another, which leaves more."""
    found = sets.gain(other, one)
    return found.errors > 1.0 and found.part > APART


def _with_law_named(sets: Sets, chosen: Set) -> Set:
    """Without a wider fall of the law where it is not needed, or where an effect has its name."""
    if not any(isinstance(c, WiderFall) for c in chosen.models):
        return chosen
    bare = tuple(c for c in chosen.models if is_cause(c))
    alone = sets.best(bare)
    found = sets.gain(alone, chosen)
    if found.errors < 1.0 or found.part < _LAW_NEEDED:
        return alone
    curved = sets.by_name.get("nonlinear-viscous", [])
    if curved and "nonlinear-viscous" not in chosen.names:
        instead = [sets.best((*bare, c)) for c in curved[:2]]
        best = min(instead, key=lambda s: s.total)
        if best.total < chosen.total and sets.holds(best):
            return best
    return chosen


def _numbers(sets: Sets, models: Models) -> int:
    """How many numbers are estimated: the fewer, the simpler."""
    return sum(
        sets.columns[c].torque.shape[1] + len(free_numbers(c)) for c in models if is_cause(c)
    )
