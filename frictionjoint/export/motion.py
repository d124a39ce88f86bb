"""The motions along which an export is fitted and its losses are measured."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.export.sliding import levels, stribeck_velocity
from frictionjoint.measured.derivatives import HIGHEST, differentiate
from frictionjoint.measured.lowpass import LowPass, steep
from frictionjoint.measured.readers import read_log
from frictionjoint.parameters import Friction

# of the stated motion: s between samples, s of one sine
_STEP, _PERIOD = 2e-3, 2.0


@dataclass(frozen=True)
class Motion:
    """A motion of one joint, arrays of shape (n,).

    Attributes:
        name: description. time: s, uniform steps. position, velocity, acceleration: rad, rad/s,
            rad/s^2 (m ...). others: positions of other joints by name.
    """

    name: str
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    others: dict[str, Array] = field(default_factory=dict)

    @property
    def speeds(self) -> Array:
        """Magnitudes of the velocity while the joint moves, rad/s."""
        speed = np.abs(self.velocity)
        # slower than a hundredth of the fastest counts as rest
        return np.asarray(speed[speed > 0.01 * speed.max()])

    @property
    def from_reversal(self) -> Array:
        """Distance travelled from the last reversal or to the next one, rad (m), shape (n,)."""
        step = np.diff(self.position, prepend=self.position[0])
        path, sign = np.cumsum(np.abs(step)), np.sign(step)
        turned = np.flatnonzero(sign[1:] * sign[:-1] <= 0.0)
        corners = np.concatenate([path[:1], path[turned], path[-1:]])
        after = np.searchsorted(corners, path, side="right").clip(1, len(corners) - 1)
        return np.asarray(np.minimum(path - corners[after - 1], np.abs(corners[after] - path)))


def stated_motion(
    parameters: Friction, start: float, speeds: tuple[float, float] | None, unit: str
) -> Motion:
    """One sine within presliding, sines of sliding, and a travel back and forth at one speed.

    The peak speeds of the sines are a geometric series from the lowest to the highest. The travel
    has their geometric mean, slow enough for stick-slip.

    Args:
        start: rad, where the motion begins and ends.
        speeds: lowest and highest peak speed, rad/s; None: 0.1 to 20 Stribeck velocities, or 0.005
            to 1 rad/s if friction does not fall with speed.
        unit: of the position, for the motion's name.
    """
    top = 20.0 * (stribeck_velocity(parameters) or 0.0) or 1.0
    lowest, highest = speeds or (top / 200.0, top)
    peaks = list(np.geomspace(lowest, highest, 5))
    if parameters.stiffness > 0.0:
        # half of the displacement, 2 Fs / K, in which friction reaches its limit
        reach = levels(parameters)["pos"][0] / parameters.stiffness
        peaks.insert(0, np.pi * reach / _PERIOD)
    w = 2.0 * np.pi / _PERIOD
    turns = w * _STEP * np.arange(round(_PERIOD / _STEP))
    velocity = [peak * np.sin(turns) for peak in peaks]
    # 5 s, of which 0.5 s at the beginning and at the end
    edge = np.clip(np.arange(0.0, 5.0, _STEP) / 0.5, 0.0, 1.0)
    one_way = float(np.sqrt(lowest * highest)) * edge * edge[::-1]
    v = np.concatenate([*velocity, one_way, -one_way])
    q: Array = start + _STEP * np.append(0.0, np.cumsum(0.5 * (v[1:] + v[:-1])))
    name = f"sines and travel, peak speeds {lowest:.3g} to {highest:.3g} {unit}/s"
    a: Array = np.gradient(v, _STEP)
    t = _STEP * np.arange(len(q), dtype=np.float64)
    return Motion(name, t, q, v, a)


def log_motions(path: Path, joints: list[str], columns: Mapping[str, str]) -> dict[str, Motion]:
    """The motions of joints in a log, by joint.

    Args:
        joints: those with friction. columns: our column name -> the log's.
    Raises:
        LogError: unreadable, or it is ambiguous which joint the log describes.
    """
    found = {}
    for joint in joints:
        log = read_log(path, joint, columns)
        if len(joints) > 1 and not log.other_positions:
            raise LogError(
                f"{path.name}: {len(joints)} joints have friction, name them in the columns: "
                f"{joint}.position_rad"
            )
        smooth = differentiate(log)
        dt = float(smooth.time[1] - smooth.time[0])
        corner = min(smooth.bandwidth_hz, HIGHEST / dt)
        filtered = LowPass(len(smooth.time), dt, corner, steep)
        others = {
            name: filtered(np.interp(smooth.time, log.time, x))
            for name, x in log.other_positions.items()
        }
        time = smooth.time - smooth.time[0]
        found[joint] = Motion(
            log.name, time, smooth.position, smooth.velocity, smooth.acceleration, others
        )
    return found
