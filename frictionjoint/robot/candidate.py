"""What may explain what joints leave: a cause of the robot, or an effect of one joint or of all."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.stack import Columns


@dataclass(frozen=True)
class Candidate:
    """A shared cause, or an effect of one joint or of all that explains the same residual.

    Attributes:
        cause: None for an effect. effect: name of that. common: of all joints alike.
        at: columns of the stack, from `first` on. joints: where it acts.
        room: how far each number may move either way, shape (k, 2); of an effect of one joint,
            which its own search keeps within bounds, shape (0, 2).
    """

    at: Columns = field(repr=False)
    joints: tuple[str, ...]
    cause: Cause | None = None
    effect: str = ""
    common: EffectTerm | None = None
    first: int = 0
    room: Array = field(default_factory=lambda: np.zeros((0, 2)), repr=False)

    @property
    def shared(self) -> bool:
        """Whether it is a cause of the robot, not of one joint."""
        return self.cause is not None or self.common is not None

    @property
    def essential(self) -> int:
        """How many of its numbers, the first ones, it is nothing without."""
        return self.cause.essential if self.cause else len(self.at)

    @property
    def among(self) -> float:
        """How many lines of a spectrum it is the strongest of."""
        return self.cause.among if self.cause else 1.0

    @property
    def order(self) -> int:
        """Place among all candidates."""
        return self.first

    @property
    def changed(self) -> str:
        """What all forms of one change have in common."""
        return self.cause.changed if self.cause else self.label

    @property
    def label(self) -> str:
        """What it is and where."""
        return self.cause.label if self.cause else f"{self.effect} of {', '.join(self.joints)}"


def columns_of(candidates: Iterable[Candidate]) -> Columns:
    """Their columns of the stack, in turn."""
    return np.concatenate([*(c.at for c in candidates), []]).astype(np.int64)
