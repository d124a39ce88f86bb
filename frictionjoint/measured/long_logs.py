"""Shortening of logs that are too long for a fit, always with a warning.

First, neighbouring samples are averaged while ten samples remain per shortest period of the
motion. Time, position and torque are averaged alike, so the torque balance is preserved. A log
that is still too long is cut at its end.
"""

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.measured.derivatives import motion_band, on_a_grid
from frictionjoint.measured.log import JointLog, split_at_gaps

# Total rows of a fit, which needs about 8 kB and a constant time per row: at this limit half a
# minute and 1 GB.
MOST_ROWS = 100_000


class LongLogWarning(UserWarning):
    """A log was averaged or cut."""


def shortened(logs: Sequence[JointLog]) -> list[JointLog]:
    """The logs, split at gaps and shortened to `MOST_ROWS` in total; their names say how, and a
    LongLogWarning for each. LogError: see `split_at_gaps`."""
    logs = [part for log in logs for part in split_at_gaps(log)]
    total = sum(len(log.time) for log in logs)
    if total <= MOST_ROWS:
        return logs
    return [_shorter(log, max(1000, int(len(log.time) * MOST_ROWS / total))) for log in logs]


def _shorter(log: JointLog, most: int) -> JointLog:
    n = len(log.time)
    if n <= most:
        return log
    _, position, dt = on_a_grid(log.part(slice(0, MOST_ROWS), ""))
    # ten samples remain in the shortest period
    k = min(-(-n // most), max(1, int(1.0 / (10.0 * motion_band(position, dt).whole * dt))))
    short = _averaged(log, k) if k > 1 else log
    done = [f"{k} samples averaged"] if k > 1 else []
    if len(short.time) > most:
        short = replace(short.part(slice(0, most), ""), before=short.before)
        done.append(f"first {short.duration:.4g} s")
    text = ", ".join(done)
    what = f"{n} rows are too many for a fit, it uses: {text}; cut the log to choose other rows"
    warnings.warn(f"{log.name}: {what}", LongLogWarning, stacklevel=3)
    return replace(short, name=f"{log.name} ({text})")


def _averaged(log: JointLog, k: int) -> JointLog:
    def mean(x: Array) -> Array:
        """Of neighbours; the drive is on where it is on in all of them."""
        parts = x[: len(x) // k * k].reshape(-1, k)
        return np.asarray(parts.all(axis=1) if x.dtype == np.bool_ else parts.mean(axis=1))

    return replace(log.mapped(mean), before=_averaged(log.before, k) if log.before else None)
