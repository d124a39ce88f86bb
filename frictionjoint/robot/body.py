"""The rigid body around one joint of a corrected model.

The mean Coulomb friction of a shaft is a tendon's `frictionloss` there, which every `RigidBody`
knows; how it changes along the shaft's turn is added here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.held import Pose
from frictionjoint.identify.rigid_body import RigidBody, RigidBodyTorque, direction
from frictionjoint.robot.corrections import Shaft


class CorrectedBody(RigidBody):
    """A `RigidBody` of a corrected MJCF, in which some tendons represent `shafts`."""

    def __init__(
        self,
        mjcf: str | Path,
        joint: str,
        fixed: Mapping[str, Pose] | None = None,
        shafts: Sequence[Shaft] = (),
    ) -> None:
        super().__init__(mjcf, joint, fixed)
        self.shafts = tuple(shafts)

    def torque(
        self,
        position: Array,
        velocity: Array,
        acceleration: Array,
        others: Mapping[str, tuple[Array, Array, Array]] | None = None,
    ) -> RigidBodyTorque:
        """Inverse dynamics along a motion, with what the shafts add to the load."""
        found = super().torque(position, velocity, acceleration, others)
        moves = {name: (q, v) for name, (q, v, _) in (others or {}).items()}
        moves[self.joint] = position, velocity
        still = np.zeros_like(position), np.zeros_like(velocity)
        load = found.load
        unknown = np.zeros_like(velocity) if found.unknown is None else found.unknown
        for shaft in self.shafts:
            per_turn = shaft.per_turn(self.joint)
            if per_turn and shaft.waves:
                one, other = (moves.get(name, still) for name in shaft.joints)
                turn, speed = (a + shaft.ratio * b for a, b in zip(one, other, strict=True))
                level = per_turn * shaft.wave(turn)
                load = load + level * direction(speed)
                unknown = unknown + np.abs(level) * (1.0 - np.abs(direction(speed)))
        return replace(found, load=load, unknown=unknown if unknown.any() else None)
