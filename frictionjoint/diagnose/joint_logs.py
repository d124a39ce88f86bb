"""The logs of one joint, fitted and held out, prepared for a search."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.control.controller import Controller, unknown_notes
from frictionjoint.control.reconstruct import check_drive, measures_drive
from frictionjoint.effects.signals import TIME
from frictionjoint.errors import LogError
from frictionjoint.identify.early_checks import check
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.notes import other_drive_note
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import require_motion
from frictionjoint.replay.closed_loop import Loops


@dataclass(frozen=True)
class JointLogs:
    """The logs of one joint as recorded and as prepared."""

    fitted: Sequence[JointLog]
    held_out: Sequence[JointLog]
    bodies: Sequence[RigidBody]  # the joint's model in each log
    held_out_bodies: Sequence[RigidBody]
    prepared: Prepared
    kept_back: Prepared | None  # held-out logs
    controller: Controller | None  # what drove the joint to its target
    loops: Loops | None  # all logs in closed loop; None without a controller or a target
    notes: tuple[str, ...]  # what a reader of the report must know of the logs

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
    """The logs, checked and filtered; arguments and errors are those of `close_loop.explain`."""
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


def prepare_kept_back(
    logs: Sequence[JointLog],
    body: RigidBody | Sequence[RigidBody],
    fitted: Prepared,
    controller: Controller | None = None,
) -> Prepared:
    """Prepare held-out logs.

    A held-out end of a log starts with the temperature at the end of the fitted part. The log is
    prepared as a whole, with its clock, and only its end is used. The controller output is
    simulated from the first used sample on.

    Args:
        fitted: the fitted logs, whose band is used. Others: see `prepare`.
    Raises:
        LogError: the joint stands still, its drive is off throughout or of another kind than that
            of the fitted logs, or too few samples remain for a comparison.
    """
    for log in logs:
        # an error without motion has no meaning
        source = f"{log.name}, held out"
        require_motion(source, log.position)
        drive = next((x for x in (log.torque, log.voltage, log.current) if x is not None), None)
        if drive is not None and not np.any(drive):
            raise LogError(
                f"{source}: the drive is exactly 0 all along, so no friction model can be judged "
                "there: hold out a part or a log in which the drive acts"
            )
    warm = [log.with_before() if measures_drive(log) else log for log in logs]
    prepared = prepare(warm, body, fitted.band, controller)
    if prepared.drive != fitted.drive:
        what = f"{logs[0].name} has a {prepared.drive} and {fitted.segments[0].name}"
        raise LogError(f"{what} a {fitted.drive}: hold out a log with the drive of those fitted")
    since = [own.time[0] - log.time[0] for own, log in zip(logs, warm, strict=True)]
    pairs = zip(prepared.segments, since, strict=True)
    kept = replace(prepared, segments=tuple(_from(s, t) for s, t in pairs))
    left = sum(int(s.kept.sum()) for s in kept.segments)
    if left < 20:
        names = ", ".join(log.name for log in logs)
        raise LogError(
            f"{names}: too short to hold out: low-pass filtered to {fitted.band.balance:.3g} Hz it "
            f"has {left} independent samples: hold out a longer part or log"
        )
    return kept


def _from(segment: Segment, since: float) -> Segment:
    """The end of a log, without the samples that the filter's edge spoils."""
    if not since:
        return segment
    edge = int(min(np.argmax(segment.mask), np.argmax(segment.mask[::-1])))
    first = int(np.searchsorted(segment.signals[:, TIME], since)) + edge
    mask = segment.mask.copy()
    mask[:first] = False
    return replace(segment, mask=mask)
