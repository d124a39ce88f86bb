"""Sets of effects: which are looked at, what each leaves at its best, and which are needed.

A set is grown from the best few of one size less (a beam), so that no effect that was found first
can hide the others; best pairs are looked at for themselves.
"""

import itertools
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from linear_search.columns import Candidate, Columns, Models, WiderFall, causes, effects, kind
from linear_search.decisions import (
    CLEAR_ERRORS,
    CLEAR_TORQUE,
    DETERMINED,
    LEAST_TORQUE,
    NEEDED_BESIDE_DRIVE,
    NEEDED_OF_LAW_LIKE,
    NEEDED_PART,
)
from linear_search.experiment import Experiment
from linear_search.score import Gain, Score, gain
from linear_search.shapes import refined

# effects of a set at most, besides a back-EMF; sets that go on to the next size; sets of a size
# that are refined
_MOST, _BEAM, _REFINED = 3, 4, 8
# additions to a set that are tried: to the empty one, and to any other
_FIRST, _MORE = 6, 4
# shapes of an effect, best alone, that are tried in larger sets; pairs that are looked at
_SHAPES, _PAIRS = 6, 5
# squares over the least up to which a set is refined, and is one of those found
_NEAR, _FOUND = 1.6, 2.0
# what a wave's spectrum is proposed from again, under this name; waves in a set at most
_WAVE, _WAVES = "position-periodic", 2
# effects that resemble the law's own error at low speed and at rest
_LAW_LIKE = ("dwell-time", "frictional-lag")
_MORE_BESIDE_LEAPS = 0.4
# of a number's range, how near to its end is at it
_AT_ITS_END = 0.1


