"""Candidates that these logs can test: effects, waves in position, unnamed dependences."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import Blocks
from frictionjoint.effects.catalogue import CATALOGUE, DRIVE_EFFECTS
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import GX, GY, LOAD, MOTOR, TEMP, TIME, A, H, Q, V
from frictionjoint.identify.design import full_signals, kept, term_bounds
from frictionjoint.identify.fit import HEARD, Fit
from frictionjoint.identify.gate import scale_is_determined
from frictionjoint.identify.instruments import EncoderTerm, ExcessTerm
from frictionjoint.identify.prepare import Prepared, Segment
from frictionjoint.identify.smooth import (
    VARIABLES,
    HysteresisTerm,
    LogTerm,
    SmoothTerm,
    SplineTerm,
    WaveTerm,
    quantity,
)
from frictionjoint.identify.swing import swings, swings_of
from frictionjoint.identify.terms import DriveTerm, EffectTerm, Term, Timing
from frictionjoint.threads import side_by_side

_POSITION_BINS = 4096
_FEWEST_PERIODS = 1.5
# waves in time that the longest log must hold
_FEWEST_WAVES = 2.0
# of what a wave in time explains, that one in position may explain
_AS_IN_TIME = 0.5
# reaches of unnamed hysteresis, over the travel
_REACHES = (0.01, 0.03, 0.1, 0.3)
# fractions of the samples above which a logged torque may not have acted
_EXCEEDED = (0.5, 0.7, 0.8, 0.9, 0.95, 0.98)
# waves of an encoder in a turn of the joint
_ORDERS = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0)
# strongest lines of a spectrum that are tried
_PEAKS = 2
# length over which a change of the friction level is reached, over the travel: where a fit starts
_LEVEL_REACH = 1e-3
# of a candidate's columns, what may be left by others that hold the same
_SAME = 1e-3
# a temperature that changes by less, K, holds nothing but its sensor's flicker
_LEAST_WARMING = 1.0


@dataclass(frozen=True)
class Candidate:
    """A term with its columns on the kept samples.

    Attributes:
        term: effect at given shape numbers, or an unnamed dependence.
        columns: behind the balance's filter, N m per coefficient, shape (n, k).
        bounds: of each coefficient, N m; none where empty.
        among: lines of the residual's spectrum that it was chosen from.
        begun: columns of what it may have held when each log began, shape (n, m);
            None: nothing.
    """

    term: Term
    columns: Array
    bounds: tuple[tuple[float, float], ...] = ()
    among: float = 1.0
    begun: Array | None = None

    @property
    def unnamed(self) -> bool:
        """Whether it is a dependence without a physical name."""
        return is_unnamed(self.term)

    @property
    def comes_first(self) -> bool:
        """Whether nothing else can be decided before it."""
        return comes_first(self.term)

    @property
    def kind(self) -> tuple[str, str]:
        """What shapes of one thing have in common."""
        if isinstance(self.term, EffectTerm):
            return self.term.name, "effect"
        return self.term.name, type(self.term).__name__

    def contains(self, other: "Candidate") -> bool:
        """Whether another candidate is this one with some of its coefficients fixed."""
        left = np.linalg.lstsq(self.columns, other.columns, rcond=None)[0]
        rest = other.columns - self.columns @ left
        return bool(np.linalg.norm(rest) < _SAME * np.linalg.norm(other.columns))


def is_unnamed(term: Term) -> bool:
    """Whether a term is a dependence without a physical name."""
    return isinstance(term, SmoothTerm)


def comes_first(term: Term) -> bool:
    """Whether nothing else can be decided before a term."""
    return isinstance(term, EffectTerm) and term.effect.first


def library(prepared: Prepared, fitted: Fit, blocks: Blocks) -> list[Candidate]:
    """All candidates against a fit's residual."""
    signals = signals_of(prepared, fitted)
    terms = effect_terms(prepared, signals, fitted.terms) + unnamed_terms(prepared, signals)
    if not scale_is_determined(prepared, fitted):
        # a part of an inertia that does not show could be as large as one likes
        terms = [t for t in terms if not (isinstance(t, EffectTerm) and t.effect.of_inertia)]
    among = [1.0] * len(terms)
    for found, lines in (
        periodic_terms(prepared, signals, fitted, blocks),
        wave_terms(prepared, fitted),
    ):
        terms += found
        among += [lines] * len(found)
    return _candidates(prepared, fitted, signals, terms, among)


