"""Logs of a Dynamixel XL330 swinging a pendulum, as recorded for BAM (Duclusaud et al. 2024).

JSON: ``mass`` kg, ``length`` m, ``kp`` firmware gain, ``vin`` V, and ``entries`` with ``timestamp``
s, ``position`` rad, ``speed`` rad/s, ``load`` (signed duty in an unsigned 16-bit register, 885 =
full), ``input_volts`` V, ``temp`` deg C, ``goal_position`` rad, ``torque_enable``.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of

FULL_DUTY = 885.0
_SIGNED, _REGISTER = 1 << 15, 1 << 16
_ENTRY = {
    "time_s": "timestamp",
    "position_rad": "position",
    "velocity_rad_s": "speed",
    "temperature_c": "temp",
    "target_rad": "goal_position",
}


def read_xl330(path: Path) -> JointLog:
    """Read one JSON log; the drive is the voltage at the motor, duty times supply.

    Rows in messages are entries, counted from 1.

    Raises:
        LogError: not such a file, or see `validate`.
    """
    content = _content(path)
    entries = content["entries"]
    columns = {ours: _column(path, entries, theirs) for ours, theirs in _ENTRY.items()}
    load = _column(path, entries, "load")
    duty = np.where(load >= _SIGNED, load - _REGISTER, load) / FULL_DUTY
    enabled = _column(path, entries, "torque_enable") > 0.5
    # the arm let go: the motor's leads are open, no voltage is applied
    columns["voltage_v"] = np.where(enabled, duty * _column(path, entries, "input_volts"), 0.0)
    columns["torque_enabled"] = enabled.astype(np.float64)
    metadata = {key: _number(path, content, key) for key in ("mass", "length", "kp", "vin")}
    return replace(log_of(path, "joint", columns), metadata=metadata)


def _content(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise LogError(f"{path.name}: cannot be read as JSON: {one_line(error)}") from None
    entries = content.get("entries") if isinstance(content, dict) else None
    if not isinstance(entries, list) or not entries:
        raise LogError(f"{path.name}: not an XL330 log: it has no list of entries")
    found: dict[str, Any] = content
    return found


def _column(path: Path, entries: list[Any], key: str) -> Array:
    out = np.empty(len(entries))
    for i, entry in enumerate(entries):
        value = entry.get(key) if isinstance(entry, dict) else None
        if not isinstance(value, int | float):
            raise LogError(f"{path.name}, row {i + 1}, {key}: {str(value)[:40]!r} is not a number")
        try:
            out[i] = value
        except OverflowError:
            raise LogError(f"{path.name}, row {i + 1}, {key}: too large a number") from None
        if not np.isfinite(out[i]):
            raise LogError(f"{path.name}, row {i + 1}, {key}: {value}, give a finite number")
    return out


def _number(path: Path, content: dict[str, Any], key: str) -> float:
    value = content.get(key)
    if not isinstance(value, int | float) or not abs(value) < 1e9:
        raise LogError(f"{path.name}, {key}: {str(value)[:40]!r} is not a number of use")
    return float(value)
