"""Shared causes: from the numbers of one, or of those in a model, to corrections of the model."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
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
    def place(self) -> dict[str, str]:
        """Bodies or joints where the cause acts, by key of the report; none: the whole robot."""
        return {}

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
        """Standard deviation of each number around the model's value, shape (k,); inf: no prior."""
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


@dataclass(frozen=True)
class Found:
    """Shared causes in a model, with their numbers; `original` is the model without them."""

    original: Corrections = field(repr=False)
    causes: tuple[Cause, ...] = ()
    numbers: tuple[Array, ...] = ()

    @property
    def state(self) -> Corrections:
        """Corrections with all causes."""
        return composed(self.causes, self.numbers, self.original)

    @property
    def deviation(self) -> float:
        """Squared numbers over their prior variances."""
        return sum(
            float(np.sum((x / c.prior) ** 2))
            for c, x in zip(self.causes, self.numbers, strict=True)
        )

    def without(self, *out: int) -> "Found":
        """All but some, by index."""
        kept = [i for i in range(len(self.causes)) if i not in out]
        causes, numbers = self.causes, self.numbers
        return replace(
            self, causes=tuple(causes[i] for i in kept), numbers=tuple(numbers[i] for i in kept)
        )

    def with_cause(self, cause: Cause, x: Array) -> "Found":
        """The causes with one more."""
        return Found(self.original, (*self.causes, cause), (*self.numbers, x))

    def pairs(self, i: int) -> list[tuple[Corrections, Corrections, float]]:
        """Corrections below and above each number of a cause."""
        found, before, x = [], self.numbers[:i], self.numbers[i]
        for way in np.diag(self.causes[i].steps):
            low, high = (
                replace(self, numbers=(*before, end, *self.numbers[i + 1 :])).state
                for end in (x - way, x + way)
            )
            found.append((low, high, 2.0 * float(way.sum())))
        return found
