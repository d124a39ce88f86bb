"""Units of a log's columns other than SI, converted if the user names them.

`--unit position=deg` states the unit in the file, `--unit torque=-0.05` a factor to SI. Nothing is
converted unless requested. A quantity is ``time``, ``position``, ``velocity``, ``torque``,
``force``, ``target``, ``voltage``, ``current``, ``supply``, ``temperature`` or ``motor_position``;
``elbow.position`` is that of one joint. A target has the unit of the position unless its own is
given.
"""

import math
import re
from collections.abc import Mapping

from scipy.constants import g, inch, lbf

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError

_TURN = 2.0 * math.pi
_COUNTS = "counts"
# factor to SI, by the quantity and the spelling of the unit in lower case without blanks
TIME = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "millisec": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
TIME |= {"min": 60.0}
_ANGLE = {"rad": 1.0, "mrad": 1e-3, "deg": _TURN / 360.0, "rev": _TURN, "turn": _TURN}
_LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "in": inch}
_TURNING = {"rad/s": 1.0, "mrad/s": 1e-3, "deg/s": _TURN / 360.0, "rpm": _TURN / 60.0}
_TURNING |= {"rev/s": _TURN, "rps": _TURN, "hz": _TURN, "dps": _TURN / 360.0}
_TRAVELLING = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3, "um/s": 1e-6}
_TORQUE = {"nm": 1.0, "mnm": 1e-3, "ncm": 1e-2, "knm": 1e3}
_TORQUE |= {"kgfcm": g * 1e-2, "kgcm": g * 1e-2, "kgfm": g}
_TORQUE |= {"ozin": lbf / 16.0 * inch, "lbin": lbf * inch, "lbft": lbf * inch * 12.0}
_FORCE = {"n": 1.0, "mn": 1e-3, "kn": 1e3, "kgf": g, "lbf": lbf}
_VOLTAGE, _CURRENT = {"v": 1.0, "mv": 1e-3}, {"a": 1.0, "ma": 1e-3}
_TEMPERATURE = {"c": 1.0, "degc": 1.0, "k": 1.0, "f": 5.0 / 9.0, "degf": 5.0 / 9.0}
_ZERO = {"k": 273.15, "f": 32.0, "degf": 32.0}
# our column -> the quantity that --unit names, the one that it inherits from, and its units
_COLUMNS: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    "time_s": (("time",), TIME),
    "position_rad": (("position",), _ANGLE),
    "target_rad": (("target", "position"), _ANGLE),
    "motor_position_rad": (("motor_position",), _ANGLE),
    "velocity_rad_s": (("velocity",), _TURNING),
    "torque_nm": (("torque",), _TORQUE),
    "position_m": (("position",), _LENGTH),
    "target_m": (("target", "position"), _LENGTH),
    "velocity_m_s": (("velocity",), _TRAVELLING),
    "force_n": (("force",), _FORCE),
    "voltage_v": (("voltage",), _VOLTAGE),
    "supply_v": (("supply", "voltage"), _VOLTAGE),
    "current_a": (("current",), _CURRENT),
    "temperature_c": (("temperature",), _TEMPERATURE),
}
_QUANTITIES = sorted({names[0] for names, _ in _COLUMNS.values()})


def check_units(units: Mapping[str, str]) -> None:
    """Check that quantities and units are known; LogError for the first one that is not."""
    for quantity, unit in units.items():
        last = quantity.rpartition(".")[2]
        tables = [table for names, table in _COLUMNS.values() if names[0] == last]
        if not tables:
            fix = f"give one of {', '.join(_QUANTITIES)}"
            raise LogError(f"--unit {quantity}={unit}: {last!r} is no quantity: {fix}")
        known = [name for table in tables for name in table]
        if all(_factor(unit, table) is None for table in tables):
            turns = ["counts:PER_TURN"] if "rad" in known else []
            fix = f"give one of {', '.join(known + turns)}, or the factor to SI, a number"
            raise LogError(f"--unit {quantity}={unit}: {unit!r} is not known: {fix}")


def converted(source: str, name: str, x: Array, units: Mapping[str, str]) -> Array:
    """A column in SI units, shape (n,), by our name; LogError: not a unit of this quantity."""
    unit = unit_of(name, units)
    if unit is None:
        return x
    table = _COLUMNS[name.rpartition(".")[2]][1]
    factor = _factor(unit, table)
    if factor is None:
        fix = f"give --unit one of {', '.join(table)}"
        raise LogError(f"{source}, {name}: it cannot be in {unit!r}: {fix}")
    return factor * (x - _ZERO.get(_plain(unit), 0.0)) if table is _TEMPERATURE else factor * x


def unit_of(name: str, units: Mapping[str, str]) -> str | None:
    """The unit given for one of our columns, or None."""
    joint, _, last = name.rpartition(".")
    for quantity in _COLUMNS.get(last, ((), {}))[0]:
        unit = units.get(f"{joint}.{quantity}", units.get(quantity))
        if unit is not None:
            return unit
    return None


def quantity_of(name: str) -> str:
    """Name of a column's quantity in the option --unit."""
    return _COLUMNS[name.rpartition(".")[2]][0][0]


def is_unit(text: str) -> bool:
    """Whether a cell of a table can be a unit, with or without brackets; empty counts."""
    return _plain(text) in {"", "-", "1", "%", *_SPELLINGS}


def is_si(name: str, text: str) -> bool:
    """Whether a cell names the SI unit of one of our columns, or none."""
    plain = _plain(text)
    names, table = _COLUMNS.get(name.rpartition(".")[2], ((), {}))
    return not names or plain == "" or (table.get(plain) == 1.0 and plain not in _ZERO)


def is_foreign(name: str, text: str) -> bool:
    """Whether a text names a unit of one of our columns that is not its SI unit."""
    return _COLUMNS[name][1].get(_plain(text), 1.0) != 1.0


_SPELLINGS = frozenset(unit for _, table in _COLUMNS.values() for unit in (*table, _COUNTS))


def _plain(unit: str) -> str:
    """A unit in the spelling of the tables."""
    text = unit.strip().strip("[]()").lower()
    for mark in (" ", "*", "·", "⋅", ".", "-", "_", "°"):
        text = text.replace(mark, "deg" if mark == "°" else "")
    text = text.replace("degrees", "deg").replace("degree", "deg").replace("radians", "rad")
    return text.replace("/sec", "/s").replace("seconds", "s")


def _factor(unit: str, table: Mapping[str, float]) -> float | None:
    """Factor to SI, None for an unknown unit."""
    kind, colon, number = unit.partition(":")
    if _plain(kind) == _COUNTS and table is _ANGLE:
        try:
            counts = float(number) if colon else math.nan
        except ValueError:
            counts = math.nan
        if not (math.isfinite(counts) and counts > 0.0):
            raise LogError(f"unit {unit}: write counts:PER_TURN, e.g. counts:4096")
        return _TURN / counts
    if re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", unit, re.I) and float(unit) != 0.0:
        return float(unit)
    return table.get(_plain(unit))
