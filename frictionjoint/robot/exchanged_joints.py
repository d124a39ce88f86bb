"""Columns that belong to another joint, and positions with the wrong sign or in degrees."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from itertools import combinations
from statistics import fmean

import numpy as np

from frictionjoint.decisions import APART, TIE
from frictionjoint.errors import FrictionJointError, LogError
from frictionjoint.identify.early_checks import unexplained_fraction
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import DRIVES, JointLog
from frictionjoint.measured.validate import FAR
from frictionjoint.robot.explain import Task
from frictionjoint.robot.joint import FittedJoint

# fraction of the drive's rms from which on a model explains little of a joint's drive, and how
# many times less an exchange must leave, in both joints: masses that are wrong do not do that
_MUCH, _TIMES = 0.3, 3.0


def require_own_columns(tasks: Mapping[str, Task], fitted: Mapping[str, FittedJoint]) -> None:
    """Check that no two joints, or their drives or positions, are exchanged in the logs, nor the
    positions of a joint without a fit reversed, nor those of one in degrees; LogError if drives
    that the model explains badly fit each other's place or a position in degrees, or if the other
    joints' drives fit reversed positions."""
    left = {name: unexplained_fraction(x.prepared) for name, x in fitted.items()}
    for name in tasks.keys() - fitted.keys():
        as_is = fmean(left.values())
        opposite = fmean(_left(tasks[n], tasks[n], partial(_turned, name)) for n in left)
        if opposite < (1.0 - TIE) * as_is:
            what = f"the positions of {name!r} have the wrong sign: as they are, the model leaves"
            left_of_others = f"{as_is:.0%} of the other joints' drives, reversed {opposite:.0%}"
            raise LogError(f"{what} {left_of_others}: check them")
    doubtful = [name for name, x in left.items() if x > _MUCH]
    for name in doubtful:
        task = tasks[name]
        travel = max(float(np.ptp(log.position)) for log in task.logs)
        # an inertia of a tenth also explains more in degrees, but no joint of an arm turns so far
        if travel > FAR and _left(task, task, _in_degrees) < APART * min(1.0, left[name]):
            what, fix = "if that is in degrees", "convert its positions to rad"
            turns = f"{name!r} turns by {travel:.3g} rad"
            raise LogError(f"{turns}, and the model explains its drive {what}: {fix}")
    for a, b in combinations(doubtful, 2):
        for what, exchanged in _EXCHANGES.items():
            try:
                other = [_left(tasks[x], tasks[y], exchanged) for x, y in ((a, b), (b, a))]
            except (FrictionJointError, KeyError, ValueError):  # not both joints are in each log
                continue
            # more than the whole drive is no worse than the whole
            if all(_TIMES * x < min(1.0, left[n]) for n, x in zip((a, b), other, strict=True)):
                raise LogError(
                    f"{what}{a!r} and {b!r} are exchanged in the logs: as they are, the model "
                    f"leaves {left[a]:.0%} and {left[b]:.0%} of their drives, exchanged "
                    f"{other[0]:.0%} and {other[1]:.0%}: check the columns"
                )


def _left(task: Task, other: Task, exchanged: Callable[[JointLog, JointLog], JointLog]) -> float:
    """What the model leaves of a joint's drive if columns of another are its own."""
    logs = [exchanged(x, y) for x, y in zip(task.logs, other.logs, strict=True)]
    body = RigidBody(task.user, task.joint, task.fixed)
    return unexplained_fraction(prepare(logs, body, controller=task.controller))


def _turned(joint: str, own: JointLog, _: JointLog) -> JointLog:
    """A log with the reversed position of another joint."""
    q, v = (
        {n: -x if n == joint else x for n, x in of.items()}
        for of in (own.other_positions, own.other_velocities)
    )
    return replace(own, other_positions=q, other_velocities=v, before=None)


def _in_degrees(own: JointLog, _: JointLog) -> JointLog:
    """A log whose own position and velocity are read in degrees."""
    velocity = None if own.velocity is None else np.radians(own.velocity)
    return replace(own, position=np.radians(own.position), velocity=velocity, before=None)


def _joints(own: JointLog, other: JointLog) -> JointLog:
    """A log of another joint with the two joints exchanged."""
    positions = other.other_positions | {other.joint: other.other_positions[own.joint]}
    del positions[own.joint]
    moved = other.other_velocities
    velocities = {other.joint if n == own.joint else n: x for n, x in moved.items()}
    alike = replace(other, other_positions=positions, other_velocities=velocities, before=None)
    return replace(alike, joint=own.joint)


def _drives(own: JointLog, other: JointLog) -> JointLog:
    """A log with the drive of another joint."""
    return replace(own, before=None, **{x: getattr(other, x) for x in (*DRIVES, "target")})


# what may be exchanged, and a joint's log then, from the two as they are
_EXCHANGES = {
    "": _joints,
    "the drives of ": _drives,
    "the positions of ": lambda own, other: _drives(_joints(own, other), own),
}
