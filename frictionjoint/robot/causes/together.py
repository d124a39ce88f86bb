"""All causes of one kind at once: small errors of all links, or rotors that no joint has."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import Cause, composed
from frictionjoint.robot.corrections import Corrections


@dataclass(frozen=True)
class Together(Cause):
    """Numbers: those of each cause, in order.

    Attributes:
        members: the causes. where: key of their places in the report.
    """

    members: tuple[Cause, ...]
    where: ClassVar[str]

    @property
    def place(self) -> dict[str, str]:
        """The places of all members."""
        return {self.where: ", ".join(place_of(x) for x in self.members)}

    @property
    def steps(self) -> Array:
        """Those of the members, one after the other."""
        return np.concatenate([x.steps for x in self.members])

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Those of the members, one after the other."""
        return tuple(b for x in self.members for b in x.bounds)

    @property
    def prior(self) -> Array:
        """Those of the members, one after the other."""
        return np.concatenate([x.prior for x in self.members])

    def parts(self, x: Array) -> tuple[Array, ...]:
        """Numbers of each member."""
        return tuple(np.split(x, np.cumsum([len(c.start) for c in self.members])[:-1]))

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """Corrections with all members added."""
        return composed(self.members, self.parts(x), state)

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """Values of all members, each name after the member's place."""
        found = {}
        for member, own in zip(self.members, self.parts(x), strict=True):
            for name, value in member.values(state, own).items():
                found[f"{place_of(member)}.{name}"] = value
        return found


class Links(Together):
    """Wrong inertial parameters of all links."""

    name: ClassVar[str] = "body-inertia"
    where: ClassVar[str] = "bodies"


class Rotors(Together):
    """Rotors of all joints that have none in the model, as in any URDF."""

    name: ClassVar[str] = "rotor-inertia"
    where: ClassVar[str] = "joints"


def place_of(cause: Cause) -> str:
    """The body or the joint of a cause."""
    return next(iter(cause.place.values()))


def parts_of(cause: Cause, x: Array) -> Iterator[tuple[Cause, Array]]:
    """The causes that a joint cause consists of, each of one body or joint, with their numbers."""
    if isinstance(cause, Together):
        yield from zip(cause.members, cause.parts(x), strict=True)
    else:
        yield cause, x
