"""Checks of argument types."""

from typing import Any

from frictionjoint.errors import ParameterError


def expect(value: Any, kinds: type | tuple[type, ...], name: str, fix: str) -> None:
    """Require an argument to be of some types; TypeError with its name, its type and the fix."""
    if not isinstance(value, kinds):
        raise TypeError(f"{name} is of type {type(value).__name__}: {fix}")


def require_seed(seed: Any) -> None:
    """Require a seed to be an integer of at least 0; TypeError or ParameterError if it is not."""
    expect(seed, int, "seed", "give a whole number, 0 or more")
    if seed < 0:
        raise ParameterError(f"seed is {seed}: give 0 or more")
