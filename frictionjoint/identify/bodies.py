"""The MJCF of each log: one for all, or one per load by the names of the logs."""

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

import mujoco

from frictionjoint.errors import ModelError
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.identify.matching import check_logs
from frictionjoint.identify.rigid_body import RigidBody, ignored_note
from frictionjoint.measured.log import JointLog


class Bodies:
    """Rigid bodies of one joint under one or several loads.

    Args:
        model: an MJCF, or one per pattern of log names (``light*``); the first pattern that matches
            is used.
        joint: name. fixed: see `RigidBody`.
    Raises:
        ModelError: see `RigidBody`; there is no pattern.
    """

    def __init__(
        self,
        model: str | Path | Mapping[str, str | Path],
        joint: str,
        fixed: Mapping[str, Pose] | None = None,
    ) -> None:
        by_pattern = dict(model) if isinstance(model, Mapping) else {"*": model}
        if not by_pattern:
            raise ModelError("model is empty: give an MJCF, or one by a pattern of the logs' names")
        self._bodies = {p: RigidBody(mjcf, joint, fixed) for p, mjcf in by_pattern.items()}

    @classmethod
    def one(cls, body: RigidBody) -> "Bodies":
        """The same body for all logs."""
        found = cls.__new__(cls)
        found._bodies = {"*": body}
        return found

    @property
    def models(self) -> list[mujoco.MjModel]:
        """Compiled models, one per load."""
        return [body.model for body in self._bodies.values()]

    def of(self, logs: Sequence[JointLog]) -> list[RigidBody]:
        """The body of each log; ModelError: no pattern matches a log."""
        return [self._of(log) for log in logs]

    def _of(self, log: JointLog) -> RigidBody:
        for pattern, body in self._bodies.items():
            if fnmatchcase(log.name, pattern):
                return body
        listed = ", ".join(self._bodies)
        raise ModelError(f"no model for log {log.name!r}: its name fits none of {listed}")

    def check(self, logs: Sequence[JointLog], held_out: Sequence[JointLog]) -> tuple[str, ...]:
        """`check_logs` of each body with its logs, with notes on omitted parts of the MJCF."""
        said: list[str] = []
        for body in self._bodies.values():
            mine, theirs = ([x for x in some if self._of(x) is body] for some in (logs, held_out))
            said += check_logs(mine, body, theirs)
            if body.carried:
                said.append(ignored_note([body.joint]))
            if body.native:
                said.append(
                    f"Joint {body.joint!r} has {body.native} in the MJCF. It is ignored here, and "
                    "removed where the identified friction is added, because it would count twice."
                )
        return tuple(dict.fromkeys(said))
