"""Friction of a joint in a model: a friction law, and effects with their numbers."""

from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.effect import Effect
from frictionjoint.errors import ParameterError
from frictionjoint.parameters import Friction


@dataclass(frozen=True, repr=False)
class SimulatedEffect:
    """An effect with its numbers, as stored in a model.

    Raises:
        ParameterError: not as many numbers as the effect has.
    """

    effect: Effect
    shape: tuple[float, ...]
    coefficients: tuple[float, ...]

    def __post_init__(self) -> None:
        pairs = (("shape", self.effect.shape), ("coefficients", self.effect.coefficients))
        for field, names in pairs:
            given = len(getattr(self, field))
            if given != len(names):
                raise ParameterError(
                    f"effect {self.effect.name}: {given} numbers as {field}, it has {len(names)}: "
                    f"{', '.join(names) or 'none'}"
                )

    @property
    def numbers(self) -> Array:
        """Shape numbers, then coefficients."""
        return np.array([*self.shape, *self.coefficients], dtype=np.float64)

    @property
    def named(self) -> dict[str, float]:
        """`numbers` by their names."""
        names = (*self.effect.shape, *self.effect.coefficients)
        return dict(zip(names, (*self.shape, *self.coefficients), strict=True))

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name}={x:.5g}" for name, x in self.named.items())
        return f"SimulatedEffect({self.effect.name}: {numbers})"

    def pack(self) -> Array:
        """Id, length, numbers."""
        return np.concatenate([[self.effect.effect_id, self.effect.size], self.numbers])


@dataclass(frozen=True)
class JointFriction:
    """Friction of one joint in a model: law and effects."""

    parameters: Friction
    effects: tuple[SimulatedEffect, ...] = ()
