"""Candidates of the search and their columns: effects on a grid, waves, delays, a wider law."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.columns import columns_of
from frictionjoint.diagnose.library import drive_terms, effect_terms, unnamed_terms
from frictionjoint.diagnose.spectrum import periodic_terms
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.signals import MOTOR, V
from frictionjoint.identify.design import term_bounds
from frictionjoint.identify.instruments import EncoderTerm, ExcessTerm
from frictionjoint.identify.motor_torque import follows_motor
from frictionjoint.identify.terms import DriveTerm, EffectTerm, Term
from linear_search.decisions import NEEDED_PART
from linear_search.experiment import Experiment

# a column that is a change of the target has a coefficient near 1 where its number is right: of a
# delay, which is small; of what a controller does the number itself is fitted
_OF_DELAY, _OF_DRIVE = (0.5, 2.0), (1.0, 1.0)
# samples of a log by which it is delayed, and the longest delay
_DELAYS, _LONGEST = (-8, -3, -1, 1, 2, 4, 8, 14), 0.1
# part of a column that the law must leave for the logs to show it
_SHOWN = 0.005
# speeds over the top speed of a fall that the law's basis does not hold
_WIDER = (0.12, 0.3)
_DELAY = next(e for e in CATALOGUE if e.delays)


@dataclass(frozen=True)
class WiderFall:
    """A fall of the law with speed wider than its basis holds: what it explains has no name."""

    shape: tuple[float, ...] = ()
    name: str = "friction law"


@dataclass(frozen=True)
class _Levels:
    """Of a law: friction in motion and viscous friction; and the terms beside it."""

    levels: tuple[float, float]
    terms: tuple[EffectTerm, ...] = ()


@dataclass(frozen=True)
class Remainder:
    """What a model leaves, N m, and the weight of each sample, shape (n,)."""

    residual: Array
    weight: Array


Candidate = EffectTerm | EncoderTerm | ExcessTerm | WiderFall
Models = tuple[Candidate, ...]


def is_cause(candidate: Candidate) -> bool:
    """Whether it is an effect or a fault of an instrument, and no part of the law."""
    return not isinstance(candidate, WiderFall)


def is_delay(candidate: Candidate) -> bool:
    """Whether it moves the drive in time."""
    return isinstance(candidate, EffectTerm) and candidate.effect.delays


def moves_drive(candidate: Candidate) -> bool:
    """Whether it moves the drive or its target in time."""
    own = isinstance(candidate, EffectTerm) and candidate.effect
    return bool(own and (own.delays or own.delays_target))


def causes(some: Iterable[Candidate]) -> tuple[Candidate, ...]:
    """Those that are no part of the law."""
    return tuple(filter(is_cause, some))


def effects(some: Iterable[Any]) -> tuple[EffectTerm, ...]:
    """The effects of the catalogue among some candidates."""
    return tuple(t for t in some if isinstance(t, EffectTerm))


def kind(candidate: Candidate) -> tuple[str, str]:
    """What shapes of one form of an effect have in common."""
    return candidate.name, candidate.effect.form if isinstance(candidate, EffectTerm) else ""


def _key(candidate: Candidate, before: Models) -> Any:
    """What makes its columns what they are."""
    if not isinstance(candidate, EffectTerm):
        return candidate, ()
    return (*kind(candidate), candidate.shape), tuple(_key(c, ()) for c in before)


@dataclass(frozen=True)
class Column:
    """A candidate's columns.

    Attributes:
        torque: N m per unit of each coefficient, shape (n, k). out: without what the law holds,
            see `Experiment.out`. shown: part of the norm that this is.
        low, high: range of each coefficient, shape (k,).
    """

    torque: Array
    out: Array
    shown: float
    low: Array
    high: Array


class Columns:
    """Columns of candidates in an experiment, made once."""

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment
        self._known: dict[Any, Column] = {}
        self._drives: dict[Any, Array] = {}

    def of(self, models: Models) -> list[Column]:
        """Of each of a set: what it changes of a drive, it changes beside those before it."""
        found = []
        before: Models = ()
        for candidate in models:
            key = _key(candidate, before if isinstance(candidate, DriveTerm) else ())
            if key not in self._known:
                self._make({key: (candidate, before)})
            found.append(self._known[key])
            if isinstance(candidate, DriveTerm):
                before = (*before, candidate)
        return found

    def __getitem__(self, candidate: Candidate) -> Column:
        (found,) = self.of((candidate,))
        return found

    def make(self, candidates: Sequence[Candidate]) -> None:
        """Make the columns of several candidates, each alone: to do it at once is faster."""
        every = {_key(c, ()): (c, ()) for c in candidates}
        new = {key: c for key, c in every.items() if key not in self._known}
        if new:
            self._make(new)

    def _make(self, new: Mapping[Any, tuple[Candidate, Models]]) -> None:
        own = self.experiment
        torques = [self._torque(*c) for c in new.values()]
        outs = own.out(np.hstack([x for x, _, _ in torques]))
        ends = np.cumsum([0, *(x.shape[1] for x, _, _ in torques)])
        for k, (key, (x, low, high)) in enumerate(zip(new, torques, strict=True)):
            out = np.ascontiguousarray(outs[:, ends[k] : ends[k + 1]])
            whole = float(np.linalg.norm(x * own.weight[:, None]))
            shown = float(np.linalg.norm(out)) / whole if 0.0 < whole < np.inf else 0.0
            self._known[key] = Column(x, out, shown, low, high)

    def _torque(self, candidate: Candidate, before: Models) -> tuple[Array, Array, Array]:
        """Columns of a candidate and the range of their coefficients.

        Args:
            before: effects of the drive that it comes on top of.
        """
        own, prepared = self.experiment, self.experiment.prepared
        if isinstance(candidate, WiderFall):
            x = _wider(own)
            ranges = [(-np.inf, np.inf)] * x.shape[1]
        elif isinstance(candidate, DriveTerm):
            x = (self._drive(before) - self._drive((*before, candidate)))[:, None]
            ranges = [_OF_DRIVE]
        elif is_delay(candidate):
            parts = [
                (s.balanced_drive(0.0) - s.balanced_drive(candidate.shape[0]))[s.kept]
                for s in prepared.segments
            ]
            x, ranges = np.concatenate(parts)[:, None], [_OF_DELAY]
        else:
            x, ranges = self._of_torque(candidate), term_bounds(prepared, candidate)
        low, high = np.array(ranges, dtype=float).reshape(-1, 2).T
        return (x, low, high) if np.all(np.isfinite(x)) else (np.zeros_like(x), low, high)

    def acting(self, models: Models) -> float:
        """Of the squares of the drive, the part that a controller gives with a set's effects."""
        changing = tuple(c for c in models if isinstance(c, DriveTerm))
        if not changing:
            return 1.0
        whole, some = (self._drive(x) for x in ((), changing))
        return float(some @ some) / float(whole @ whole)

    def _drive(self, effects: Models) -> Array:
        """The drive that a controller makes with some effects, as the balance keeps it, (n,)."""
        key = tuple(_key(c, ()) for c in effects)
        if key not in self._drives:
            (whole,) = self.experiment.prepared.bundles(1)
            changes = [c.change for c in effects if isinstance(c, DriveTerm)]
            self._drives[key] = whole.balanced(whole.changed(changes))
        return self._drives[key]

    def _of_torque(self, candidate: Term) -> Array:
        """Columns of what adds torque, N m, shape (n, k)."""
        own = self.experiment
        if not follows_motor(candidate):
            return columns_of(own.prepared, own.signals, candidate)
        # the motor's torque is known behind the filter, where no edge of friction stands alone
        found = []
        for i, s in enumerate(own.prepared.segments):
            signals = s.signals[:: s.step][s.kept]
            signals[:, MOTOR] = own.torque[own.blocks.log == i]
            found.append(candidate.columns(s, signals))
        return np.concatenate(found)

    def candidates(self) -> list[Candidate]:
        """What the logs can show."""
        own = self.experiment
        grid = effect_terms(own.prepared, own.signals, ())
        found: list[Candidate] = [t for t in grid if not t.effect.delays]
        found += self.waves(own.residual)
        if not own.offset_is_of_sampling:
            times = [k * own.sample for k in _DELAYS]
            found += [EffectTerm(_DELAY, (t,)) for t in times if abs(t) < _LONGEST]
        found += [
            t
            for t in drive_terms(own.prepared, ())
            if not (t.effect.delays_target and own.offset_is_of_sampling)
        ]
        found += self._instruments()
        found.append(WiderFall())
        self.make(found)
        return [c for c in found if self[c].shown > _SHOWN]

    def waves(self, residual: Array) -> list[EffectTerm]:
        """Waves in position proposed from the spectrum of a residual, shape (n or more,)."""
        own = self.experiment
        left = residual[: len(own.weight)] / np.maximum(own.weight, 1e-9)
        terms, _ = periodic_terms(
            own.prepared, own.signals, Remainder(left, own.weight), own.blocks
        )
        return list(effects(terms))

    def _instruments(self) -> list[Candidate]:
        """Faults of instruments: an encoder off its axis, a torque not given.

        The residual is a part of the measured torque. What a drive did not give is missing beyond a
        level, and no multiple of the torque explains it.
        """
        own, prepared = self.experiment, self.experiment.prepared
        found: list[Candidate] = []
        levels = own.level / own.gain, own.viscous / own.gain
        for term in unnamed_terms(prepared, _Levels(levels), own.signals):
            if isinstance(term, EncoderTerm) or (
                isinstance(term, ExcessTerm) and self._beyond_a_level(term)
            ):
                found.append(term)
        return found

    def _beyond_a_level(self, term: ExcessTerm) -> bool:
        """Whether torque beyond a level explains what no multiple of the torque does."""
        own = self.experiment
        both = [columns_of(own.prepared, own.signals, t) for t in (term, replace(term, at=0.0))]
        level, torque = own.out(np.hstack(both)).T
        torque = torque / np.linalg.norm(torque)
        x, r = (y - torque * (torque @ y) for y in (level, own.residual))
        return bool((x @ r) ** 2 > NEEDED_PART * (x @ x) * (r @ r))


def _wider(own: Experiment) -> Array:
    """Wider falls of the friction level with speed, N m, shape (n, 2)."""
    k = len(own.basis.reaches)
    rest = np.maximum(own.basis.at_rest(own.coefficients), 0.0)
    share = rest / max(float(rest.sum()), 1e-12)
    speeds = np.array(_WIDER) * own.prepared.top_speed
    along = [
        (x[:, :k] @ share)[:, None] * np.exp(-((s.signals[:, V, None] / speeds) ** 2))
        for s, x in zip(own.prepared.segments, own.basis.along, strict=True)
    ]
    return own.basis.kept(along)
