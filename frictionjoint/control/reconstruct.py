"""The drive of a log that holds target and position only, as its controller made it.

Where the drive is logged it is compared with what the controller would have made: a wrong gain or
unit shows before anything is fitted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.control import kernel as k
from frictionjoint.control.block import block_of, delay_of, supply_of
from frictionjoint.control.controller import UNKNOWN, Controller
from frictionjoint.control.mean_drive import fill_mean_drives
from frictionjoint.control.profile import followed
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog

# difference from a measured drive, median over its rms, from which on the controller is another
_LARGEST = 0.05
# rad (m): change of a position that shows how a drive answers it, where it is not seen in counts;
# and rad/s (m/s) of a velocity
_NUDGE = 1e-6


@dataclass(frozen=True)
class Commands:
    """What a controller was given and measured along a log, each of shape (n,).

    Attributes:
        time: s. target, position: rad. velocity: rad/s. supply: over that of the block, 1.
        block: of the controller, see `kernel`. delay: s, of the target.
        on: False where the drive was off.
    """

    time: Array
    target: Array
    position: Array
    velocity: Array
    supply: Array
    block: Array
    delay: float
    on: NDArray[np.bool_]

    def drive(self) -> Array:
        """Drive at each sample, as the controller's tick there makes it."""
        at = self.time - self.delay
        target = followed(self.time, self.target, at, self.block[k.SLEW])
        return self._along(target, self.block)

    def mean_drive(self, block: Array | None = None, delay: float | None = None) -> Array:
        """Drive around each sample, of this controller or of one with another block or delay.

        The mean over half a sample on either side, see `mean_drive`.
        """
        delay = self.delay if delay is None else delay
        block = self.block if block is None else block
        return AllCommands([self]).mean_drive(block[None], np.array([delay]))

    def _along(self, target: Array, block: Array) -> Array:
        """Drive for a target that is followed already."""
        block = block.copy()
        block[k.SLEW] = np.inf
        drive = np.empty_like(self.time)
        k.along(
            block,
            self.time,
            target,
            self.position,
            self.velocity,
            self.supply,
            drive,
            np.zeros(k.STATE),
        )
        return np.where(self.on, drive, 0.0)


class AllCommands:
    """Those of several logs, one behind the other: one call makes the drives of all."""

    def __init__(self, logs: Sequence[Commands]) -> None:
        self.edges = np.cumsum([0, *(len(log.time) for log in logs)])
        self.time = np.concatenate([log.time for log in logs])
        self._given = (
            np.concatenate([log.target for log in logs]),
            np.concatenate([log.position for log in logs]),
            np.concatenate([log.velocity for log in logs]),
            np.concatenate([log.supply for log in logs]),
            np.concatenate([log.on for log in logs]),
        )

    def mean_drive(self, blocks: Array, delays: Array) -> Array:
        """See `Commands.mean_drive`, shape (n,).

        Args:
            blocks: of the controller of each log, shape (k, BLOCK). delays: s, shape (k,).
        """
        return self._mean_drive(blocks, delays)

    def answer(self, blocks: Array, delays: Array) -> Array:
        """How much drive a position that is off by a little calls for, per rad (m), shape (n,).

        A constant error, for which an integral would wind up as long as the log lasts: its part is
        left out.

        Args:
            blocks, delays: as above.
        """
        blocks = blocks.copy()
        blocks[:, k.KI] = 0.0
        count = np.where(blocks[:, k.COUNT] > 0.0, blocks[:, k.COUNT], _NUDGE)
        nudge = np.repeat(count, np.diff(self.edges))
        less, more = (self._mean_drive(blocks, delays, off=way * nudge) for way in (-1.0, 1.0))
        return (less - more) / (2.0 * nudge)

    def damping(self, blocks: Array, delays: Array) -> Array:
        """How much less drive a velocity calls for that is a little larger, per rad/s (m/s), (n,).

        Args:
            blocks, delays: as above.
        """
        less, more = (self._mean_drive(blocks, delays, faster=way * _NUDGE) for way in (-1.0, 1.0))
        return (less - more) / (2.0 * _NUDGE)

    def _mean_drive(
        self, blocks: Array, delays: Array, off: Array | float = 0.0, faster: float = 0.0
    ) -> Array:
        """With positions and velocities off by so much."""
        target, position, velocity, supply, on = self._given
        q, v = position + off, velocity + faster
        drive = np.empty_like(self.time)
        path = np.empty((4, 2 * int(np.diff(self.edges).max())))
        fill_mean_drives(
            blocks, delays, self.edges, self.time, target, q, v, supply, on, path, drive
        )
        return drive


def commands(log: JointLog, controller: Controller) -> Commands:
    """What a controller saw along a log.

    Raises:
        LogError: the log has no target, or lacks a figure of the controller.
    """
    if log.target is None:
        raise LogError(f"{log.name}: no target for the controller to follow, add target_rad")
    velocity = log.velocity
    if velocity is None:
        velocity = np.gradient(log.position, log.time)
    on = log.torque_enabled
    return Commands(
        time=log.time,
        target=log.target,
        position=log.position,
        velocity=np.asarray(velocity),
        supply=supply_of(controller, log),
        block=block_of(controller, log),
        delay=delay_of(controller),
        on=np.ones(len(log.time), dtype=bool) if on is None else on,
    )


def drive_kind(controller: Controller) -> Literal["torque", "voltage", "current"]:
    """What the output is to a fit: a torque up to a gain is to it what a current is."""
    if controller.output != "torque_nm":
        return "voltage"
    return "current" if controller.kp == UNKNOWN else "torque"


def measures_drive(log: JointLog) -> bool:
    """Whether a log holds what its motor was given."""
    return any(x is not None for x in (log.torque, log.voltage, log.current))


def with_drive(log: JointLog, controller: Controller | None) -> JointLog:
    """The log with its drive: as measured, or as the controller made it.

    Raises:
        LogError: neither a drive nor a controller is known.
    """
    if measures_drive(log):
        return log
    if controller is None:
        raise LogError(
            f"{log.name}: target and position, but no torque_nm, voltage_v or current_a: add one "
            "of them, or give the gains that drove the joint, --controller FILE (mjcf: the "
            "position servo of the MJCF)"
        )
    drive = commands(log, controller).drive()
    kind = drive_kind(controller)
    return replace(log, **{kind: drive})  # type: ignore[arg-type]


def difference(log: JointLog, controller: Controller) -> float | None:
    """Median difference of the measured drive from the controller's, over the latter's rms.

    None where the log holds no drive of the controller's kind, or its size is not known.
    """
    kind = drive_kind(controller)
    measured = getattr(log, kind)
    if measured is None or UNKNOWN in (controller.kp, controller.supply_v):
        return None
    seen = commands(log, controller)
    made = seen.drive()
    size = float(np.sqrt(np.mean(made[seen.on] ** 2)))
    return float(np.median(np.abs(measured - made)[seen.on])) / size if size else None


def check_drive(log: JointLog, controller: Controller) -> tuple[str, ...]:
    """A note on how the measured drive compares with the controller's.

    Raises:
        LogError: they are not the same.
    """
    apart = difference(log, controller)
    if apart is None:
        return ()
    if apart > _LARGEST:
        raise LogError(
            f"{log.name}: the controller's drive is {apart:.0%} off the measured one: check its "
            "gains, gain_unit and supply_v, or leave it out"
        )
    return (f"{log.name}: the controller's drive agrees with the measured one to {apart:.1%}.",)
