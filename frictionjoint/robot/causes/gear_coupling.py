"""A motor that turns with two joints, as in many wrists: its friction and rotor act on both.

Lagrange's equations of a shaft at q_i + c q_j: its torque acts on joint i, and c times on joint j.
The TX40's sixth motor turns with the sum of joints 5 and 6 (Gautier and Janot).
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import FREE, POSITIVE, Cause
from frictionjoint.robot.corrections import Corrections, Shaft, tendon_polynomial

_UNITS = {"level": "N m", "viscous": "N m s/rad", "concave": "N m s/rad", "inertia": "kg m^2"}


@dataclass(frozen=True)
class GearCoupling(Cause):
    """Numbers: friction level, N m, viscous and concave friction, N m s/rad, and inertia, kg m^2.

    Lubricated gears have concave friction. It is constant above the top speed of the logs, where
    they do not determine it. A level that varies with the motor's angle adds sine and cosine, N m.

    Attributes:
        shaft: without friction and inertia; its level has a wave if `waves` is not 0.
        among: see `Cause`.
    """

    shaft: Shaft
    among: float = 1.0
    name: ClassVar[str] = "gear-coupling"

    @property
    def place(self) -> dict[str, str]:
        return dict(zip(("joint", "other_joint"), self.shaft.joints, strict=True))

    @property
    def steps(self) -> Array:
        """1 of each number: the torque is linear in all of them."""
        return np.ones(len(self.bounds))

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Nonnegative losses and inertia; a wave of any phase."""
        # where a tendon's damping is one number a model cannot hold a curve
        even = POSITIVE, POSITIVE, POSITIVE if tendon_polynomial() else (0.0, 0.0), POSITIVE
        return (*even, FREE, FREE) if self.shaft.waves else even

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """The shaft, as one more tendon."""
        shaft = replace(self.shaft, numbers=(*x.tolist(), 0.0, 0.0)[:6])
        return replace(state, shafts=(*state.shafts, shaft))

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """Losses, inertia and ratio of the shaft, and its wave if it has one."""
        units = zip(_UNITS.items(), x.tolist(), strict=False)
        found = {name: (value, unit) for (name, unit), value in units}
        found |= {"ratio": (self.shaft.ratio, "1"), "top": (self.shaft.top, "rad/s")}
        if self.shaft.waves:
            found["wave"] = float(np.hypot(*x[4:])), "N m"
            found["waves"] = self.shaft.waves, "1/rad"
        return found
