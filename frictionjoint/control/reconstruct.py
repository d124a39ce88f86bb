"""The drive of a log that contains only target and position, from its controller.

If the drive is logged it is compared with the controller output, so a wrong gain or unit is found
before anything is fitted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.control import kernel as k
from frictionjoint.control.controller import UNKNOWN, Controller
from frictionjoint.control.kernel_numbers import block_of, delay_of, supply_of
from frictionjoint.control.mean_drive import fill_mean_drives
from frictionjoint.control.profile import followed
from frictionjoint.errors import LogError
from frictionjoint.measured.log import DRIVES, JointLog

# rad (m): change of a position for its effect on the drive, if there are no counts; rad/s (m/s):
# change of a velocity
_NUDGE = 1e-6


@dataclass(frozen=True)
class Commands:
    """Inputs of a controller along a log, each of shape (n,).

    Attributes:
        time: s. target, position: rad. velocity: rad/s. supply: relative to that of the block.
        block: of the controller, see `kernel`. delay: s, of the target.
        on: False while the drive was off.
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
        """Drive at each sample, from the controller's tick at that sample."""
        at = self.time - self.delay
        target = followed(self.time, self.target, at, self.block[k.SLEW])
        block, drive = self.block.copy(), np.empty_like(self.time)
        block[k.SLEW] = np.inf  # the target has been followed already
        given = (self.time, target, self.position, self.velocity, self.supply)
        k.along(block, *given, drive, np.zeros(k.STATE))
        return np.where(self.on, drive, 0.0)

    def mean_drive(self, block: Array | None = None, delay: float | None = None) -> Array:
        """Mean drive over half a sample on either side, for this or another block or delay."""
        delay = self.delay if delay is None else delay
        block = self.block if block is None else block
        return AllCommands([self]).mean_drive(block[None], np.array([delay]))


class AllCommands:
    """Commands of several logs, concatenated: one call computes all drives."""

    def __init__(self, logs: Sequence[Commands]) -> None:
        self.edges = np.cumsum([0, *(len(log.time) for log in logs)])
        self.time = np.concatenate([log.time for log in logs])
        names = ("target", "position", "velocity", "supply", "on")
        self._given = [np.concatenate([getattr(log, name) for log in logs]) for name in names]

    def mean_drive(
        self, blocks: Array, delays: Array, off: Array | float = 0.0, faster: float = 0.0
    ) -> Array:
        """See `Commands.mean_drive`, shape (n,).

        Args:
            blocks: of the controller of each log, shape (k, BLOCK). delays: s, shape (k,).
            off: added to the positions, rad (m). faster: added to the velocities, rad/s (m/s).
        """
        target, position, velocity, supply, on = self._given
        q, v = position + off, velocity + faster
        drive = np.empty_like(self.time)
        path = np.empty((4, 2 * int(np.diff(self.edges).max())))
        fill_mean_drives(
            blocks, delays, self.edges, self.time, target, q, v, supply, on, path, drive
        )
        return drive

    def answer(self, blocks: Array, delays: Array) -> Array:
        """Change of the drive per change of position, per rad (m), shape (n,).

        The position change is constant in time. The integral part is left out, because it would
        grow without limit. For the arguments see `mean_drive`.
        """
        blocks = blocks.copy()
        blocks[:, k.KI] = 0.0
        count = np.where(blocks[:, k.COUNT] > 0.0, blocks[:, k.COUNT], _NUDGE)
        nudge = np.repeat(count, np.diff(self.edges))
        less, more = (self.mean_drive(blocks, delays, off=way * nudge) for way in (-1.0, 1.0))
        return (less - more) / (2.0 * nudge)

    def damping(self, blocks: Array, delays: Array) -> Array:
        """Decrease of the drive per increase of velocity, per rad/s (m/s), shape (n,)."""
        less, more = (self.mean_drive(blocks, delays, faster=way * _NUDGE) for way in (-1.0, 1.0))
        return (less - more) / (2.0 * _NUDGE)


def commands(log: JointLog, controller: Controller) -> Commands:
    """The inputs of a controller along a log.

    Raises:
        LogError: the log has no target, or lacks a number of the controller.
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
        velocity=velocity,
        supply=supply_of(controller, log),
        block=block_of(controller, log),
        delay=delay_of(controller),
        on=np.ones(len(log.time), dtype=bool) if on is None else on,
    )


def drive_kind(controller: Controller) -> Literal["torque", "voltage", "current"]:
    """Kind of the output for a fit: a torque of unknown gain is treated like a current."""
    if controller.output != "torque_nm":
        return "voltage"
    return "current" if controller.kp == UNKNOWN else "torque"


def measures_drive(log: JointLog) -> bool:
    """Whether a log contains the drive of its motor."""
    return any(x is not None for x in (log.torque, log.voltage, log.current))


def with_drive(log: JointLog, controller: Controller | None) -> JointLog:
    """The log with its drive, measured or computed from the controller.

    Raises:
        LogError: neither the drive nor the controller is known.
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


def with_known_drive(log: JointLog, controller: Controller | None) -> JointLog:
    """The log with the drive of a controller whose values are all known; other logs unchanged."""
    if controller is None or UNKNOWN in (controller.kp, controller.supply_v):
        return log
    return log if log.target is None else with_drive(log, controller)


def difference(log: JointLog, controller: Controller) -> float | None:
    """Median difference of the measured drive from the controller's, relative to its rms.

    None if the log has no drive of the controller's kind, or its scale is not known.
    """
    kind = drive_kind(controller)
    measured = getattr(log, kind)
    if measured is None or UNKNOWN in (controller.kp, controller.supply_v):
        return None
    ticks = commands(log, controller)
    computed = ticks.drive()
    size = root_mean_square(computed[ticks.on])
    return float(np.median(np.abs(measured - computed)[ticks.on])) / size if size else None


def check_drive(log: JointLog, controller: Controller) -> tuple[str, ...]:
    """A note that compares the measured drive with the controller's, or that it is not compared.

    Raises:
        LogError: they differ.
    """
    apart = difference(log, controller)
    if apart is None:
        kind = next((kind for kind in DRIVES if getattr(log, kind) is not None), None)
        said = f"{log.name}: the {kind} is measured: the drive is not computed from the controller."
        return (said,) if kind else ()
    # a controller whose median difference from a measured drive is above 5% is wrong
    if apart > 0.05:
        raise LogError(
            f"{log.name}: the controller's drive is {apart:.0%} off the measured one: check its "
            "gains, gain_unit and supply_v, or leave it out"
        )
    return (f"{log.name}: the controller's drive agrees with the measured one to {apart:.1%}.",)
