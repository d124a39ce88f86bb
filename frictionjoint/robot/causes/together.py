"""All causes of one kind at once: small errors of all links, or rotors that no joint has."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.corrections import Corrections


@dataclass(frozen=True)
class Together(Cause):
    """Numbers: those of the members, in order; `where` is the report's key of their places."""

    members: tuple[Cause, ...]
    where: ClassVar[str]

    @property
    def place(self) -> dict[str, str]:
        return {self.where: ", ".join(_place_of(x) for x in self.members)}

    @property
    def steps(self) -> Array:
        return np.concatenate([x.steps for x in self.members])

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        return tuple(b for x in self.members for b in x.bounds)

    @property
    def prior(self) -> Array:
        return np.concatenate([x.prior for x in self.members])

    def parts(self, x: Array) -> list[tuple[Cause, Array]]:
        ends = np.cumsum([len(c.start) for c in self.members])[:-1]
        return list(zip(self.members, np.split(x, ends), strict=True))

    def applied(self, state: Corrections, x: Array) -> Corrections:
        for member, own in self.parts(x):
            state = member.applied(state, own)
        return state

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """Values of all members, each name after the member's place."""
        found = {}
        for member, own in self.parts(x):
            for name, value in member.values(state, own).items():
                found[f"{_place_of(member)}.{name}"] = value
        return found


class Links(Together):
    """Wrong inertial parameters of all links."""

    name: ClassVar[str] = "body-inertia"
    where: ClassVar[str] = "bodies"


class Rotors(Together):
    """Rotors of all joints that have none in the model, as in any URDF."""

    name: ClassVar[str] = "rotor-inertia"
    where: ClassVar[str] = "joints"


def _place_of(cause: Cause) -> str:
    """The body or the joint of a cause."""
    return next(iter(cause.place.values()))
