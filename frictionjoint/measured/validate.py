"""Checks that a log can be trusted; each error is one line with file, row, column and mend."""

import numpy as np
from numpy.typing import NDArray

from frictionjoint.errors import LogError

Array = NDArray[np.float64]

FEWEST_ROWS = 50
LARGEST_GAP = 10.0  # in median sampling intervals
# Beyond these a unit is wrong rather than a joint extreme: 100 turns, 20 m, a day, 1e6 N m.
_LARGEST = {
    "position_rad": (2 * np.pi * 100, "radians (degrees?)"),
    "target_rad": (2 * np.pi * 100, "radians (degrees?)"),
    "position_m": (20.0, "metres (millimetres?)"),
    "target_m": (20.0, "metres (millimetres?)"),
    "torque_nm": (1e6, "newton metres (newton millimetres?)"),
    "force_n": (1e7, "newtons"),
    "voltage_v": (1e4, "volts (millivolts?)"),
    "temperature_c": (400.0, "degrees Celsius"),
}


def check_columns(source: str, columns: dict[str, Array], first_row: int) -> None:
    """Raise LogError where the columns of a log cannot be right.

    Args:
        source: file name for the message.
        columns: by column name; needs ``time_s``.
        first_row: row number of the first sample in the file, as an editor counts it.
    """
    time = columns["time_s"]
    if len(time) < FEWEST_ROWS:
        raise LogError(f"{source}: {len(time)} samples, at least {FEWEST_ROWS} are needed")
    for name, x in columns.items():
        bad = np.flatnonzero(~np.isfinite(x))
        if bad.size:
            row = bad[0] + first_row
            raise LogError(f"{source}, row {row}, {name}: {x[bad[0]]}, remove or repair that row")
    _check_time(source, time, first_row)
    for name, x in columns.items():
        unit = name.rpartition(".")[2]
        if unit in _LARGEST and np.abs(x).max() > _LARGEST[unit][0]:
            row = int(np.argmax(np.abs(x)))
            raise LogError(
                f"{source}, row {row + first_row}, {name}: {x[row]:g} is beyond any joint, give "
                f"{_LARGEST[unit][1]}"
            )
        _check_degrees(source, name, x, columns)


def _check_time(source: str, time: Array, first_row: int) -> None:
    step = np.diff(time)
    bad = np.flatnonzero(step <= 0)
    if bad.size:
        row = bad[0] + 1
        raise LogError(
            f"{source}, row {row + first_row}, time_s: {time[row]:g} after {time[row - 1]:g}, "
            "time must increase: sort the rows or remove repeats"
        )
    median = float(np.median(step))
    if median >= 0.5:
        raise LogError(
            f"{source}, time_s: {median:g} s between samples, too slow for friction: "
            "give seconds (milliseconds?)"
        )
    bad = np.flatnonzero(step > LARGEST_GAP * median)
    if bad.size:
        row = bad[0] + 1
        raise LogError(
            f"{source}, row {row + first_row}, time_s: a gap of {step[row - 1]:g} s where "
            f"samples are {median:g} s apart: split the log there"
        )


def _check_degrees(source: str, name: str, x: Array, columns: dict[str, Array]) -> None:
    """A position in degrees shows by its measured velocity in rad/s, where there is one."""
    prefix, dot, unit = name.rpartition(".")
    speed_name = (
        prefix
        + dot
        + {"position_rad": "velocity_rad_s", "position_m": "velocity_m_s"}.get(unit, "")
    )
    if unit not in ("position_rad", "position_m") or speed_name not in columns:
        return
    speed = columns[speed_name]
    slope = np.gradient(x, columns["time_s"])
    power = float(speed @ speed)
    if power == 0.0:
        return
    ratio = float(slope @ speed) / power
    if abs(ratio) > 1e-3 and not 0.5 < ratio < 2.0:
        raise LogError(
            f"{source}: {name} changes {ratio:.3g} times as fast as {speed_name} says: "
            "check the units and signs of the two"
        )


def check_moves(source: str, name: str, position: Array) -> None:
    """Raise LogError for a joint that does not move."""
    if np.ptp(position) == 0.0:
        raise LogError(f"{source}, {name}: constant at {position[0]:g}, the joint does not move")
