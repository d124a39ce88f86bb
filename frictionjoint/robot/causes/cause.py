"""What a shared cause offers: the corrections that it makes of its numbers."""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.corrections import Corrections

FREE = (-np.inf, np.inf)
POSITIVE = (0.0, np.inf)


class Cause(ABC):
    """A change of the rigid-body model that several joints may show.

    Attributes:
        name: canonical name.
        homogeneous: whether twice the numbers are twice the torque, though it is not linear in
            them.
        essential: how many of its first numbers must be within their bounds for it to be at all.
        among: how many lines of a spectrum it is the strongest of.
    """

    name: ClassVar[str]
    homogeneous: ClassVar[bool] = False
    essential: ClassVar[int] = 0
    among: float = 1.0

    @property
    @abstractmethod
    def place(self) -> dict[str, str]:
        """Where it acts: a body, or one or two joints, by key of the report."""

    @property
    def label(self) -> str:
        """What it is and where."""
        place = ", ".join(self.place.values())
        return f"{self.name} of {place}" if place else self.name

    @property
    def changed(self) -> str:
        """What it changes, of which a model has one change: a body's inertia, or its own place."""
        body = self.place.get("body")
        return f"inertia of {body}" if body else self.label

    def acts_on(self, joint: str) -> bool:
        """Whether a joint's torque may change by it."""
        return True

    @property
    @abstractmethod
    def steps(self) -> Array:
        """Steps of a central difference by each number, shape (k,)."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Range of each number."""

    @property
    def start(self) -> Array:
        """Numbers at which it changes nothing, shape (k,)."""
        return np.zeros(len(self.bounds))

    @property
    def prior(self) -> Array:
        """Standard deviation of each number around the model's own figures, shape (k,); inf where
        nothing is presumed.
        """
        return np.full(len(self.bounds), np.inf)

    def rays(self, x: Array) -> list[Array]:
        """Of a homogeneous cause: where to look for it, by numbers to first order in them."""
        return [x]

    @abstractmethod
    def applied(self, state: Corrections, x: Array) -> Corrections:
        """A model's state with the cause in it."""

    @abstractmethod
    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """What it amounts to in a state without it: values and units by name."""


def composed(
    causes: tuple[Cause, ...], numbers: tuple[Array, ...], state: Corrections
) -> Corrections:
    """A state with all causes in it, in turn."""
    for cause, x in zip(causes, numbers, strict=True):
        state = cause.applied(state, x)
    return state
