"""A mass at the hand that is not in the model.

It is assumed to be a ball: its second moment about its centre is equal in all directions.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import FREE, POSITIVE, Cause
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.inertia import TEN, of_body

# kg: below it there is no payload, and its centre is nowhere; only slopes are taken there
_NONE = 1e-6
_LEAST = 10.0 * _NONE
# m: distances of its centre from the body's frame where it is looked for
_REACHES = (0.01, 0.03, 0.1, 0.3, 1.0)


@dataclass(frozen=True)
class Payload(Cause):
    """Numbers: mass, kg; mass times centre in the frame of the body, kg m; and its second moment
    about the centre along each axis, kg m^2.

    Attributes:
        body: that carries it, by number and name.
        heaviest: mass that it may have, kg.
    """

    body: int
    body_name: str
    heaviest: float
    name: ClassVar[str] = "payload"
    homogeneous: ClassVar[bool] = True
    essential: ClassVar[int] = 1
    # the centre is the moment over the mass: 0.1 mg
    steps = np.array([1e-7, 1e-5, 1e-5, 1e-5, 1e-5])

    @property
    def place(self) -> dict[str, str]:
        return {"body": self.body_name}

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        return ((_LEAST, self.heaviest), FREE, FREE, FREE, POSITIVE)

    def rays(self, x: Array) -> list[Array]:
        """The found moment with the mass that it has at each of several distances."""
        moment, inertia = float(np.linalg.norm(x[1:4])), max(0.0, float(x[4]))
        masses = [moment / reach for reach in _REACHES if moment]
        return [np.array([mass, *x[1:4], inertia]) for mass in masses]

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """The parameters of the body plus those of a sphere at the centre."""
        added = np.zeros(TEN)
        added[:4] = x[:4]
        if x[0] > _NONE:
            added = of_body(float(x[0]), x[1:4] / float(x[0]), np.zeros((3, 3)))
        added[[4, 7, 9]] += 2.0 * x[4]
        return state.with_body(self.body, state.phi[self.body] + added)

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """Mass, centre in the frame of the body, inertia."""
        centre = x[1:4] / max(float(x[0]), _NONE)
        return (
            {"mass": (float(x[0]), "kg")}
            | {f"centre_{axis}": (float(c), "m") for axis, c in zip("xyz", centre, strict=True)}
            | {"inertia": (2.0 * float(x[4]), "kg m^2")}
        )
