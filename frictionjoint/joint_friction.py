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

    def __repr__(self) -> str:
        names = (*self.effect.shape, *self.effect.coefficients)
        values = zip(names, (*self.shape, *self.coefficients), strict=True)
        return (
            f"SimulatedEffect({self.effect.name}: {', '.join(f'{n}={x:.5g}' for n, x in values)})"
        )

    def pack(self) -> Array:
        """Id, length, numbers."""
        return np.concatenate([[self.effect.effect_id, self.effect.size], self.numbers])


@dataclass(frozen=True)
class JointFriction:
    """Friction of one joint in a model: law and effects."""

    parameters: Friction
    effects: tuple[SimulatedEffect, ...] = ()