def other_forms(prepared: Prepared, fitted: Fit, term: Term) -> list[Candidate]:
    """The same effect in its other forms, on their grids."""
    if not isinstance(term, EffectTerm):
        return []
    signals = signals_of(prepared, fitted)
    own = term.effect
    forms = [e for e in CATALOGUE if e.name == own.name and e.effect_id != own.effect_id]
    terms = _on_grid(prepared, forms, signals)
    return _candidates(prepared, fitted, signals, terms, [1.0] * len(terms))


def _candidates(
    prepared: Prepared, fitted: Fit, signals: list[Array], terms: list[Term], among: list[float]
) -> list[Candidate]:
    """Terms with their columns, without those that do nothing in these logs."""
    with side_by_side() as each:
        columns = list(each(partial(columns_of, prepared, signals), terms))
    return [
        Candidate(
            term,
            x,
            tuple((lo * fitted.gain, hi * fitted.gain) for lo, hi in term_bounds(prepared, term)),
            lines,
            swings_of(prepared, term) if swings(term) else None,
        )
        for term, x, lines in zip(terms, columns, among, strict=True)
        if np.all(np.isfinite(x)) and np.any(x)
    ]


def signals_of(prepared: Prepared, fitted: Fit) -> list[Array]:
    """Signals of each log under the fitted law; the torque of a motor under the whole model."""
    found = [full_signals(s, fitted.shape, *fitted.levels) for s in prepared.segments]
    if not prepared.gain_unknown:
        return found
    for s, signals in zip(prepared.segments, found, strict=True):
        # with all columns made first: a term may look at the torque of the law
        signals[:, MOTOR] += sum(
            [
                term.columns(s, signals) @ fitted.term_coefficients(i)
                for i, term in enumerate(fitted.terms)
                if term.coefficients and not (isinstance(term, EffectTerm) and term.effect.on_motor)
            ],
            np.zeros(len(signals)),
        )
    return found


def columns_of(prepared: Prepared, signals: list[Array], term: Term) -> Array:
    """A term's columns on the kept samples of all logs.

    A delay, which moves the drive, has none; its first order is the rate of the drive.
    """
    if not term.coefficients:
        parts = [s.balanced_drive(0.0, 1)[s.kept] for s in prepared.segments]
        return np.concatenate(parts)[:, None]
    parts = [kept(s, term.columns(s, x)) for s, x in zip(prepared.segments, signals, strict=True)]
    return np.concatenate(parts)


def effect_terms(prepared: Prepared, signals: list[Array], taken: tuple[Term, ...]) -> list[Term]:
    """Every effect on a grid that the logs can test and that is not in the model yet."""
    names = {term.name for term in taken}
    # a second delay would be that of the torque's own noise
    timed = any(isinstance(term, Timing) and not term.at_its_end for term in taken)
    new = [e for e in CATALOGUE if e.name not in names and not (timed and e.delays)]
    return _on_grid(prepared, new, signals)


def _on_grid(prepared: Prepared, effects: list[Effect], signals: list[Array]) -> list[Term]:
    """Those of some effects that have a grid, on all of it that the logs can test."""
    everything = np.concatenate(signals)
    return [
        EffectTerm(effect, shape)
        for effect in effects
        if effect.proposed_by == "grid" and testable(prepared, effect, everything)
        for shape in effect.shapes(everything)
        if _in_band(prepared, effect, shape)
    ]


def drive_terms(prepared: Prepared, taken: tuple[Term, ...]) -> list[DriveTerm]:
    """Every effect of the drive, where the drive is what a controller made of its commands."""
    if not prepared.commanded:
        return []
    names = {term.name for term in taken}
    logs = [s.commanded.commands for s in prepared.segments if s.commanded]
    return [
        DriveTerm(effect, shape)
        for effect in DRIVE_EFFECTS
        if effect.name not in names and prepared.drive in effect.drives
        for shape in (effect.drive_shapes(logs) if effect.drive_shapes else [])
    ]


