"""Logs of a servo with a pendulum, as recorded for BAM (Duclusaud et al. 2024) and by K-Scale.

JSON: numbers of the log (``mass`` kg, ``length`` m, ``kp`` in the firmware's unit, ``vin`` V), the
name of its motion, ``trajectory``, and ``entries`` with ``timestamp`` s, ``position`` rad,
``speed`` rad/s, ``input_volts`` V, ``temp`` deg C, ``goal_position`` rad, ``torque_enable``; of a
Dynamixel XL330 also ``load``, the signed duty in an unsigned 16-bit register, 885 = full. For
other servos the duty is computed from the controller.
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

_ENTRY = {"time_s": "timestamp", "position_rad": "position", "target_rad": "goal_position"}
_MAY_LACK = {"velocity_rad_s": "speed", "temperature_c": "temp", "supply_v": "input_volts"}
# motors whose load register contains the duty; their first logs name no motor
_DUTY_IN_LOAD = (None, "xl330")


def read_bam_json(path: Path, joint: str | None) -> JointLog:
    """Read one JSON log; if the duty is recorded, the drive is the motor voltage. Rows in messages
    are entries, counted from 1. LogError for another file, and see `validate`."""
    content = _content(path)
    entries = content["entries"]
    there = entries[0] if isinstance(entries[0], dict) else {}
    wanted = _ENTRY | {ours: theirs for ours, theirs in _MAY_LACK.items() if theirs in there}
    columns = {ours: _column(path, entries, theirs) for ours, theirs in wanted.items()}
    enabled = _column(path, entries, "torque_enable") > 0.5
    columns["torque_enabled"] = enabled.astype(np.float64)
    if content.get("motor") in _DUTY_IN_LOAD and "load" in there:
        load = _column(path, entries, "load")
        duty = np.where(load >= 2**15, load - 2**16, load) / 885.0
        # motor switched off: its leads are open, no voltage is applied
        columns["voltage_v"] = np.where(enabled, duty * _column(path, entries, "input_volts"), 0.0)
    numbers = {k: x for k, x in content.items() if type(x) in (int, float)}
    figures = {key: _figure(path, key, x) for key, x in numbers.items()}
    motion = content.get("trajectory")
    return replace(
        log_of(path, joint or "joint", columns),
        metadata=figures,
        motion=motion if isinstance(motion, str) else "",
    )


def _content(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise LogError(f"{path.name}: cannot be read as JSON: {one_line(error)}") from None
    entries = content.get("entries") if isinstance(content, dict) else None
    if not isinstance(entries, list) or not entries:
        raise LogError(f"{path.name}: not a log of BAM or K-Scale: it has no list of entries")
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


def _figure(path: Path, key: str, value: float) -> float:
    if not abs(value) < 1e9:
        raise LogError(f"{path.name}, {key}: {str(value)[:40]!r} is not a number below 1e9")
    return float(value)
