"""An independent least squares of one joint, to judge an identification by: numpy and scipy only.

drive = inertia a + viscous v + Coulomb sign(v) + bias + gravity (c sin q + s cos q)

Accelerations come from the position with a zero-phase low-pass filter; drive and regressors pass
the same filter. Nothing of the package is used.
"""

import numpy as np
from scipy.signal import butter, sosfiltfilt

# of the sampling rate, and Hz at most: passband of the filter
PASSBAND, FASTEST = 0.1, 20.0
# of the largest speed: slower samples are no motion
MOVES = 0.03


def columns(time, position, drive, gravity):
    """Regressors and drive of one log on an even grid, and which samples are in motion."""
    step = float(np.median(np.diff(time)))
    grid = np.arange(time[0], time[-1], step)
    q, u = (np.interp(grid, time, x) for x in (position, drive))
    low = butter(4, min(PASSBAND / step, FASTEST) * 2.0 * step, output="sos")
    q = _filtered(low, q)
    v = np.gradient(q, step)
    a = np.gradient(v, step)
    parts = [a, v, np.tanh(v / (1e-3 * np.max(np.abs(v)) + 1e-30)), np.ones_like(v)]
    parts += [np.sin(q), np.cos(q)] if gravity else []
    return np.stack([_filtered(low, x) for x in parts], 1), _filtered(low, u), np.abs(v)


def _filtered(low, x):
    return sosfiltfilt(low, x, padlen=min(len(x) - 1, 200))


def held_out_error(fitted, held_out, gravity):
    """rms error in motion on held-out logs over the rms of their drive, and the coefficients.

    Args:
        fitted, held_out: lists of (time, position, drive).
    """
    rows = [columns(*log, gravity) for log in fitted]
    fastest = max(float(speed.max()) for *_, speed in rows)
    x = np.concatenate([part[speed > MOVES * fastest] for part, _, speed in rows])
    y = np.concatenate([drive[speed > MOVES * fastest] for _, drive, speed in rows])
    scale = np.maximum(np.sqrt(np.mean(x * x, 0)), 1e-300)
    found = np.linalg.lstsq(x / scale, y, rcond=1e-10)[0] / scale
    left = size = 0.0
    for part, drive, speed in (columns(*log, gravity) for log in held_out):
        moving = speed > MOVES * fastest
        left += float(np.sum((drive - part @ found)[moving] ** 2))
        size += float(np.sum(drive[moving] ** 2))
    return np.sqrt(left / size) if size else np.nan, found
