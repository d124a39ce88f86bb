"""A motor that turns with two joints, as in many wrists: its friction and rotor act on both.

Lagrange's equations of a shaft at q_i + c q_j: what it takes acts on joint i as it is and on joint
j times c. The TX40's sixth motor turns with the sum of joints 5 and 6 (Gautier and Janot).
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import POSITIVE, Cause
from frictionjoint.robot.corrections import Corrections, Shaft


@dataclass(frozen=True)
class GearCoupling(Cause):
    """Numbers: friction level, N m, viscous friction, N m s/rad, and inertia, kg m^2, of the shaft.

    Attributes:
        joints: names. ratio: of the second joint in the shaft's turn.
    """

    joints: tuple[str, str]
    ratio: float
    name: ClassVar[str] = "gear-coupling"

    @property
    def place(self) -> dict[str, str]:
        """See `Cause`."""
        return {"joint": self.joints[0], "other_joint": self.joints[1]}

    @property
    def steps(self) -> Array:
        """See `Cause`."""
        return np.ones(3)

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """See `Cause`."""
        return (POSITIVE,) * 3

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """See `Cause`."""
        shaft = Shaft(self.joints, self.ratio, *(float(number) for number in x))
        return replace(state, shafts=(*state.shafts, shaft))

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """See `Cause`."""
        return {
            "level": (float(x[0]), "N m"),
            "viscous": (float(x[1]), "N m s/rad"),
            "inertia": (float(x[2]), "kg m^2"),
            "ratio": (self.ratio, "1"),
        }
