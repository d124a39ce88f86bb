"""Noise of a log's instruments, and the usable band and samples of its torque balance.

Differentiating a position twice turns its noise into a torque that grows with the square of the
frequency, J (2 pi f)^2 times as much. Where that exceeds the torque's own noise the log contains no
information on the joint, and whatever cancels it (a lighter link, a snap) looks like an effect. So
the band ends where position noise is still a small part of the whole noise.

The torque noise is measured above the band of the motion. So is the position noise, except for the
encoder count, which is not white: it beats with the samples at constant speed and vanishes at rest,
so its error is computed along the actual motion.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, uniform_filter1d
from scipy.special import gammaincinv

from frictionjoint.arrays import Array
from frictionjoint.measured.derivatives import SAME_POSITION, power_density
from frictionjoint.measured.lowpass import gentle, steep
from frictionjoint.measured.repairs import interpolated, lone_readings


@dataclass(frozen=True)
class Band:
    """Corners of the filters of the torque balance and of the motion, Hz."""

    balance: float
    motion: float
    zero_order_hold: bool = False  # whether a measured drive is constant between samples
    sensor_saturates: bool = False  # whether samples at the end of its range are unused


def clear_of(unknown: NDArray[np.bool_], bandwidth_hz: float, dt: float) -> NDArray[np.bool_]:
    """Samples at least one period of the filter's corner away from unknown torque, which the filter
    spreads over that time, shape (n,)."""
    reach = max(1, int(1.0 / (bandwidth_hz * dt)))
    return np.asarray(~maximum_filter1d(unknown, 2 * reach + 1, mode="constant", cval=False))


@dataclass(frozen=True)
class Noise:
    """Noise of one log."""

    torque: float  # one-sided density, (unit of the drive)^2 / Hz
    frequency: Array = field(repr=False)  # Hz, shape (m,)
    position: Array = field(repr=False)  # density of the position noise there, rad^2 / Hz
    inertia: float  # drive per acceleration of the joints that move, kg m^2 if it is a torque
    count: float  # encoder step, rad; 0 if the log has none

    @property
    def resolution(self) -> float:
        """rms error of a single position, rad."""
        df = float(self.frequency[1]) if len(self.frequency) > 1 else 0.0
        return float(max(self.count / np.sqrt(12.0), np.sqrt(self.position.sum() * df)))

    def left(self, corner_hz: float) -> tuple[float, float]:
        """Noise power of torque and position after the filter of the balance."""
        f = self.frequency
        passed = gentle(f / corner_hz) ** 2
        df = float(f[1]) if len(f) > 1 else 0.0
        made = (self.inertia * (2.0 * np.pi * f) ** 2) ** 2 * self.position
        return self.torque * float(np.sum(passed)) * df, float(np.sum(made * passed)) * df

    def band_hz(self, least: float, most: float) -> float:
        """Corner frequency of the balance for this noise, within given limits."""
        for corner in np.geomspace(most, least, 60):
            torque, position = self.left(float(corner))
            # the position's noise may add 5% to the torque's
            if position <= 0.05 * torque:
                return float(corner)
        return least


def density_above(x: Array, dt: float) -> float:
    """Noise density of a signal, measured at frequencies above its motion, unit^2 / Hz.

    The median is not affected by spectral lines. For a spectrum averaged over few segments the
    median is below the mean, and is corrected as for a chi-squared variable.
    """
    # pieces of 1024 samples with a Hann window that overlap by half; the squared correlation of the
    # spectra of two is 1/36 (Welch 1967)
    window = min(len(x), 1024)
    # a single wrong reading has all frequencies, and is no noise
    x = interpolated(x, lone_readings(x))
    f, power = power_density(x, dt, window, detrend="linear")
    # these frequencies are taken to hold noise alone
    above = (f >= 0.25 / dt) & (f <= 0.45 / dt)
    if not above.any():
        return 0.0
    pieces = (len(x) - window) // (window - window // 2) + 1
    freedom = 2.0 * pieces / (1.0 + (2.0 / 36.0) * (1.0 - 1.0 / pieces))
    return float(np.median(power[above]) * freedom / (2.0 * gammaincinv(freedom / 2.0, 0.5)))


def count_of(position: Array) -> float:
    """Step of the encoder, rad, by multiples of which measured positions differ; 0: none."""
    apart = np.diff(np.unique(position))
    apart = apart[apart > SAME_POSITION * np.ptp(position)]
    if not apart.size:
        return 0.0
    step = float(np.mean(apart[apart < 1.5 * apart.min()]))
    # near ones; any differences lie a quarter off whole numbers on average
    counts = apart[apart < 50.0 * step] / step
    whole = np.abs(counts - np.round(counts)).mean() < 0.05
    return step if whole and len(counts) > 0.5 * len(apart) else 0.0


def noise_of(
    drive: Array, position: Array, smooth: Array, dt: float, count: float, inertia: float
) -> Noise:
    """Noise of a log, from drive and position as measured and the position behind the filter of the
    motion, each of shape (n,) on a uniform grid of step `dt`."""
    error = np.zeros_like(smooth)
    if count > 0.0:
        error = np.round((smooth - position[0]) / count) * count + position[0] - smooth
    n = min(len(error), 4096)
    f, made = power_density(error, dt, n)
    level = np.maximum(made, density_above(position, dt))
    return Noise(density_above(drive, dt), f, level, inertia, count)


def corner_above_noise(torque: Array, dt: float, bandwidth_hz: float, corner_hz: float) -> float:
    """Corner, Hz, of the band in which the torque of a rigid body, every dt s, exceeds its noise,
    given the corners of the balance and of the motion that it was computed from."""
    # 20 periods of the balance's corner
    window = min(len(torque), int(20.0 / (bandwidth_hz * dt)))
    f, power = power_density(torque, dt, window)
    inside = (f > 0.0) & (f <= corner_hz)
    f, power = f[inside], power[inside]
    ratio = f / corner_hz
    # white noise of a position is one of the acceleration that grows as the fourth power of
    # the frequency; near the corner of the motion there is almost nothing else
    growing, top = steep(ratio) ** 2 * ratio**4, ratio > 0.6
    noise = growing * (np.median(power[top] / growing[top]) if top.any() else 0.0)
    # up to where half of the power is noise for the first time, whatever lines lie beyond; the
    # spectrum of a repeated motion has gaps
    around = uniform_filter1d(power - 2.0 * noise, 9, mode="nearest")
    return float(np.append(f[around <= 0.0], corner_hz)[0])
