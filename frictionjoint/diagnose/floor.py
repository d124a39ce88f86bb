"""What the noise of the torque alone leaves of a perfect model."""

import numpy as np

from frictionjoint.identify.prepare import Prepared
from frictionjoint.measured.derivatives import zero_phase

# up to this multiple of the floor a residual counts as noise
AT_THE_FLOOR = 1.5


def noise_floor(prepared: Prepared, gain: float) -> float:
    """Torque noise behind the filters of the fit, N m: what a perfect model would leave.

    Noise is taken as white: its power above the bandwidth, where neither motion nor friction
    reaches, tells its power below. Where the bandwidth leaves too little above, the fourth
    differences of the torque tell it: the median passes over the edges of friction.
    """
    white = np.random.default_rng(0)
    powers = []
    for s in prepared.segments:
        nyquist = 0.5 / s.dt
        corner = min(s.bandwidth_hz, nyquist)
        if corner > 0.75 * nyquist:
            d = np.abs(np.diff(s.drive, 4))
            power = float(np.median(d) / 0.6745) ** 2 / 70.0
        else:
            # well above the corner, where the filter's skirt has ended
            end = min(0.78 * nyquist, 1.3 * corner)
            above = (s.drive - zero_phase(s.drive, s.dt, end))[s.mask]
            power = float(np.mean(above**2)) * nyquist / (nyquist - end)
        passed = float(np.mean(s.lowpass(white.standard_normal(len(s.drive))) ** 2))
        powers.append(power * passed)
    return gain * float(np.sqrt(np.mean(powers)))