class Set(NamedTuple):
    """Candidates at their best shapes, and the squares of each block they leave, (B,)."""

    models: Models
    squares: Array

    @property
    def total(self) -> float:
        """Of all blocks."""
        return float(self.squares.sum())

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects, in order."""
        return tuple(sorted(t.name for t in causes(self.models)))


class Sets:
    """The sets of an experiment."""

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment
        self.columns = Columns(experiment)
        self.score = Score(self.columns)
        self.nothing = Set((), self.score.nothing)
        self.most = _MOST + (not experiment.basis.viscous)
        self.known: dict[tuple[tuple[str, int], ...], Set] = {}
        self.by_name: dict[str, list[Candidate]] = {}
        alone = [(float(self.score.held_out((c,)).sum()), c) for c in self.columns.candidates()]
        for _, candidate in sorted(alone, key=lambda x: x[0]):
            self.by_name.setdefault(candidate.name, []).append(candidate)

    def best(self, models: Models) -> Set:
        """A set at its best shapes, from where it is, or as it is known."""
        if not models:
            return self.nothing
        key = tuple(sorted(map(kind, models)))
        now = Set(models, self.score.held_out(models))
        known = self.known.get(key)
        if known and known.total <= 1.02 * now.total:
            return known
        there = refined(self.score, models)
        after = Set(there, self.score.held_out(there))
        found = min([s for s in (known, now, after) if s], key=lambda s: s.total)
        self.known[key] = found
        return found

    def gain(self, before: Set, after: Set) -> Gain:
        """What one set predicts better than another."""
        return gain(before.squares, after.squares, self.experiment.friction)

    def without(self, one: Set, candidate: Candidate) -> Set:
        """The best known set without one of its candidates, perhaps with a wider law instead."""
        rest = tuple(c for c in one.models if c is not candidate)
        instead = [rest]
        wide = any(isinstance(c, WiderFall) for c in one.models)
        # what a wider fall of the law explains as well is curved viscous friction or the law itself
        if not wide and candidate.name != "nonlinear-viscous" and "friction law" in self.by_name:
            instead.append((*rest, WiderFall()))
        names = [sorted(c.name for c in r) for r in instead]
        known = [s for s in self.known.values() if sorted(c.name for c in s.models) in names]
        return min([*known, *map(self.best, instead)], key=lambda s: s.total)

    def holds(self, one: Set) -> bool:
        """Whether every effect of a set is needed, determined and within its physical range."""
        own = causes(one.models)
        if not own or any(map(_at_its_end, own)) or self._same_wave(own):
            return False
        errors = self.over_errors(one)
        before = {c: self.without(one, c) for c in own}
        # beside what leaps, and no column holds exactly, more is asked
        leaps = {c: self.gain(before[c], one).torque for c in effects(own) if _is_inexact(c)}
        return all(
            errors[c] >= DETERMINED
            and self._needed(
                self.gain(before[c], one),
                self.part(c, own),
                sum(x for o, x in leaps.items() if o is not c),
            )
            for c in own
        )

    def part(self, candidate: Candidate, own: Models) -> float:
        """Part of what is left that an effect must explain beside the others of a set."""
        known = isinstance(candidate, EffectTerm) and candidate.effect.first
        if not known and any(isinstance(c, DriveTerm) for c in own if c is not candidate):
            return NEEDED_BESIDE_DRIVE
        return NEEDED_OF_LAW_LIKE if candidate.name in _LAW_LIKE else NEEDED_PART

    def _same_wave(self, some: Models) -> bool:
        """Whether two waves are one to the travel: closer than a line of the spectrum is wide."""
        orders = sorted(c.shape[0] for c in some if c.name == _WAVE)
        line = 2.0 * np.pi / self.experiment.prepared.span
        return bool(np.any(np.diff(orders) < line))

    def _needed(self, found: Gain, part: float, leaping: float) -> bool:
        if leaping > CLEAR_TORQUE:
            part = max(part, NEEDED_OF_LAW_LIKE)
        twice = 1.0 + (part >= NEEDED_BESIDE_DRIVE)
        large = twice * CLEAR_TORQUE + _MORE_BESIDE_LEAPS * leaping
        enough = found.part > part or (found.errors > CLEAR_ERRORS and found.torque > large)
        return found.errors > 1.0 and found.torque > LEAST_TORQUE and enough

    def over_errors(self, one: Set) -> dict[Candidate, float]:
        """Of each candidate the largest of its coefficients over its standard error.

        Errors are of blocks that are independent (a sandwich).
        """
        x, _, _, length = self.score.stacked(one.models)
        z, e = self.score.solve(one.models)
        n = len(self.experiment.target)
        moments = self.score.blocks.sums(x[:n] * e[:n, None])
        inverse = np.linalg.pinv(x.T @ x, 1e-9)
        variance = np.diag(inverse @ moments.T @ moments @ inverse)
        over = np.abs(z * length) / np.sqrt(np.maximum(variance, 1e-300))
        ends = np.cumsum([0, *(self.columns[c].torque.shape[1] for c in one.models)])
        return {
            c: float(over[i:j].max())
            for c, i, j in zip(one.models, ends[:-1], ends[1:], strict=True)
        }

    def explored(self, begun: Iterable[Models] = ()) -> list[Set]:
        """Sets whose effects are all needed, the one that leaves least first.

        Args:
            begun: sets found under other weights: these, and what is near them, are looked at.
        """
        found: list[Set] = []
        beam = [self.nothing]
        size = 0
        todo: dict[int, list[Models]] = {}
        for models in begun:
            todo.setdefault(len(models), []).append(models)
            for fewer in range(1, len(models)):
                todo.setdefault(fewer, []).extend(itertools.combinations(models, fewer))
            for c in models:
                rest = tuple(x for x in models if x is not c)
                for more in self._extended(rest, _MORE):
                    todo.setdefault(len(more), []).append(more)
        for size in sorted(todo):
            beam = self._level(todo[size], found)
        for larger in range(size + 1, self.most + 2):
            grown = [
                m for s in beam for m in self._extended(s.models, _MORE if s.models else _FIRST)
            ]
            if larger == 2:
                grown += self._pairs()
            if not grown:
                break
            beam = self._level(grown, found)
            if larger > 1 and not any(len(s.models) >= larger - 1 for s in found):
                break
        return sorted([*found, *self._better(found)], key=lambda s: s.total)

    def _better(self, found: list[Set]) -> list[Set]:
        """Sets that came to better shapes while larger ones were looked at."""
        better = []
        for size in {len(s.models) for s in found}:
            known = [s for s in self.known.values() if len(s.models) == size]
            least = min(s.total for s in known)
            known = [
                s for s in known if s.total < _FOUND * least and all(s is not f for f in found)
            ]
            better += [s for s in known if self.holds(s)]
        return better

    def _level(self, todo: list[Models], found: list[Set]) -> list[Set]:
        """Refine the most promising sets of one size; those that hold are found, the best go on."""
        rough = sorted(todo, key=self._rough)
        least = self._rough(rough[0])
        third = self._rough(rough[min(2, len(rough) - 1)])
        near = [m for m in rough[:_REFINED] if self._rough(m) <= max(_NEAR * least, third)]
        # forms of what is refined
        names = {c.name for (c, *_) in near}
        if len(rough[0]) == 1:
            near += [m for m in rough[_REFINED:] if m[0].name in names]
            near += [m for m in rough[:_REFINED] if m not in near and m[0].name in names]
        best: dict[tuple[tuple[str, str], ...], Set] = {}
        for models in near:
            one = self.best(models)
            forms = tuple(sorted(map(kind, one.models)))
            best[forms] = min(one, best.get(forms, one), key=lambda s: s.total)
        top = sorted(best.values(), key=lambda s: s.total)
        found += [
            s
            for s in top
            if (len(s.models) == 1 or s.total < _FOUND * top[0].total) and self.holds(s)
        ]
        beam = {tuple(sorted(c.name for c in s.models)): s for s in reversed(top)}
        leading = sorted(beam.values(), key=lambda s: s.total)[:_BEAM]
        return [s for s in leading if len(causes(s.models)) < self.most]

    def _rough(self, models: Models) -> float:
        return float(self.score.held_out(models).sum())

    def _extended(self, models: Models, most: int) -> list[Models]:
        """The most promising additions to a set, one of each name."""
        names = [c.name for c in models]
        by_name = dict(self.by_name)
        if models:
            new = self.columns.waves(self.score.solve(models).left)
            by_name[_WAVE] = [*new, *by_name.get(_WAVE, ())[:_BEAM]]
        rows = []
        for name, group in by_name.items():
            if names.count(name) >= (_WAVES if name == _WAVE else 1):
                continue
            larger = [(*models, c) for c in group[:_SHAPES] if c not in models]
            rows += (
                [min(((self._rough(m), m) for m in larger), key=lambda x: x[0])] if larger else []
            )
        rows.sort(key=lambda x: x[0])
        best = [m for _, m in rows[:most]]
        return best if models else [*best, *self._other_forms(best)]

    def _other_forms(self, alone: list[Models]) -> list[Models]:
        """The best shape of every other form of some effects: of the grid's one may look worse."""
        found: dict[tuple[str, int], Models] = {}
        for (one,) in alone:
            for c in self.by_name[one.name]:
                if kind(c) != kind(one):
                    found.setdefault(kind(c), (c,))
        return list(found.values())

    def _pairs(self) -> list[Models]:
        """The best pairs of different effects, as one Gram matrix of all columns has them."""
        pool = [c for group in self.by_name.values() for c in group[:_SHAPES]]
        x, low, high, _ = self.score.stacked(tuple(pool))
        gram, moment = x.T @ x, x.T @ self.experiment.residual
        ends = np.cumsum([0, *(self.columns[c].torque.shape[1] for c in pool)])
        best: dict[tuple[str, ...], tuple[float, Models]] = {}
        for a, b in itertools.combinations(range(len(pool)), 2):
            if pool[a].name == pool[b].name:
                continue
            at = np.r_[ends[a] : ends[a + 1], ends[b] : ends[b + 1]]
            z = np.linalg.solve(gram[np.ix_(at, at)] + 1e-8 * np.eye(len(at)), moment[at])
            if np.any(z < low[at]) or np.any(z > high[at]):
                continue
            explained = float(z @ moment[at])
            names = tuple(sorted((pool[a].name, pool[b].name)))
            if names not in best or explained > best[names][0]:
                best[names] = explained, (pool[a], pool[b])
        return [m for _, m in sorted(best.values(), key=lambda x: -x[0])[:_PAIRS]]


def _is_inexact(term: EffectTerm) -> bool:
    """Whether no column holds it exactly: what leaps, or resembles the law's own error."""
    return term.effect.leaps or term.name in _LAW_LIKE


def _at_its_end(candidate: Candidate) -> bool:
    """Whether a number is at the end of its range: then the effect stands for something else."""
    if not isinstance(candidate, EffectTerm):
        return False
    ranges = zip(candidate.shape, candidate.effect.shape_bounds, strict=False)
    return any(
        x < (1.0 + _AT_ITS_END) * low or x > (1.0 - _AT_ITS_END) * high
        for x, (low, high) in ranges
        if 0.0 < low < high < np.inf
    )
