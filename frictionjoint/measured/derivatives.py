"""Smooth motion of a measured position: a uniform grid, its bandwidth, its derivatives.

A log with jitter is first interpolated to a uniform grid (`uniform_motion`). The filter is flat
over the band in which torques are balanced, so that the balance, which passes a filter of its own
(`LowPass`), sees the same motion on both sides.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import Akima1DInterpolator
from scipy.special import gammaincinv

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.lowpass import LowPass, steep

# Highest corner: four fifths of the Nyquist frequency leaves the filter room to fall.
HIGHEST = 0.4
# fraction of the travel by which one position, computed twice, may differ
SAME_POSITION = 1e-12
# the least corner, Hz, which keeps the edges of friction
LEAST_HZ = 5.0


@dataclass(frozen=True)
class Derivatives:
    """Smooth motion on a uniform grid, each of shape (n,), in s, rad, rad/s and rad/s^2 (m ...);
    half of the amplitude passes the filter at `bandwidth_hz`."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    bandwidth_hz: float


@dataclass(frozen=True)
class MotionBand:
    """Frequency bands of a motion, Hz: 99% of the velocity's power is below `main`, and the
    position exceeds the noise below `whole`, at least 5 Hz."""

    main: float
    whole: float


def uniform_motion(time: Array, position: Array, grid: Array) -> Array:
    """A measured position on a uniform grid, interpolated smoothly where the motion is curved.

    Linear interpolation cuts corners, by an amount that varies with clock jitter: noise when
    differentiated twice. Modified Akima pieces are local, so a gap in the log causes no
    oscillation. Where they would follow the counts of an encoder, linear ones are used.
    """
    straight = np.interp(grid, time, position)
    pieces = Akima1DInterpolator(time, position, method="makima")
    smooth = np.asarray(pieces(np.clip(grid, time[0], time[-1])))
    apart = np.diff(np.sort(position))
    count = float(apart[apart > SAME_POSITION * np.ptp(position)].min(initial=np.inf))
    bend = root_mean_square(smooth - straight)
    return smooth if bend > count / np.sqrt(12.0) else straight


def power_density(x: Array, dt: float, samples: int, **options: str) -> tuple[Array, Array]:
    """Frequencies, Hz, and one-sided density of a signal, shape (n,), every dt s, averaged over
    windows that overlap by half; options as those of scipy's `welch`."""
    from scipy.signal import welch  # takes half a second to import

    found: tuple[Array, Array] = welch(x, 1.0 / dt, nperseg=samples, **options)
    return found


