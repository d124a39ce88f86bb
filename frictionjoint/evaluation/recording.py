"""One log of one or more joints, resampled on the time grid of the model."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.derivatives import HIGHEST, motion_band, on_a_grid, uniform_motion
from frictionjoint.measured.log import DRIVES, JointLog
from frictionjoint.measured.lowpass import REACH, LowPass, steep
from frictionjoint.measured.repairs import silent_runs


@dataclass(frozen=True)
class Recording:
    """A log prepared for comparison.

    Attributes:
        logs: as read, by joint.
        time: s, from 0, shape (n,). step: sampling interval, s.
        motion: smooth position, velocity and acceleration by joint, each of shape (n,).
        led: the motion of joints that are not evaluated, in the same form.
        drive: as measured, by joint, shape (n,). filtered: the drive after the filter of the
            motion.
        kinds: "torque", "voltage" or "current" by joint.
        known: whether the drive is known, by joint, shape (n,).
        temperature: deg C, of joints whose log contains it, shape (n,).
        filter: of the motion, for a torque on this grid, shape (n,).
    """

    logs: dict[str, JointLog]
    time: Array
    step: float
    motion: dict[str, tuple[Array, Array, Array]]
    led: dict[str, tuple[Array, Array, Array]]
    drive: dict[str, Array]
    filtered: dict[str, Array]
    kinds: dict[str, str]
    known: dict[str, NDArray[np.bool_]]
    temperature: dict[str, Array]
    filter: LowPass

    @classmethod
    def of(
        cls,
        logs: Mapping[str, JointLog],
        corner: float | None = None,
        steps: tuple[float, float] = (0.0, 1e-3),
    ) -> "Recording":
        """Put the joints of one log on a uniform grid.

        Args:
            logs: of each joint to evaluate, all with the same times.
            corner: of the filter, Hz; None: where the noise of the positions begins.
            steps: shortest and longest step of the grid, s.
        """
        first = next(iter(logs.values()))
        raw_time, _, sample = on_a_grid(first)
        raw = {name: on_a_grid(log)[1] for name, log in logs.items()}
        if corner is None:
            corner = max(motion_band(position, sample).whole for position in raw.values())
        corner = min(corner, HIGHEST / sample)
        every, up = max(1, int(steps[0] / sample)), max(1, int(np.ceil(sample / steps[1] - 1e-6)))
        finer = LowPass(len(raw_time), sample, corner, steep, every, up)
        step, n = sample * every / up, finer.given
        time = raw_time[0] + step * np.arange(n)
        others = {n: q for n, q in first.other_positions.items() if n not in logs}
        kinds = {name: _kind(log) for name, log in logs.items()}
        edge = int(REACH / (corner * step))
        inside = np.zeros(n, dtype=bool)
        inside[edge : n - edge] = True
        measured = {name: getattr(log, kinds[name]) for name, log in logs.items()}
        return cls(
            logs=dict(logs),
            time=time - time[0],
            step=step,
            motion={name: finer.motion(position) for name, position in raw.items()},
            led={
                name: finer.motion(uniform_motion(first.time, q, raw_time))
                for name, q in others.items()
            },
            drive={name: np.interp(time, logs[name].time, x) for name, x in measured.items()},
            filtered={
                name: finer(np.interp(raw_time, logs[name].time, x)) for name, x in measured.items()
            },
            kinds=kinds,
            known={name: inside & _known(log, time) for name, log in logs.items()},
            temperature={
                name: np.interp(time, log.time, log.temperature)
                for name, log in logs.items()
                if log.temperature is not None
            },
            filter=LowPass(n, step, corner, steep),
        )


def _kind(log: JointLog) -> str:
    for kind in DRIVES:
        if getattr(log, kind) is not None:
            return kind
    raise LogError(f"{log.name}: no torque, voltage or current, add one of them")


def _known(log: JointLog, time: Array) -> NDArray[np.bool_]:
    """Whether the logged drive moved the joint, for each sample."""
    known = np.ones(len(log.time), dtype=bool)
    if log.torque_enabled is not None:
        known &= log.torque_enabled
    for begin, end in silent_runs(log.time, log.position, getattr(log, _kind(log))):
        known[begin:end] = False
    return np.asarray(np.interp(time, log.time, known.astype(float)) > 0.999)
