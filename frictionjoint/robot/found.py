"""Shared causes in a model."""

from dataclasses import dataclass, field, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import Cause, composed
from frictionjoint.robot.corrections import Corrections


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
