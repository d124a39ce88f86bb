"""The interface of a shared cause: from its numbers to corrections of the model."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
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
        homogeneous: whether its torque is proportional to its numbers, though not linear in them.
        essential: how many of its first numbers must be within their bounds for it to exist.
        among: number of spectral lines of which it is the strongest.
    """

    name: ClassVar[str]
    homogeneous: ClassVar[bool] = False
    essential: ClassVar[int] = 0
    among: float = 1.0

    @property
    @abstractmethod
    def place(self) -> dict[str, str]:
        """Place where the cause acts: a body, or one or two joints, by key of the report."""

    @property
    def label(self) -> str:
        place = ", ".join(self.place.values())
        return f"{self.name} of {place}" if place else self.name

    @property
    def changed(self) -> str:
        """Key of the change, of which a model contains one: a body's inertia, or its own place."""
        body = self.place.get("body")
        return f"inertia of {body}" if body else self.label

    def acts_on(self, joint: str) -> bool:
        """Whether it may change a joint's torque."""
        return True

    @property
    @abstractmethod
    def steps(self) -> Array:
        """Steps of a central difference for each number, shape (k,)."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Range of each number."""

    @property
    def start(self) -> Array:
        """Parameter values with which the cause has no effect, shape (k,)."""
        return np.zeros(len(self.bounds))

    @property
    def prior(self) -> Array:
        """Standard deviation of each number around the model's value, shape (k,); inf without a
        prior."""
        return np.full(len(self.bounds), np.inf)

    def rays(self, x: Array) -> list[Array]:
        """For a homogeneous cause: directions to search along, from its first-order numbers."""
        return [x]

    def parts(self, x: Array) -> list[tuple["Cause", Array]]:
        """The causes of which it consists, each of one body or joint, with their numbers."""
        return [(self, x)]

    @abstractmethod
    def applied(self, state: Corrections, x: Array) -> Corrections:
        """Corrections with this cause added."""

    @abstractmethod
    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """Values and units of the cause by name, relative to corrections without it."""


def composed(causes: Sequence[Cause], numbers: Sequence[Array], state: Corrections) -> Corrections:
    """Corrections with all causes added in order."""
    for cause, x in zip(causes, numbers, strict=True):
        state = cause.applied(state, x)
    return state
