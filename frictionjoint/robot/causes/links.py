"""Wrong inertial parameters of all links at once, each by a little."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.body_inertia import BodyInertia
from frictionjoint.robot.causes.cause import Cause, composed
from frictionjoint.robot.corrections import Corrections


@dataclass(frozen=True)
class Links(Cause):
    """Numbers: those of each link, one after the other.

    Attributes:
        links: a cause for each.
    """

    links: tuple[BodyInertia, ...]
    name: ClassVar[str] = "body-inertia"

    @property
    def place(self) -> dict[str, str]:
        """See `Cause`."""
        return {"bodies": ", ".join(x.body_name for x in self.links)}

    @property
    def steps(self) -> Array:
        """See `Cause`."""
        return np.concatenate([x.steps for x in self.links])

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """See `Cause`."""
        return tuple(b for x in self.links for b in x.bounds)

    @property
    def prior(self) -> Array:
        """See `Cause`."""
        return np.concatenate([x.prior for x in self.links])

    def parts(self, x: Array) -> tuple[Array, ...]:
        """Numbers of each link."""
        return tuple(np.split(x, np.cumsum([len(c.start) for c in self.links])[:-1]))

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """See `Cause`."""
        return composed(self.links, self.parts(x), state)

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """See `Cause`."""
        found = {}
        for link, own in zip(self.links, self.parts(x), strict=True):
            for name, value in link.values(state, own).items():
                found[f"{link.body_name}.{name}"] = value
        return found


def parts_of(cause: Cause, x: Array) -> Iterator[tuple[Cause, Array]]:
    """The causes that one is made of, each of one body or joint, with their numbers."""
    if isinstance(cause, Links):
        yield from zip(cause.links, cause.parts(x), strict=True)
    else:
        yield cause, x
