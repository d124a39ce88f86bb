"""What a shared cause offers: the corrections that it makes of its numbers."""

from typing import Protocol

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.corrections import Corrections

FREE = (-np.inf, np.inf)
POSITIVE = (0.0, np.inf)


class Cause(Protocol):
    """A change of the rigid-body model that several joints may show."""

    @property
    def name(self) -> str:
        """Canonical name."""
        ...

    @property
    def place(self) -> dict[str, str]:
        """Where it acts: a body, or one or two joints, by key of the report."""
        ...

    @property
    def start(self) -> Array:
        """Numbers at which it changes nothing, shape (k,)."""
        ...

    @property
    def steps(self) -> Array:
        """Steps of a central difference by each number, shape (k,)."""
        ...

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Range of each number."""
        ...

    @property
    def prior(self) -> Array:
        """Standard deviation of each number around the model's own figures, shape (k,); inf where
        nothing is presumed.
        """
        ...

    @property
    def homogeneous(self) -> bool:
        """Whether twice the numbers are twice the torque, though it is not linear in them."""
        ...

    @property
    def essential(self) -> int:
        """How many of its first numbers must be within their bounds for it to be at all."""
        ...

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """A model's state with the cause in it."""
        ...

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """What it amounts to in a state without it: values and units by name."""
        ...


def composed(
    causes: tuple[Cause, ...], numbers: tuple[Array, ...], state: Corrections
) -> Corrections:
    """A state with all causes in it, in turn."""
    for cause, x in zip(causes, numbers, strict=True):
        state = cause.applied(state, x)
    return state