def testable(prepared: Prepared, effect: Effect, signals: Array) -> bool:
    """Whether the logs can test an effect."""
    if prepared.drive not in effect.drives:
        return False
    return all(_varies(signals[:, c], _LEAST_WARMING * (c == TEMP)) for c in effect.needs)


def _in_band(prepared: Prepared, effect: Effect, shape: tuple[float, ...]) -> bool:
    """Whether all its frequencies are ones that the balance holds."""
    units = effect.shape_units[: len(shape)]
    top = HEARD * prepared.band.balance
    return all(x <= top for x, unit in zip(shape, units, strict=True) if unit == "Hz")


def _varies(x: Array, least: float = 0.0) -> bool:
    low, high = np.quantile(x, (0.01, 0.99))
    return bool(high - low > max(least, 1e-9 * (1.0 + np.abs(x).max())))


def unnamed_terms(prepared: Prepared, signals: list[Array]) -> list[Term]:
    """Dependences without a physical name, on every measured quantity.

    A spline alone and times the direction of friction; hysteresis in position over a hundredth to
    a third of the travel; a friction level for each log; what instruments may hold that the joint
    does not.
    """
    terms: list[Term] = []
    for variable in [*VARIABLES, *prepared.segments[0].others]:
        try:
            x = np.concatenate(
                [quantity(s, g, variable) for s, g in zip(prepared.segments, signals, strict=True)]
            )
        except KeyError:
            continue  # another joint that only some logs have
        if not _varies(x, _LEAST_WARMING * (VARIABLES.get(variable) == TEMP)):
            continue
        low, high = (float(v) for v in np.quantile(x, (0.005, 0.995)))
        pair = [SplineTerm(variable, low, high, odd) for odd in (False, True)]
        terms += [curve.centred(prepared.segments, signals) for curve in pair]
    span = max(float(np.ptp(s.signals[:, Q])) for s in prepared.segments)
    terms.append(HysteresisTerm("position", tuple(span * part for part in _REACHES)))
    if prepared.drive == "torque" and not prepared.commanded:
        size = np.concatenate([np.abs(s.drive[s.mask]) for s in prepared.segments])
        levels = np.quantile(size, _EXCEEDED).tolist()
        terms += [ExcessTerm("torque", x, (levels[0], levels[-1])) for x in levels]
    if not prepared.slide:
        x = np.concatenate([s.signals[s.mask] for s in prepared.segments])
        inertia, *arms = np.linalg.lstsq(x[:, [A, GX, GY]], x[:, LOAD], rcond=None)[0].tolist()
        terms += [EncoderTerm("position", N, inertia, (arms[0], arms[1])) for N in _ORDERS]
    names = tuple(s.name for s in prepared.segments)
    if len(names) > 1:
        terms.append(LogTerm("log", names))
    return terms


