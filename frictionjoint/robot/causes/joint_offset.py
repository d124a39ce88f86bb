"""An encoder with a zero that differs from the model's."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import FREE, Cause
from frictionjoint.robot.corrections import Corrections


@dataclass(frozen=True)
class JointOffset(Cause):
    """Number: what to add to the measured position, rad (m for a slide)."""

    joint: str
    slide: bool = False
    name: ClassVar[str] = "joint-offset"
    steps = np.full(1, 1e-3)
    bounds = (FREE,)

    @property
    def place(self) -> dict[str, str]:
        return {"joint": self.joint}

    def applied(self, state: Corrections, x: Array) -> Corrections:
        here = state.offset.get(self.joint, 0.0) + float(x[0])
        return replace(state, offset=state.offset | {self.joint: here})

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        return {"offset": (float(x[0]), "m" if self.slide else "rad")}
