"""Causes with one number that a joint's own one in the model lacks."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import FREE, Cause
from frictionjoint.robot.corrections import Corrections


@dataclass(frozen=True)
class OfJoint(Cause):
    """Number: what to add to `quantity`, a field of `Corrections`, of a joint."""

    joint: str
    slide: bool = False
    quantity: ClassVar[str]

    @property
    def place(self) -> dict[str, str]:
        return {"joint": self.joint}

    def applied(self, state: Corrections, x: Array) -> Corrections:
        known = getattr(state, self.quantity)
        more = {self.joint: known.get(self.joint, 0.0) + float(x[0])}
        return replace(state, **{self.quantity: known | more})


@dataclass(frozen=True)
class RotorInertia(OfJoint):
    """Inertia of a motor's rotor behind its gear; URDFs lack it, and often data sheets too. Number:
    what to add to the model's `armature`, kg m^2 (kg for a slide); the sum is never negative."""

    armature: float = 0.0
    name: ClassVar[str] = "rotor-inertia"
    quantity: ClassVar[str] = "armature"
    steps = np.ones(1)

    def acts_on(self, joint: str) -> bool:
        """Only its own joint accelerates the rotor."""
        return joint == self.joint

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """The sum with the armature of the model is not negative."""
        return ((-self.armature, np.inf),)

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """The whole armature, and the part that the model lacks."""
        unit = "kg" if self.slide else "kg m^2"
        return {"armature": (self.armature + float(x[0]), unit), "added": (float(x[0]), unit)}


class JointOffset(OfJoint):
    """A wrong encoder zero. Number: what to add to the measured position, rad (m for a slide)."""

    name: ClassVar[str] = "joint-offset"
    quantity: ClassVar[str] = "offset"
    steps = np.full(1, 1e-3)
    bounds = (FREE,)

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        return {"offset": (float(x[0]), "m" if self.slide else "rad")}
