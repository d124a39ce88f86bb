"""What to try against a residual: the catalogue's effects, periods in position, smooth curves."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import Blocks
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import DTAU, MOTOR, TIME, H, Q
from frictionjoint.identify.design import full_signals
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.motor_torque import ON_THE_MOTOR
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.smooth import (
    VARIABLES,
    ExcessTerm,
    HysteresisTerm,
    LogTerm,
    SmoothTerm,
    SplineTerm,
    WaveTerm,
    quantity,
)
from frictionjoint.identify.terms import EffectTerm, Term
from frictionjoint.threads import side_by_side

_PERIODIC = (11, 12)
_BACK_EMF = 10
_SATURATION = 26
_POSITION_BINS = 4096
_FEWEST_PERIODS = 1.5
# waves in time that the longest log must hold
_FEWEST_WAVES = 4.0
_REACHES = (0.01, 0.03, 0.1, 0.3)
_PEAKS = 2
# length over which a change of the friction level is reached, over the travel: where a fit starts
_LEVEL_REACH = 1e-3
# share of a column's squares in one log from which on the others cannot test it
_ONE_LOG = 0.95
# limits of the drive tried, quantiles of its torque; how near to one to one, and to all of the
# residual, an excess must be
_LIMITS = tuple(0.2 + 0.02 * k for k in range(40))
_ONE_TO_ONE, _NEXT_TO_ALL = 0.2, 0.8


@dataclass(frozen=True)
class Candidate:
    """A term with its columns on the kept samples.

    Attributes:
        term: effect at given shape numbers, or a smooth curve.
        columns: filtered and decimated, N m per coefficient, shape (n, k).
        search_p: p-value of a search that chose the shape (periods), else 0.
        in_one_log: only one log has motion in which it acts, as that to an end stop.
    """

    term: Term
    columns: Array
    search_p: float = 0.0
    in_one_log: bool = False

    @property
    def smooth(self) -> bool:
        """Whether it is a curve without a physical name."""
        return isinstance(self.term, SmoothTerm)

    @property
    def kind(self) -> str:
        """Which candidates of one name are shapes of one thing."""
        return type(self.term).__name__

    @property
    def slow(self) -> bool:
        """Whether it is an effect that changes over minutes."""
        return isinstance(self.term, EffectTerm) and self.term.effect.slow

    @property
    def within_logs(self) -> bool:
        """Whether other logs cannot test it: its coefficients belong to each log, its quantity
        hardly moves within one, or only one has it.
        """
        if isinstance(self.term, EffectTerm):
            return self.slow or self.in_one_log
        return isinstance(self.term, SmoothTerm) and self.term.within_logs


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
                if term.coefficients and term.name not in ON_THE_MOTOR
            ],
            np.zeros(len(signals)),
        )
    return found


def columns_of(prepared: Prepared, signals: list[Array], term: Term) -> Array:
    """A term's columns on the kept samples of all logs.

    A delay, which moves the drive, has none; its first order is the rate of the torque.
    """
    parts = [
        s.lowpass(term.columns(s, x) if term.coefficients else x[:, [DTAU]], term.differenced)[
            s.kept
        ]
        for s, x in zip(prepared.segments, signals, strict=True)
    ]
    return np.concatenate(parts)


def effect_candidates(
    prepared: Prepared, signals: list[Array], taken: tuple[Term, ...]
) -> list[Candidate]:
    """Every effect that the logs can speak of and that is not in the model yet."""
    everything = np.concatenate(signals)
    names = {term.name for term in taken}
    terms = [
        EffectTerm(effect, shape)
        for effect in CATALOGUE
        if effect.name not in names and _spoken_of(prepared, effect, everything)
        for shape in effect.shapes(everything)
    ]
    with side_by_side() as each:
        columns = list(each(partial(columns_of, prepared, signals), terms))
    return [
        Candidate(term, x, in_one_log=_in_one_log(prepared, x))
        for term, x in zip(terms, columns, strict=True)
        if np.all(np.isfinite(x)) and np.any(x)
    ]


def _spoken_of(prepared: Prepared, effect: Effect, signals: Array) -> bool:
    """Whether the logs can tell of an effect; periodic ones have a search of their own."""
    if effect.effect_id in _PERIODIC:
        return False
    if effect.effect_id == _BACK_EMF and not prepared.voltage_driven:
        return False  # sigma2 has taken what is linear in velocity
    if effect.name == "torque-gain" and prepared.gain_unknown:
        return False  # the gain is a parameter of the fit already
    if effect.effect_id == _SATURATION and not prepared.gain_unknown:
        return False  # where the torque was measured, no motor stands between it and the joint
    return all(_varies(signals[:, c]) for c in effect.needs)


def _in_one_log(prepared: Prepared, columns: Array) -> bool:
    ends = np.cumsum([int(s.kept.sum()) for s in prepared.segments])[:-1]
    squares = np.array([np.sum(part**2) for part in np.split(columns, ends)])
    return bool(squares.max() > _ONE_LOG * squares.sum())


def _varies(x: Array) -> bool:
    return bool(np.ptp(x) > 1e-9 * (1.0 + np.abs(x).max()))


def smooth_candidates(prepared: Prepared, signals: list[Array]) -> list[Candidate]:
    """Curves without a physical name, in every measured quantity.

    A spline alone and times the direction of friction; hysteresis in position over a hundredth to
    a third of the travel; a friction level for each log.
    """
    terms: list[SplineTerm | HysteresisTerm | LogTerm] = []
    for variable in [*VARIABLES, *prepared.segments[0].others]:
        try:
            x = np.concatenate(
                [quantity(s, g, variable) for s, g in zip(prepared.segments, signals, strict=True)]
            )
        except KeyError:
            continue  # another joint that only some logs have
        if not _varies(x):
            continue
        low, high = (float(v) for v in np.quantile(x, (0.005, 0.995)))
        if high > low:
            pair = [SplineTerm(variable, low, high, odd) for odd in (False, True)]
            terms += [curve.centred(prepared.segments, signals) for curve in pair]
    span = max(float(np.ptp(s.signals[:, Q])) for s in prepared.segments)
    terms.append(HysteresisTerm("position", tuple(span * part for part in _REACHES)))
    names = tuple(s.name for s in prepared.segments)
    if len(names) > 1:
        terms.append(LogTerm("log", names))
    return [Candidate(term, columns_of(prepared, signals, term)) for term in terms]


def excess_candidates(prepared: Prepared, fitted: Fit) -> list[Candidate]:
    """Torque beyond the limit that explains most: asked for, logged, and never given.

    The torque is on both sides of this balance. So the model is solved for where less than a limit
    was asked for, and the limit counts only where next to all that is missing elsewhere is the
    excess itself, one to one.
    """
    if prepared.gain_unknown:
        return []
    asked = np.concatenate([np.abs(s.lowpass(s.drive)[s.kept]) for s in prepared.segments])
    J = fitted.free_jacobian
    found = []
    for limit in np.quantile(asked, _LIMITS):
        term = ExcessTerm("torque", float(limit))
        x = columns_of(prepared, [s.signals for s in prepared.segments], term)[:, 0]
        below = asked < limit
        if below.sum() < 2 * J.shape[1] or not x.any():
            continue
        # to first order in the change of the parameters
        change = np.linalg.lstsq(J[below], fitted.residual[below], rcond=1e-8)[0]
        left = fitted.residual - J @ change
        size, common, whole = float(x @ x), float(x @ left), float(left @ left)
        missing, explained = common / size, common**2 / (size * whole)
        if abs(missing - 1.0) < _ONE_TO_ONE and explained > _NEXT_TO_ALL:
            found.append((explained, Candidate(term, x[:, None])))
    return [max(found, key=lambda pair: pair[0])[1]] if found else []


def wave_candidates(
    prepared: Prepared,
    residual: Array,
    log_index: NDArray[np.int64],
    blocks: Blocks,
    rng: np.random.Generator,
    flips: int,
) -> list[Candidate]:
    """A wave in time, from outside the joint: the strongest line of the residual's spectrum.

    The p-value of the line counts the search over all of them (sign flips by block).
    """
    times = [(s.signals[:: s.step, TIME])[s.kept] for s in prepared.segments]
    longest = max(float(np.ptp(t)) for t in times)
    rate = min(1.0 / (s.dt * s.step) for s in prepared.segments)
    cells = int(longest * rate) + 1
    sums = np.zeros((blocks.count, cells))
    t = np.concatenate([x - x[0] for x in times])
    cell = np.minimum((t * rate).astype(int), cells - 1)
    np.add.at(sums, (blocks.of_sample, cell), residual)
    first = int(_FEWEST_WAVES * 2)
    F = np.fft.rfft(sums, 2 * cells, axis=1)[:, first : cells // 4]
    if F.shape[1] == 0:
        return []
    # phases belong to the logs: power adds up over logs, not amplitudes
    log_of_block = np.array([log_index[blocks.of_sample == b][0] for b in range(blocks.count)])
    signs = np.vstack([np.ones(blocks.count), rng.choice([-1.0, 1.0], (flips, blocks.count))])
    power = np.zeros((flips + 1, F.shape[1]))
    for i in np.unique(log_index):
        inside = log_of_block == i
        norm = np.sum(np.abs(F[inside]) ** 2)
        power += np.abs(signs[:, inside] @ F[inside]) ** 2 / (norm + 1e-300)
    best = power.max(axis=1)
    p = float(np.mean(best >= best[0] * (1 - 1e-12)))
    frequency = (int(np.argmax(power[0])) + first) * rate / (2 * cells)
    term = WaveTerm("time", float(frequency), tuple(s.name for s in prepared.segments))
    signals = [s.signals for s in prepared.segments]
    return [Candidate(term, columns_of(prepared, signals, term), p)]


def periodic_candidates(
    prepared: Prepared,
    signals: list[Array],
    residual: Array,
    blocks: Blocks,
    rng: np.random.Generator,
    flips: int,
) -> list[Candidate]:
    """Harmonics of position: the strongest spatial frequencies of the residual.

    The residual is summed into bins of position and transformed; the p-value of the best
    frequency counts the search over all of them (sign flips by block).
    """
    x = np.concatenate(
        [s.lowpass(g[:, [Q, H]])[s.kept] for s, g in zip(prepared.segments, signals, strict=True)]
    )
    q = x[:, 0]
    span = float(np.ptp(q))
    if span <= 0.0:
        return []
    bins = np.minimum((_POSITION_BINS * (q - q.min()) / span).astype(int), _POSITION_BINS - 1)
    found = []
    for effect_id, weight in zip(_PERIODIC, (np.ones(len(q)), x[:, 1]), strict=True):
        effect = next(e for e in CATALOGUE if e.effect_id == effect_id)
        sums = np.zeros((blocks.count, _POSITION_BINS))
        np.add.at(sums, (blocks.of_sample, bins), residual * weight)
        F = np.fft.rfft(sums, 2 * _POSITION_BINS, axis=1)
        # twice oversampled: line k has k/2 periods over the span; a quarter of the bins' Nyquist
        # frequency is the finest that the bins resolve. Periods are counted over where the
        # joint mostly is: a few excursions must not make a slow wave out of a smooth curve.
        usual = float(np.subtract(*np.quantile(q, (0.95, 0.05))))
        first, last = int(2 * _FEWEST_PERIODS * span / usual), _POSITION_BINS // 4
        F = F[:, first:last]
        norm = np.sum(np.abs(F) ** 2, axis=0) + 1e-300
        power = np.abs(F.sum(axis=0)) ** 2
        signs = rng.choice([-1.0, 1.0], size=(flips, blocks.count))
        null = np.max(np.abs(signs @ F) ** 2 / norm, axis=1)
        for line in _peaks(power, _PEAKS):
            p = (1 + int(np.sum(null >= power[line] / norm[line]))) / (flips + 1)
            N = np.pi * (line + first) / span
            reach = (_LEVEL_REACH * span,) if effect.memory else ()
            term = EffectTerm(effect, (float(N), *reach))
            term = _sharpened(prepared, signals, term, residual, span)
            found.append(Candidate(term, columns_of(prepared, signals, term), p))
    return found


def _peaks(power: Array, count: int) -> list[int]:
    left = power.copy()
    found = []
    for _ in range(count):
        k = int(np.argmax(left))
        found.append(k)
        left[max(0, k - 3) : k + 4] = 0.0
    return found


def _sharpened(
    prepared: Prepared, signals: list[Array], term: EffectTerm, residual: Array, span: float
) -> EffectTerm:
    """The frequency near a spectral line that explains most."""
    N, *others = term.shape
    trials = [
        term.with_shape((float(N + x), *others)) for x in np.linspace(-1, 1, 9) * np.pi / span / 2
    ]
    gains = []
    for trial in trials:
        X = columns_of(prepared, signals, trial)
        fitted = X @ np.linalg.lstsq(X, residual, rcond=None)[0]
        gains.append(float(fitted @ residual))
    return trials[int(np.argmax(gains))]
