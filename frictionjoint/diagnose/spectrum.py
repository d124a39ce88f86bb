"""Periodic terms from the spectrum of a fit's residual: in time, or in position; short waves."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from frictionjoint.arrays import Array
from frictionjoint.decisions import APART
from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.gram import screen
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.friction_level import REACHES
from frictionjoint.effects.signals import LOAD, TIME, A, H, Q, V
from frictionjoint.identify.basis import lengths, orthonormal
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.search import FEWEST_WAVES, HALF_A_WAVE
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.smooth import WaveTerm
from frictionjoint.identify.terms import EffectTerm, Term


def wave_terms(prepared: Prepared, fitted: Fit) -> tuple[list[Term], float]:
    """A wave in time from outside the joint: the strongest line of the residual's spectrum.

    Returns:
        the wave, and the number of independent lines that were searched.
    """
    times = [s.at_kept(s.signals[:, TIME]) for s in prepared.segments]
    longest = max(float(np.ptp(t)) for t in times)
    rate = min(1.0 / (s.dt * s.step) for s in prepared.segments)
    cells = int(longest * rate) + 1
    first = int(FEWEST_WAVES * 2)
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
    if _of_wave(fitted, turned, frequency) >= APART * -float(found.fun):
        return [], 1.0
    moved = _part_of_motion(fitted, prepared, times, frequency)
    if moved > 0.5:  # of the wave the motion alone makes more than half
        return [], 1.0
    wave = WaveTerm("time", frequency, line, tuple(s.name for s in prepared.segments), moved)
    return [wave], max(1.0, len(power) / 2.0)


def _part_of_motion(fitted: Fit, prepared: Prepared, times: list[Array], frequency: float) -> float:
    """Largest fraction of a wave in time that is a function of a log's motion and load, 0 to 1.

    A joint that moves at the frequency, or at half or a third of it, has such a wave in its own
    torque; then the logs do not show that it comes from elsewhere.
    """
    parts = []
    for i, (segment, t) in enumerate(zip(prepared.segments, times, strict=True)):
        w = fitted.weight[fitted.log_index == i][:, None]
        q, v, a, load = segment.at_kept(segment.signals[:, [Q, V, A, LOAD]]).T
        motion = np.column_stack([q, v, a, load, np.sign(v), q * q, v * np.abs(v), v * v, q**3])
        angle = 2.0 * np.pi * frequency * t[:, None]
        wave = np.hstack([np.sin(angle), np.cos(angle)])
        X, y = (w * (x - np.average(x, axis=0, weights=w[:, 0] ** 2)) for x in (motion, wave))
        left = y - X @ np.linalg.lstsq(X, y, rcond=1e-9)[0]
        whole = np.sum(y * y, axis=0)
        parts.append(float(np.max(1.0 - np.sum(left * left, axis=0) / np.where(whole, whole, 1.0))))
    return max(parts)


def _at_mean_speed(segment: Segment) -> Array:
    """Time at which the positions of a log would be passed at its mean speed, s."""
    q, v = (segment.signals[:: segment.step, k][segment.kept] for k in (Q, V))
    mean = float(np.mean(v))
    return np.asarray(q / mean if mean else np.zeros(len(q)))


def _of_wave(fitted: Fit, times: list[Array], frequency: float) -> float:
    """Sum of squares that a wave explains of a fit's residual, with a phase per log."""
    explained = 0.0
    for i, t in enumerate(times):
        own = fitted.log_index == i
        angle, w = 2.0 * np.pi * frequency * t, fitted.weight[own]
        X = np.column_stack([np.sin(angle) * w, np.cos(angle) * w])
        e = fitted.residual[own] * w
        explained += float(e @ X @ np.linalg.lstsq(X, e, rcond=None)[0])
    return explained


