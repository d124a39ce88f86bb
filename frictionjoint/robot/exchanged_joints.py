"""Joints whose columns are exchanged in the logs: each belongs to the other joint of the model."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from frictionjoint.errors import FrictionJointError, LogError
from frictionjoint.identify.early_checks import unexplained_fraction
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog
from frictionjoint.robot.explain import Task
from frictionjoint.robot.joint import FittedJoint

# fraction of the drive's rms from which on a model explains little of a joint's drive, and how
# many times less an exchange must leave, in both joints: masses that are wrong do not do that
_MUCH, _TIMES = 0.3, 3.0


def require_own_columns(tasks: Mapping[str, Task], fitted: Mapping[str, FittedJoint]) -> None:
    """Check that no two joints are exchanged in the logs; LogError if two whose drives the model
    explains badly fit each other's place."""
    left = {name: unexplained_fraction(x.prepared) for name, x in fitted.items()}
    doubtful = [name for name, x in left.items() if x > _MUCH]
    for pair in combinations(doubtful, 2):
        try:
            other = [_left(tasks[a], tasks[b].logs) for a, b in (pair, pair[::-1])]
        except (FrictionJointError, KeyError):  # not both joints are in each log
            continue
        if all(_TIMES * x < left[name] for name, x in zip(pair, other, strict=True)):
            a, b = pair
            raise LogError(
                f"{a!r} and {b!r} are exchanged in the logs: as they are, the model leaves "
                f"{left[a]:.0%} and {left[b]:.0%} of their drives, exchanged {other[0]:.0%} and "
                f"{other[1]:.0%}: check the columns"
            )


def _left(task: Task, others: Sequence[JointLog]) -> float:
    """What the model leaves of a joint's drive if the columns of another are its own."""
    logs = [_as_of(task.joint, log) for log in others]
    body = RigidBody(task.user, task.joint, task.fixed)
    return unexplained_fraction(prepare(logs, body, controller=task.controller))


def _as_of(joint: str, log: JointLog) -> JointLog:
    """A log of another joint with the two joints exchanged."""
    positions = log.other_positions | {log.joint: log.other_positions[joint]}
    del positions[joint]
    velocities = {log.joint if n == joint else n: x for n, x in log.other_velocities.items()}
    return replace(
        log, joint=joint, other_positions=positions, other_velocities=velocities, before=None
    )
