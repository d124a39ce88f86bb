"""Candidates for the residual of the joints: a cause of the robot, or an effect of joints."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.stack import Columns


@dataclass(frozen=True)
class Candidate:
    """A shared cause, or an effect of one joint or of all, that may explain the residual.

    Attributes:
        cause: None for an effect. effect: its name. common: whether equal in all joints.
        at: its columns of the stack, from `first` on. joints: where it acts.
        room: by how much each number may change in either direction, shape (k, 2); for an effect of
            one joint, which that joint's search keeps within bounds, shape (0, 2).
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
        """Whether the candidate is a cause of the robot, not of one joint."""
        return self.cause is not None or self.common is not None

    @property
    def essential(self) -> int:
        """Number of leading parameters without which the candidate does not exist."""
        return self.cause.essential if self.cause else len(self.at)

    @property
    def among(self) -> float:
        """Number of spectral lines of which it is the strongest."""
        return self.cause.among if self.cause else 1.0

    @property
    def changed(self) -> str:
        """Key that is common to all forms of one change."""
        return self.cause.changed if self.cause else self.label

    @property
    def label(self) -> str:
        return self.cause.label if self.cause else effect_label(self.effect, *self.joints)


def effect_label(effect: str, *joints: str) -> str:
    """Name of an effect and of the joints where it acts."""
    return f"{effect} of {', '.join(joints)}"


def columns_of(candidates: Iterable[Candidate]) -> Columns:
    """Columns of the stack of several candidates, in order."""
    return np.concatenate([*(c.at for c in candidates), []]).astype(np.int64)
