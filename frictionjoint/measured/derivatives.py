"""Zero-phase velocity and acceleration of a measured position, with the bandwidth stated.

A jittered log is first laid on a uniform grid (`uniform_motion`). The filter is a Butterworth
low-pass run forwards and backwards, so it shifts nothing in time; derivatives are central
differences of its output.

These average too: the acceleration of a sample is the mean over two samples on either side,
weighted as a triangle. Near the top of a slow log's band it is half gone, so whatever is balanced
against it has to be averaged alike (`as_differenced`).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import Akima1DInterpolator
from scipy.ndimage import convolve1d
from scipy.signal import butter, sosfilt, sosfilt_zi, welch

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog

_ORDER = 2  # run twice: fourth order in all
# Highest corner: four fifths of the Nyquist frequency leaves the filter well posed.
_HIGHEST = 0.4
# Bands an octave in which the spectrum is averaged.
_BANDS = 6
# share of the travel by which one position, computed twice, may differ
_ROUNDING = 1e-12
# (1, 16, 26, 16, 1) / 60: variance 2/3 and fourth moment 16/15, in samples
_TRIANGLE = np.array([1.0, 16.0, 26.0, 16.0, 1.0]) / 60.0


@dataclass(frozen=True)
class Derivatives:
    """Smooth motion on a uniform grid, each of shape (n,).

    Attributes:
        time: s. position, velocity, acceleration: rad, rad/s, rad/s^2 (m ...).
        bandwidth_hz: -3 dB corner of one pass of the filter.
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    bandwidth_hz: float


def uniform(time: Array, x: Array, grid: Array) -> Array:
    """A measured column on a uniform grid, by linear interpolation."""
    return np.interp(grid, time, x)


def uniform_motion(time: Array, position: Array, grid: Array) -> Array:
    """A measured position on a uniform grid, smooth between the samples where they tell a bend.

    A straight line between two samples cuts the bend of the motion, by another amount wherever
    the clock jitters: differentiated twice, that is noise. Modified Akima pieces are local, so
    that a gap in the log makes no waves. Where all of the bend is less than the noise of the
    encoder's count, smooth pieces follow the counts and not the joint: straight ones are taken.
    """
    straight = uniform(time, position, grid)
    pieces = Akima1DInterpolator(time, position, method="makima")
    smooth = np.asarray(pieces(np.clip(grid, time[0], time[-1])))
    apart = np.diff(np.sort(position))
    count = float(apart[apart > _ROUNDING * np.ptp(position)].min(initial=np.inf))
    bend = float(np.sqrt(np.mean((smooth - straight) ** 2)))
    return smooth if bend > count / np.sqrt(12.0) else straight


def zero_phase(x: Array, dt: float, bandwidth_hz: float) -> Array:
    """Low-pass along axis 0 without a shift in time; nothing is done above 0.4 / dt.

    Args:
        x: shape (n,) or (n, k), on a uniform grid of step `dt` in s.
        bandwidth_hz: -3 dB corner of one of the two passes.
    Raises:
        LogError: the bandwidth or the step is not positive.
    """
    if not (bandwidth_hz > 0.0 and dt > 0.0):
        raise LogError(f"bandwidth {bandwidth_hz} Hz at a step of {dt} s: give positive numbers")
    if bandwidth_hz >= _HIGHEST / dt:
        return x
    pad = min(len(x) - 1, max(15, int(1.5 / (bandwidth_hz * dt))))
    sections, settled = _sections(bandwidth_hz, dt)
    settled = settled.reshape(*settled.shape, *(1,) * (x.ndim - 1))
    # what `scipy.signal.sosfiltfilt` does, but for the settled state, which it solves for each time
    out = np.concatenate([2.0 * x[0] - x[pad:0:-1], x, 2.0 * x[-1] - x[-2 : -pad - 2 : -1]])
    for _ in range(2):
        out, _state = sosfilt(sections, out, axis=0, zi=settled * out[0])
        out = out[::-1]
    return np.asarray(out[pad : pad + len(x)])


def as_differenced(x: Array) -> Array:
    """Average along axis 0 with the weights that central differences give an acceleration.

    The weights have the second and the fourth moment of the triangle, and so its response up to
    two thirds of the Nyquist frequency.
    """
    averaged: Array = convolve1d(x, _TRIANGLE, axis=0, mode="nearest")
    return averaged


@lru_cache(maxsize=256)
def _sections(bandwidth_hz: float, dt: float) -> tuple[Array, Array]:
    """Of the filter of one pass, and their state where the input has long been 1.

    A search filters with the same few many thousand times.
    """
    sections = np.asarray(butter(_ORDER, bandwidth_hz, fs=1.0 / dt, output="sos"))
    return sections, np.asarray(sosfilt_zi(sections))


def motion_bandwidth(position: Array, dt: float) -> float:
    """Corner frequency from the motion's own spectrum, Hz.

    Differentiated twice, the motion falls off towards high frequencies and the position's noise
    rises. The corner is twice the frequency of the valley between the two, and no less than 5 Hz,
    which keeps the edges of friction.
    """
    n = len(position)
    f, power = welch(position, 1.0 / dt, nperseg=min(n, max(1024, n // 4)), detrend="linear")
    f, power = f[1:], power[1:]
    edges = np.geomspace(f[0], f[-1], max(2, int(_BANDS * np.log2(f[-1] / f[0]))))
    band = np.digitize(f, edges)
    bands = np.unique(band)
    centre = np.array([np.exp(np.log(f[band == k]).mean()) for k in bands])
    motion = np.array([power[band == k].sum() for k in bands])
    acceleration = np.array([(power * f**4)[band == k].mean() for k in bands])
    main = int(np.argmax(motion))
    valley = centre[main + int(np.argmin(acceleration[main:]))]
    return float(np.clip(2.0 * valley, 5.0, _HIGHEST / dt))


def differentiate(log: JointLog, bandwidth_hz: float | None = None) -> Derivatives:
    """Smooth position, velocity and acceleration of a log on a uniform grid.

    Args:
        bandwidth_hz: of the filter; None: `motion_bandwidth` of this log.
    Raises:
        LogError: the bandwidth is not positive.
    """
    n = len(log.time)
    dt = float(log.time[-1] - log.time[0]) / (n - 1)
    time = log.time[0] + dt * np.arange(n)
    position = uniform_motion(log.time, log.position, time)
    if bandwidth_hz is None:
        bandwidth_hz = motion_bandwidth(position, dt)
    smooth = zero_phase(position, dt, bandwidth_hz)
    velocity = np.gradient(smooth, dt)
    return Derivatives(time, smooth, velocity, np.gradient(velocity, dt), bandwidth_hz)