def wave_terms(prepared: Prepared, fitted: Fit) -> tuple[list[Term], float]:
    """A wave in time, from outside the joint: the strongest line of the residual's spectrum.

    Returns:
        also how many independent lines that is of.
    """
    times = [(s.signals[:: s.step, TIME])[s.kept] for s in prepared.segments]
    longest = max(float(np.ptp(t)) for t in times)
    rate = min(1.0 / (s.dt * s.step) for s in prepared.segments)
    cells = int(longest * rate) + 1
    first = int(_FEWEST_WAVES * 2)
    power = np.zeros(max(0, cells // 4 - first))
    e = fitted.residual * fitted.weight
    for i, t in enumerate(times):
        cell = np.minimum(((t - t[0]) * rate).astype(int), cells - 1)
        F = np.fft.rfft(np.bincount(cell, e[fitted.log_index == i], cells), 2 * cells)
        # phases belong to the logs: power adds up over logs, not amplitudes
        power += np.abs(F[first : cells // 4]) ** 2
    if not power.size:
        return [], 1.0
    frequency = (int(np.argmax(power)) + first) * rate / (2 * cells)
    # a line is as wide as half a turn over the longest log: in between lies the wave
    line = frequency - 0.5 / longest, frequency + 0.5 / longest
    found = minimize_scalar(lambda f: -_of_wave(fitted, times, f), bounds=line)
    frequency = float(found.x)
    # at a constant speed a wave in position is one in time
    turned = [_at_mean_speed(s) for s in prepared.segments]
    if _of_wave(fitted, turned, frequency) >= _AS_IN_TIME * -float(found.fun):
        return [], 1.0
    wave = WaveTerm("time", frequency, line, tuple(s.name for s in prepared.segments))
    return [wave], max(1.0, len(power) / 2.0)


def _at_mean_speed(segment: Segment) -> Array:
    """Time at which the positions of a log would be passed at its mean speed, s."""
    q, v = (segment.signals[:: segment.step, k][segment.kept] for k in (Q, V))
    mean = float(np.mean(v))
    return np.asarray(q / mean if mean else np.zeros(len(q)))


def _of_wave(fitted: Fit, times: list[Array], frequency: float) -> float:
    """Squares of a fit's residual that a wave explains, with a phase for each log."""
    explained = 0.0
    for i, t in enumerate(times):
        own = fitted.log_index == i
        angle, w = 2.0 * np.pi * frequency * t, fitted.weight[own]
        X = np.column_stack([np.sin(angle) * w, np.cos(angle) * w])
        e = fitted.residual[own] * w
        explained += float(e @ X @ np.linalg.lstsq(X, e, rcond=None)[0])
    return explained


def periodic_terms(
    prepared: Prepared, signals: list[Array], fitted: Fit, blocks: Blocks
) -> tuple[list[Term], float]:
    """Harmonics of position: the strongest spatial frequencies of the residual.

    Those of all folds together and of all but each one, so that a frequency can be chosen on data
    it is not tested on.

    Returns:
        also how many independent lines they are of.
    """
    x = np.concatenate(
        [kept(s, g[:, [Q, H]]) for s, g in zip(prepared.segments, signals, strict=True)]
    )
    q = x[:, 0]
    span = float(np.ptp(q))
    if span <= 0.0:
        return [], 1.0
    e = fitted.residual * fitted.weight**2
    bins = np.minimum((_POSITION_BINS * (q - q.min()) / span).astype(int), _POSITION_BINS - 1)
    # periods are counted over where the joint mostly is: a few excursions must not make a slow
    # wave out of a smooth curve
    usual = float(np.subtract(*np.quantile(q, (0.95, 0.05))))
    first, last = int(2 * _FEWEST_PERIODS * span / usual), _POSITION_BINS // 4
    fold = blocks.fold[blocks.of_sample]
    found: list[Term] = []
    for effect in (f for f in CATALOGUE if f.proposed_by == "spectrum"):
        weight = x[:, 1] if effect.entry == "scales the friction level" else np.ones(len(q))
        # twice oversampled: line k has k/2 periods over the span
        F = np.array(
            [
                np.fft.rfft(
                    np.bincount(bins, e * weight * (fold == k), _POSITION_BINS), 2 * _POSITION_BINS
                )[first:last]
                for k in np.unique(fold)
            ]
        )
        whole = F.sum(axis=0)
        lines = set(_peaks(np.abs(whole) ** 2, _PEAKS))
        for part in F:
            lines |= set(_peaks(np.abs(whole - part) ** 2, 1))
        for line in sorted(lines):
            N = np.pi * (line + first) / span
            reach = (_LEVEL_REACH * span,) if effect.memory else ()
            term = EffectTerm(effect, (float(N), *reach))
            found.append(_sharpened(prepared, signals, term, e, span))
    return found, max(1.0, (last - first) / 2.0)


def _peaks(power: Array, count: int) -> list[int]:
    left = power.copy()
    found = []
    for _ in range(count if len(left) else 0):
        k = int(np.argmax(left))
        found.append(k)
        left[max(0, k - 3) : k + 4] = 0.0
    return found


def _sharpened(
    prepared: Prepared, signals: list[Array], term: EffectTerm, e: Array, span: float
) -> EffectTerm:
    """The frequency near a spectral line that explains most."""
    N, *others = term.shape
    trials = [
        term.with_shape((float(N + x), *others)) for x in np.linspace(-1, 1, 5) * np.pi / span / 2
    ]
    gains = []
    for trial in trials:
        X = columns_of(prepared, signals, trial)
        G = X.T @ X
        s = X.T @ e
        gains.append(float(s @ np.linalg.lstsq(G, s, rcond=1e-9)[0]))
    return trials[int(np.argmax(gains))]
