"""Checks of the numbers that a user gives for a law: names, kinds, ranges."""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any, get_args

import numpy as np

from frictionjoint.errors import ParameterError
from frictionjoint.parameter_meanings import meaning

SIDES = ("pos", "neg")
# numbers that a law has for each direction; a file may give one for both
LEVELS = ("Fs", "Fc", "Vs", "delta", "sigma2")
LEVEL_FIELDS = tuple(f"{name}_{side}" for side in SIDES for name in LEVELS)


def both_directions(given: Mapping[str, Any]) -> dict[str, Any]:
    """Fields by name, where `Fs` in place of `Fs_pos` and `Fs_neg` is both.

    Raises:
        ParameterError: one number is given twice.
    """
    found: dict[str, Any] = {}
    for key, x in given.items():
        names = [f"{key}_{side}" for side in SIDES] if key in LEVELS else [key]
        for name in names:
            if name in found or (name != key and name in given):
                raise ParameterError(f"{key} and {name} are given: give one of them")
            found[name] = x
    return found


def require_table(values: Any) -> None:
    """Raise TypeError unless these are values by name."""
    if not isinstance(values, Mapping):
        raise TypeError(
            f"parameters are made of a dict of values by name, not of {type(values).__name__}: a "
            "file is read by frictionjoint.files.read_parameters(path)"
        )


def check_keys(cls: type, given: Mapping[str, Any]) -> None:
    """Raise ParameterError where `given` has an unknown key or lacks a required one."""
    fields = {f.name: f for f in dataclasses.fields(cls)}
    unknown = sorted(set(given) - set(fields))
    if unknown:
        raise ParameterError(f"unknown parameter {unknown[0]!r}: known are {', '.join(fields)}")
    missing = [
        name for name, f in fields.items() if f.default is dataclasses.MISSING and name not in given
    ]
    if missing:
        named = [f"{name} ({meaning(name)})" for name in missing]
        raise ParameterError(f"missing parameter {', '.join(named)}: add it")


def check_number(name: str, value: Any) -> float:
    """`value` as a finite float, or ParameterError naming it."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise ParameterError(f"{name} is {value!r}: give a number")
    try:
        number = float(value)
    except OverflowError:  # an integer of hundreds of digits
        number = math.inf
    if not math.isfinite(number):
        raise ParameterError(f"{name} is {number}: give a finite number")
    return number


def require(holds: bool, name: str, value: Any, allowed: str) -> None:
    """Raise ParameterError, naming the value and what is allowed, unless `holds`."""
    if not holds:
        shown = f"{value:g}" if isinstance(value, float) else repr(value)
        raise ParameterError(f"{name} is {shown}: it must be {allowed}")


def one_of(literal: Any) -> str:
    """The choices of a literal as text."""
    return "one of " + ", ".join(repr(choice) for choice in get_args(literal))


def number_pairs(name: str, values: Any, what: str, most: int) -> tuple[tuple[float, float], ...]:
    """1 to `most` pairs of finite numbers, or ParameterError: `name` must be pairs `what`."""
    try:
        pairs = tuple((check_number(name, a), check_number(name, b)) for a, b in values)
    except ParameterError:
        raise
    except (TypeError, ValueError):
        raise ParameterError(f"{name} must be pairs {what}") from None
    require(1 <= len(pairs) <= most, f"number of {name}", len(pairs), f"1 to {most}")
    return pairs
