"""Logs of a Dynamixel XL330 swinging a pendulum, as recorded for BAM (Duclusaud et al. 2024)."""

import json
from pathlib import Path

import numpy as np

from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import check_columns

_FULL_DUTY = 885.0


def read_xl330(path: Path) -> JointLog:
    """Read one JSON log; the drive is the voltage at the motor, duty times supply.

    Raises:
        LogError: not such a file.
    """
    try:
        content = json.loads(path.read_text())
        entries = content["entries"]
        load = np.array([e["load"] for e in entries], dtype=np.float64)
        supply = np.array([e["input_volts"] for e in entries], dtype=np.float64)
        columns = {
            "time_s": np.array([e["timestamp"] for e in entries], dtype=np.float64),
            "position_rad": np.array([e["position"] for e in entries], dtype=np.float64),
            "temperature_c": np.array([e["temp"] for e in entries], dtype=np.float64),
            "target_rad": np.array([e["goal_position"] for e in entries], dtype=np.float64),
        }
        enabled = np.array([bool(e["torque_enable"]) for e in entries])
        metadata = {k: float(content[k]) for k in ("mass", "length", "kp", "vin")}
    except (KeyError, TypeError, ValueError) as error:
        raise LogError(f"{path.name}: not an XL330 log: {type(error).__name__} {error}") from None
    # a signed value in an unsigned 16-bit register
    duty = np.where(load > 32767, load - 65536, load) / _FULL_DUTY
    columns["voltage_v"] = np.where(enabled, duty * supply, 0.0)
    check_columns(path.name, columns, 1)
    return JointLog(
        name=path.stem,
        joint="joint",
        time=columns["time_s"] - columns["time_s"][0],
        position=columns["position_rad"],
        voltage=columns["voltage_v"],
        temperature=columns["temperature_c"],
        target=columns["target_rad"],
        torque_enabled=enabled,
        metadata=metadata,
    )
