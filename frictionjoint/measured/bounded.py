"""Logs too long to fit in reasonable time and memory, made shorter; never without saying so.

First neighbouring samples are averaged, as far as ten samples remain in the shortest period of the
motion: time, position and torque alike, so that the balance of torques is filtered on both sides.
What is still too long is cut after its first part.
"""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.measured.derivatives import motion_band, uniform_motion
from frictionjoint.measured.gaps import split_at_gaps
from frictionjoint.measured.log import JointLog

# Rows of all logs of a fit together: a fit holds some 8 kB a row meanwhile, and its time grows in
# proportion. Above this many, half a minute and 1 GB.
MOST_ROWS = 100_000
_SAMPLES_A_PERIOD = 10.0
_FEWEST = 1000


class LongLogWarning(UserWarning):
    """Not every sample of a log is used as it was measured."""


def bounded(logs: Sequence[JointLog]) -> list[JointLog]:
    """The logs, split at their gaps and together within `MOST_ROWS`; names say what was done.

    Raises:
        LogError: see `split_at_gaps`.
    Warns:
        LongLogWarning: one line for each log that is made shorter.
    """
    logs = [part for log in logs for part in split_at_gaps(log)]
    total = sum(len(log.time) for log in logs)
    if total <= MOST_ROWS:
        return logs
    return [_shorter(log, max(_FEWEST, int(len(log.time) * MOST_ROWS / total))) for log in logs]


def _shorter(log: JointLog, most: int) -> JointLog:
    n = len(log.time)
    if n <= most:
        return log
    k = min(-(-n // most), _most_averaged(log))
    short = _averaged(log, k) if k > 1 else log
    done = [f"{k} samples averaged"] if k > 1 else []
    if len(short.time) > most:
        short = replace(short.part(slice(0, most), ""), before=short.before)
        done.append(f"first {short.duration:.4g} s")
    text = ", ".join(done)
    warnings.warn(
        f"{log.name}: {n} rows are more than a fit takes, used: {text}; cut the log for another "
        "choice",
        LongLogWarning,
        stacklevel=3,
    )
    return replace(short, name=f"{log.name} ({text})")


def _most_averaged(log: JointLog) -> int:
    """How many neighbours may be averaged without touching the motion."""
    n = min(len(log.time), MOST_ROWS)
    time = log.time[:n]
    dt = float(time[-1] - time[0]) / (n - 1)
    position = uniform_motion(time, log.position[:n], time[0] + dt * np.arange(n))
    return max(1, int(1.0 / (_SAMPLES_A_PERIOD * motion_band(position, dt).whole * dt)))


def _averaged(log: JointLog, k: int) -> JointLog:
    def mean(x: Array) -> Array:
        out: Array = x[: len(x) // k * k].reshape(-1, k).mean(axis=1)
        return out

    columns: dict[str, Any] = {
        name: mean(x) for name, x in log.columns().items() if name != "torque_enabled"
    }
    if log.torque_enabled is not None:
        whole = log.torque_enabled[: len(log.time) // k * k].reshape(-1, k)
        columns["torque_enabled"] = whole.all(axis=1)
    return replace(
        log,
        other_positions={name: mean(x) for name, x in log.other_positions.items()},
        other_velocities={name: mean(x) for name, x in log.other_velocities.items()},
        signals={name: mean(x) for name, x in log.signals.items()},
        before=_averaged(log.before, k) if log.before else None,
        **columns,
    )
