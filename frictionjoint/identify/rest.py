"""Rest that the position does not resolve: there friction may take any value up to breakaway.

A joint stuck on rigid friction, or behind a coarse encoder, shows no presliding: its torque
follows the drive while its position stands still, and no law driven by the motion can predict it.
Such samples pull a fit away from every other one, so they are found and left out.
"""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_opening, maximum_filter1d

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import Q, V
from frictionjoint.identify.fit import Fit, refit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.shape import INTEGRATED, Shape
from frictionjoint.identify.start import predict
from frictionjoint.identify.starts import fit

# speeds, over the top speed: below the second a joint may count as at rest
_SLOWEST, _REST = 1e-4, 0.03
# rms of the residual at rest over the rms friction, and over that of all other samples, from
# which on the rest is looked at
_LARGE, _APART = 0.25, 1.5
# share of the torque's variance at rest that the position must explain to count as resolved
_TOLD = 0.5
# how far leaving out the rest must lower the rms of all other samples
_BETTER = 0.8
_BINS = 24
# kept samples in a row that make a stay at rest
_LEAST_STAY = 8
# how far the filter reaches, in periods of its corner, and the share of the moving samples that
# must be left without what it reaches
_REACHES, _LEAST_LEFT = (2.0, 1.0, 0.5, 0.0), 0.6
# periods of the filter's corner from which on a rest carries far: a reversal is over sooner
_LONG = 0.5


def resolved(
    prepared: Prepared, fitted: Fit, forms: Sequence[Shape] = INTEGRATED
) -> tuple[Prepared, Fit]:
    """Leave out the rest that the position does not resolve, and fit the same terms again."""
    speed, moving = _rest_speed(prepared, fitted, forms)
    if speed <= prepared.rest_speed:
        return prepared, fitted
    prepared = without_rest(prepared, speed)
    return prepared, refit(prepared, moving.terms, moving.shape)


def _rest_speed(prepared: Prepared, fitted: Fit, forms: Sequence[Shape]) -> tuple[float, Fit]:
    """Speed below which the position does not tell the torque, rad/s; 0 where it always does.

    Args:
        fitted: on all samples.
    Returns:
        the speed, and a fit without rest where there is one to leave out.
    """
    v, e = _kept_speed(prepared), fitted.residual
    top = float(np.quantile(v, 0.99))
    slow = v < _REST * top
    friction = float(np.sqrt(np.mean(fitted.friction**2)))
    if slow.sum() < 0.002 * len(v) or slow.all():
        return 0.0, fitted
    stuck = _stuck(prepared, _REST * top) * fitted.gain > _LARGE * friction
    if not stuck and _rms(e[slow]) < max(_LARGE * friction, _APART * _rms(e[~slow])):
        return 0.0, fitted
    # judged without their neighbours, whose absence is no merit of the fit
    # a fit of samples that a rest pulls at may lie anywhere, one without that rest lies near
    left = _moving(prepared, _REST * top, 0.0)
    if prepared.rest_speed > 0.0:
        moving = refit(left, fitted.terms, fitted.shape)
    else:
        moving = fit(left, fitted.terms, forms)
    if not stuck and moving.rms > _BETTER * _rms(e[~slow]):
        return 0.0, fitted
    error = predict(prepared, moving).error
    edges = top * np.geomspace(_SLOWEST, _REST, _BINS)
    unresolved = 0.0
    for low, high in itertools.pairwise(edges):
        inside = (v >= low) & (v < high)
        if inside.any() and _rms(error[inside]) > _APART * moving.rms:
            unresolved = float(high)
    return unresolved, moving


def _stuck(prepared: Prepared, speed: float) -> float:
    """rms over all rest of the drive that the position does not tell; 0 where it tells enough.

    Within a stay at rest the drive is a curve of the position, steep where presliding is stiff;
    a drive that wanders while the position stands is not.
    """
    left, whole, n = 0.0, 0.0, 0
    for s in prepared.segments:
        drive, v, q = s.lowpass(s.drive), s.signals[:: s.step, V], s.signals[:: s.step, Q]
        slow = s.kept & (np.abs(v) < speed)
        edges = np.flatnonzero(np.diff(slow, prepend=False, append=False))
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            if end - begin < _LEAST_STAY:
                continue
            d, x = drive[begin:end], q[begin:end]
            curve = np.vander((x - x.mean()) / (np.ptp(x) or 1.0), 4)
            left += float(np.sum((d - curve @ np.linalg.lstsq(curve, d, rcond=None)[0]) ** 2))
            whole += float(np.sum((d - d.mean()) ** 2))
            n += end - begin
    return (left / n) ** 0.5 if n and left > (1.0 - _TOLD) * whole else 0.0


def without_rest(prepared: Prepared, speed: float) -> Prepared:
    """The logs without the samples slower than `speed`, rad/s, and the neighbours of a stay.

    The filter carries the torque of a stay at rest, which nothing tells, into the motion around it.
    As far as it reaches, samples are left out too; less far where a narrow band and many stays
    would leave too few.
    """
    least = _LEAST_LEFT * _moving(prepared, speed, 0.0).samples
    tried = (_moving(prepared, speed, reach) for reach in _REACHES)
    return replace(next(x for x in tried if x.samples >= least), rest_speed=speed)


def _moving(prepared: Prepared, speed: float, reach: float) -> Prepared:
    """The logs without rest and what is nearer to a stay than `reach` over the bandwidth."""
    segments = []
    for s in prepared.segments:
        near = int(reach / (s.bandwidth_hz * s.dt))
        rest = np.abs(s.signals[:, V]) < speed
        long = int(np.ceil(_LONG / (s.bandwidth_hz * s.dt))) + 1
        stays = binary_opening(rest, np.ones(long))
        left = s.mask & ~rest & ~maximum_filter1d(stays, 2 * near + 1)
        segments.append(replace(s, mask=left))
    return replace(prepared, segments=tuple(segments))


def _kept_speed(prepared: Prepared) -> Array:
    return np.concatenate([np.abs(s.signals[:: s.step, V][s.kept]) for s in prepared.segments])


def _rms(e: Array) -> float:
    return float(np.sqrt(np.mean(e**2))) if e.size else 0.0
