"""The logs of one joint, prepared for a search."""

from collections.abc import Sequence
from dataclasses import dataclass

from frictionjoint.control.controller import Controller, unknown_notes
from frictionjoint.control.reconstruct import check_drive
from frictionjoint.diagnose.kept_back import prepare_kept_back
from frictionjoint.identify.bodies import Bodies
from frictionjoint.identify.gate import check
from frictionjoint.identify.notes import other_drive_note
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.loops import Loops


@dataclass(frozen=True)
class JointLogs:
    """The logs of one joint as recorded and as prepared.

    Attributes:
        bodies, held_out_bodies: the joint's model in each log.
        prepared, kept_back: fitted and held-out logs. controller: what drove the joint to its
            target. loops: all logs in closed loop; None without a controller or a target.
        notes: what a reader of the report must know of the logs.
    """

    fitted: Sequence[JointLog]
    held_out: Sequence[JointLog]
    bodies: Sequence[RigidBody]
    held_out_bodies: Sequence[RigidBody]
    prepared: Prepared
    kept_back: Prepared | None
    controller: Controller | None
    loops: Loops | None
    notes: tuple[str, ...]

    @property
    def body(self) -> RigidBody:
        """The joint's model in the first log, which is that of the result."""
        return self.bodies[0]


def prepare_logs(
    logs: Sequence[JointLog],
    held_out: Sequence[JointLog],
    bodies: Bodies,
    controller: Controller | None,
) -> JointLogs:
    """The logs, checked and filtered.

    Args:
        held_out: may be empty. bodies: the model around the joint.
        controller: what drove the joint to its target.
    Raises:
        FrictionJointError: bad logs, in one line.
    """
    mine, theirs = bodies.of(logs), bodies.of(held_out)
    said = bodies.check(logs, held_out)
    if controller:
        said += tuple(note for log in (*logs, *held_out) for note in check_drive(log, controller))
        said += unknown_notes(controller)
    prepared, kept_back = prepare(list(logs), mine, controller=controller), None
    check(prepared)
    if held_out:
        kept_back = prepare_kept_back(held_out, theirs, prepared, controller)
    said += other_drive_note(prepared, kept_back)
    loops = Loops.of(((logs, mine), (held_out, theirs)), controller) if controller else None
    return JointLogs(logs, held_out, mine, theirs, prepared, kept_back, controller, loops, said)
