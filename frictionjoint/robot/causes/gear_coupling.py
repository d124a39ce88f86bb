"""A motor that turns with two joints, as in many wrists: its friction and rotor act on both.

Lagrange's equations of a shaft at q_i + c q_j: what it takes acts on joint i as it is and on joint
j times c. The TX40's sixth motor turns with the sum of joints 5 and 6 (Gautier and Janot).
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import POSITIVE, Cause
from frictionjoint.robot.corrections import Corrections, Shaft, tendons_bend


@dataclass(frozen=True)
class GearCoupling(Cause):
    """Numbers: friction level, N m, viscous and concave friction, N m s/rad, and inertia, kg m^2.

    Lubricated gears have concave friction. It is level at the top speed of the logs: beyond that
    they do not tell.

    Attributes:
        joints: names. ratio: of the second joint in the shaft's turn. top: its speed, rad/s.
    """

    joints: tuple[str, str]
    ratio: float
    top: float
    name: ClassVar[str] = "gear-coupling"

    @property
    def place(self) -> dict[str, str]:
        """See `Cause`."""
        return {"joint": self.joints[0], "other_joint": self.joints[1]}

    @property
    def steps(self) -> Array:
        """See `Cause`."""
        return np.ones(4)

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """See `Cause`."""
        # where a tendon's damping is one number a model cannot hold a curve
        return POSITIVE, POSITIVE, POSITIVE if tendons_bend() else (0.0, 0.0), POSITIVE

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """See `Cause`."""
        shaft = Shaft(self.joints, self.ratio, self.top, *(float(number) for number in x))
        return replace(state, shafts=(*state.shafts, shaft))

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """See `Cause`."""
        return {
            "level": (float(x[0]), "N m"),
            "viscous": (float(x[1]), "N m s/rad"),
            "concave": (float(x[2]), "N m s/rad"),
            "inertia": (float(x[3]), "kg m^2"),
            "ratio": (self.ratio, "1"),
            "top": (self.top, "rad/s"),
        }
