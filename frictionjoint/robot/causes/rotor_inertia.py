"""Inertia of a motor's rotor behind its gear; URDFs lack it, and often data sheets too."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.corrections import Corrections


@dataclass(frozen=True)
class RotorInertia(Cause):
    """Number: what to add to the model's armature, kg m^2 (kg for a slide); the sum is never
    negative."""

    joint: str
    armature: float
    slide: bool = False
    name: ClassVar[str] = "rotor-inertia"
    steps = np.ones(1)

    @property
    def place(self) -> dict[str, str]:
        return {"joint": self.joint}

    def acts_on(self, joint: str) -> bool:
        """Only its own joint accelerates the rotor."""
        return joint == self.joint

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """The sum with the armature of the model is not negative."""
        return ((-self.armature, np.inf),)

    def applied(self, state: Corrections, x: Array) -> Corrections:
        here = state.armature.get(self.joint, 0.0) + float(x[0])
        return replace(state, armature=state.armature | {self.joint: here})

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """The whole armature, and the part that the model lacks."""
        unit = "kg" if self.slide else "kg m^2"
        return {"armature": (self.armature + float(x[0]), unit), "added": (float(x[0]), unit)}
