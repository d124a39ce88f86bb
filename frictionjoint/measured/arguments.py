"""Types of arguments, checked where a user hands them in."""

from typing import Any

from frictionjoint.errors import ParameterError


def expect(value: Any, kinds: type | tuple[type, ...], name: str, mend: str) -> None:
    """See that an argument is of one of some kinds.

    Raises:
        TypeError: it is not; one line with its name, its type and what to give.
    """
    if not isinstance(value, kinds):
        raise TypeError(f"{name} is of type {type(value).__name__}: {mend}")


def require_seed(seed: Any) -> None:
    """See that a seed is a whole number from 0.

    Raises:
        TypeError, ParameterError: it is not.
    """
    expect(seed, int, "seed", "give a whole number, 0 or more")
    if seed < 0:
        raise ParameterError(f"seed is {seed}: give 0 or more")