def motion_band(position: Array, dt: float) -> MotionBand:
    """Frequency bands of a motion, from its spectrum: up to twice the frequency of the minimum
    between motion that falls off and position noise that rises, both in the second derivative."""
    n = len(position)
    f, power = power_density(position, dt, min(n, max(1024, n // 4)), detrend="linear")
    f, power = f[1:], power[1:]
    # six bands per octave
    edges = np.geomspace(f[0], f[-1], max(2, int(6 * np.log2(f[-1] / f[0]))))
    band = np.digitize(f, edges)
    bands = np.unique(band)
    centre = np.array([np.exp(np.log(f[band == k]).mean()) for k in bands])
    motion = np.array([power[band == k].sum() for k in bands])
    acceleration = np.array([(power * f**4)[band == k].mean() for k in bands])
    largest = int(np.argmax(motion))
    valley = centre[largest + int(np.argmin(acceleration[largest:]))]
    below = f <= valley
    grown = np.cumsum((power * f**2)[below])
    # the motion ends where 99% of the velocity's power is below
    main = f[below][int(np.searchsorted(grown, 0.99 * grown[-1]))] if below.any() else f[0]
    whole = float(np.clip(2.0 * valley, LEAST_HZ, HIGHEST / dt))
    return MotionBand(min(float(main), whole), whole)


def position_noise(position: Array, dt: float, corner_hz: float) -> float:
    """Standard deviation of white position noise, from the spectrum above the motion, whose band
    ends at a corner, rad (m); of a position on a uniform grid of step dt, s, shape (n,)."""
    # a window with side lobes so low that the motion does not leak into the noise
    n = min(len(position), 512)
    f, power = power_density(position, dt, n, window="blackmanharris", detrend="linear")
    # noise alone is above one and a half times the corner, where the spectrum goes so far
    above = f >= min(1.5 * corner_hz, HIGHEST / dt)
    # a median, which a line of the mains does not raise; the power of noise is chi-square
    # distributed with two degrees of freedom per average
    parts = max(1, 2 * len(position) // n - 1)
    density = float(np.median(power[above])) / (2.0 * gammaincinv(parts, 0.5) / (2 * parts))
    return float(np.sqrt(density * 0.5 / dt))


def differentiate(log: JointLog, bandwidth_hz: float | None = None) -> Derivatives:
    """Smooth position, velocity and acceleration of a log on a uniform grid, by a filter with a
    positive corner, Hz; None: the whole `motion_band` of this log."""
    time, position, dt = on_a_grid(log)
    if bandwidth_hz is None:
        bandwidth_hz = motion_band(position, dt).whole
    if not bandwidth_hz > 0.0:
        raise LogError(f"bandwidth {bandwidth_hz} Hz: give a positive number")
    smooth = LowPass(len(time), dt, min(bandwidth_hz, HIGHEST / dt), steep)
    return Derivatives(time, *smooth.motion(position), bandwidth_hz)


def followed(log: JointLog) -> Derivatives:
    """Smooth motion for initial states of simulations, in the band that predicts positions best.

    The band minimises generalised cross-validation (Craven and Wahba 1979): the squared residual of
    the filter over the square of the removed fraction of the spectrum. Among bands within a
    standard error of the best, the narrowest is used, for a velocity has relatively more noise. In
    a slow motion measured in coarse steps `motion_band` may not separate motion from noise.
    """
    _, position, dt = on_a_grid(log)
    highest = HIGHEST / dt
    # a third of an octave apart where the log has 200 Hz
    bands = np.geomspace(min(LEAST_HZ, highest), highest, 12)
    motions = [differentiate(log, band) for band in bands]
    left = np.array([np.mean((motion.position - position) ** 2) for motion in motions])
    left /= (1.0 - 2.0 * bands * dt) ** 2
    # of a mean square of n errors that are independent and normal
    enough = (1.0 + np.sqrt(2.0 / len(position))) * left.min()
    return motions[int(np.argmax(left <= enough))]


def on_a_grid(log: JointLog) -> tuple[Array, Array, float]:
    """Time and position of a log on a uniform grid, each of shape (n,), and its step in s."""
    n = len(log.time)
    dt = float(log.time[-1] - log.time[0]) / (n - 1)
    time = log.time[0] + dt * np.arange(n)
    return time, uniform_motion(log.time, log.position, time), dt


def speed_note(log: JointLog) -> tuple[str, ...]:
    """A note if the velocity is not the derivative of the position; empty if it is."""
    if log.velocity is None:
        return ()
    integral = cumulative_trapezoid(log.velocity, log.time, initial=0.0)
    # over 0.1 s encoder counts average out
    width = max(1, round(0.1 * (len(log.time) - 1) / log.duration))
    said, moved = (np.diff(x[::width]) for x in (integral, log.position))
    power, common, slopes = float(said @ said), float(said @ moved), float(moved @ moved)
    # only a correlation above 0.95 is sure, and only a ratio 5% off is stated
    if common**2 <= 0.9 * power * slopes or abs(common / power - 1.0) <= 0.05:
        return ()
    return (
        f"{log.name}: the measured velocity is {power / common:.3g} times the slope of the "
        "position; the slope is used.",
    )


def first_velocity(time: Array, position: Array, count: float) -> float:
    """Velocity at the first sample, rad/s (m/s): 0 at rest, otherwise from a parabola.

    A filter of the whole motion has no data before the first sample, and can return several rad/s
    in the wrong direction for a joint that starts from rest. The parabola spans as many samples as
    it fits to within half a count, the encoder's step, rad (m), because rounding makes a velocity
    uncertain by about one count per duration; without a count it spans the shortest interval.
    """
    t, q = time - time[0], position - position[0]
    # the shortest interval, s
    least = max(3, int(np.searchsorted(t, 0.02, side="right")))
    if np.max(np.abs(q[:least])) <= 0.5 * count:
        return 0.0
    found = 0.0
    # the longest, s, applies to a joint that is almost at rest
    for n in range(least, max(least, int(np.searchsorted(t, 0.2, side="right"))) + 1):
        parabola = np.polynomial.Polynomial.fit(t[:n], q[:n], 2)
        off = float(np.max(np.abs(parabola(t[:n]) - q[:n])))
        if n > least and off > 0.5 * count:
            break
        found = float(parabola.deriv()(0.0))
    return found