def periodic_terms(
    prepared: Prepared,
    signals: list[Array],
    fitted: Fit,
    blocks: Blocks,
    wanted: Callable[[Effect], bool] = lambda effect: True,
) -> tuple[list[Term], float]:
    """Harmonics of position: the strongest spatial frequencies of the residual.

    The frequencies come from all folds together and from all folds but one, for each fold, so that
    a frequency can be chosen on data on which it is not tested.

    Returns:
        the terms, and the number of independent lines that were searched.
    """
    harmonics = [f for f in CATALOGUE if f.proposed_by == "spectrum" and wanted(f)]
    if not harmonics:
        return [], 1.0
    x = np.concatenate(
        [s.balanced(g[:, [Q, H]]) for s, g in zip(prepared.segments, signals, strict=True)]
    )
    q = x[:, 0]
    span = float(np.ptp(q))
    if span <= 0.0:
        return [], 1.0
    e = fitted.residual * fitted.weight**2
    cells = 4096  # of the travel
    cell = np.minimum((cells * (q - q.min()) / span).astype(int), cells - 1)
    # periods are counted over where the joint mostly is: a few excursions must not make a slow
    # wave out of a smooth curve
    slowest, width = 2.0 * np.pi * HALF_A_WAVE / prepared.usual_travel, np.pi / span
    first, last = int(slowest / width), cells // 4
    fold = blocks.fold[blocks.of_sample]
    law = np.column_stack([fitted.free_jacobian, fitted.begun]) * fitted.weight[:, None]
    known, target = orthonormal(law / lengths(law)), fitted.residual * fitted.weight
    found: list[Term] = []
    for effect in harmonics:
        weight = x[:, 1] if effect.entry == "scales the friction level" else np.ones(len(q))
        # twice oversampled: line k has k/2 periods over the span
        F = np.array(
            [
                np.fft.rfft(np.bincount(cell, e * weight * (fold == k), cells), 2 * cells)[
                    first:last
                ]
                for k in np.unique(fold)
            ]
        )
        whole = F.sum(axis=0)
        lines = set(_peaks(np.abs(whole) ** 2, 2))
        for part in F:
            lines |= set(_peaks(np.abs(whole - part) ** 2, 1))
        for line in sorted(lines):
            # a line is as wide as half a period over the span, and without the law it may be the
            # next one
            N = width * (line + first)
            bounds = max(slowest, N - width), N + width
            N = _sharpened(bounds, q, weight * fitted.weight, target, known)
            reaches = [(part * span,) for part in REACHES] if "reach" in effect.shape else [()]
            found += [EffectTerm(effect, (N, *reach)) for reach in reaches]
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
    bounds: tuple[float, float], q: Array, scale: Array, target: Array, known: Array
) -> float:
    """The frequency within bounds at which a wave in position explains most of a residual.

    A law that was fitted without the wave has taken a part of it, so the law's own freedom is
    projected out of the wave.

    Args:
        q: position, (n,). scale: of the wave at each sample, weighted, (n,).
        target: weighted residual, (n,). known: orthonormal basis of the law's freedom, (n, k).
    """

    def explained(trial: float) -> float:
        X = np.column_stack([np.sin(trial * q), np.cos(trial * q)]) * scale[:, None]
        X -= known @ (known.T @ X)
        s = X.T @ target
        return float(s @ np.linalg.lstsq(X.T @ X, s, rcond=1e-9)[0])

    return float(minimize_scalar(lambda x: -explained(x), bounds=bounds).x)


def short_waves(prepared: Prepared, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates that are waves with less than one and a half periods in the usual travel."""
    fewest = 2.0 * np.pi * FEWEST_WAVES / prepared.usual_travel
    return [c for c in candidates if c.term.effect.is_wave and c.term.shape[0] < fewest]


def waves_like_curves(
    fitted: Fit, blocks: Blocks, short: Sequence[Candidate], curves: Sequence[Candidate]
) -> list[Candidate]:
    """Short waves without half of the error of every free curve on unlike motion.

    Short waves resemble any curve. But where a fold of the logs has no positions a wave continues,
    and a curve does not.
    """
    seen = screen(fitted, blocks, [*short, *curves])
    left = [float(seen.held_out([*seen.terms, at])[0].sum()) for at in seen.candidates]
    most = (1.0 - APART) ** 2 * min(left[len(short) :], default=np.inf)
    return [c for c, its in zip(short, left, strict=False) if its > most]
