"""Recordings of ``mujoco.sysid``: the .npz that its `SystemTrajectory` and `TimeSeries` save.

Each series of a recording has its own times: sensors, controls, states. All are read at the times
of the sensors (or of the states, if there are no sensors); a control holds until the next one, as
in a simulation. A signal with one number is a column of its name, with several a matrix. The
positions and velocities of the state, ``elbow_qpos`` and ``elbow_qvel``, become
``elbow.position_rad`` and ``elbow.velocity_rad_s``. The file does not say what a control or a
sensor means.
"""

import json
from collections.abc import Mapping

import numpy as np

from frictionjoint.arrays import Array

# prefixes of the names of arrays
_CONTROL = "control_"
_SERIES = ("sensordata_", "state_", _CONTROL)
_STATE = {"_qpos": ".position_rad", "_qvel": ".velocity_rad_s"}
# numbers that its mapping gives to positions and velocities of the state
_KINDS = {2: "_qpos", 3: "_qvel"}


def signals(archive: Mapping[str, Array]) -> dict[str, Array] | None:
    """Each signal and ``time_s`` at common times, shape (n,) or (n, k); None: no such recording."""
    # a single series is saved without a prefix
    alone = "times" in archive and "data" in archive
    series = {
        name: (archive[f"{name}times"], archive[f"{name}data"], _names(archive, name))
        for name in ([""] if alone else _SERIES)
        if f"{name}times" in archive and f"{name}data" in archive
    }
    if not any(names for _, _, names in series.values()):
        return None
    time = np.asarray(next(iter(series.values()))[0], dtype=np.float64)
    if _CONTROL in series:  # what is asked for before the first control is unknown
        time = time[time >= series[_CONTROL][0][0]]
    found = {"time_s": time}
    for name, (given, data, names) in series.items():
        at = np.clip(np.searchsorted(given, time, side="right") - 1, 0, len(given) - 1)
        for signal, columns in names.items():
            x = np.asarray(data, dtype=np.float64)[:, columns]
            parts = [part[at] if name == _CONTROL else np.interp(time, given, part) for part in x.T]
            found[signal] = np.stack(parts, axis=1) if len(parts) > 1 else parts[0]
    return found


def _names(archive: Mapping[str, Array], series: str) -> dict[str, list[int]]:
    mapping = f"{series}signal_mapping"
    if mapping not in archive:
        return {}
    found = {}
    for name, (kind, columns) in json.loads(str(archive[mapping])).items():
        suffix = _KINDS.get(kind, "")
        of_joint = suffix and len(columns) == 1
        ours = name.removesuffix(suffix) + _STATE[suffix] if of_joint else name
        found[ours] = columns
    return found
