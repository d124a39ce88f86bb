"""Sub-sample time offsets: nuisance parameters, not effects."""

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.effects import command_delay
from frictionjoint.effects.effect import NOTHING, Effect
from frictionjoint.identify.segment import Segment


@dataclass(frozen=True)
class Timing:
    """A time offset that is fitted together with the law, see `terms.Term`.

    Attributes:
        sample: sampling interval of the log, s. shape: the offset, s. within: its range, samples.
    """

    sample: float
    shape: tuple[float, ...] = (0.0,)
    name: ClassVar[str] = "timing"
    within: ClassVar[tuple[float, float]] = (-1.0, 1.0)
    coefficients: ClassVar[tuple[str, ...]] = ()
    follows_law: ClassVar[bool] = False
    effect: ClassVar[Effect] = NOTHING

    @property
    def delay(self) -> float:
        """0: the position of the log is not late."""
        return 0.0

    @property
    def at_its_end(self) -> bool:
        """Whether the offset is as long as its sample, so that it cannot be a sampling offset."""
        # a longer offset may be an effect's
        return abs(self.shape[0]) > 0.9 * self.sample

    @property
    def is_long(self) -> bool:
        """Whether the offset is longer than half its sample."""
        return abs(self.shape[0]) > 0.5 * self.sample

    @property
    def free_shape(self) -> tuple[float, ...]:
        """The time, s."""
        return self.shape

    @property
    def limits(self) -> tuple[tuple[float, float], ...]:
        """Range of the offset, s."""
        first, last = self.within
        return ((first * self.sample, last * self.sample),)

    def with_shape(self, shape: tuple[float, ...]) -> Self:
        """The offset with another time."""
        return replace(self, shape=shape)

    def columns(self, segment: Segment, signals: Array) -> Array:
        """None: it shifts the drive."""
        return np.zeros((len(signals), 0))


class DriveTiming(Timing):
    """Time by which a measured drive was read before the position; a longer time is
    `measurement-delay`."""

    name = "timing of the drive"

    @property
    def delay(self) -> float:
        """The offset of the drive, s."""
        return self.shape[0]


class TargetTiming(Timing):
    """Time by which a target acts later than a target held until the next row, within a sample.

    A target that is interpolated acts half a sample earlier; one that acts much later has the
    effect `command-delay`. The controller's position stays that of the log: if the whole drive were
    shifted, kp times the shift would look like viscous friction.
    """

    name = "timing of the target"
    within = (-0.5, 1.0)

    def change(self, block: Array, delay: float) -> tuple[Array, float]:
        """The controller with its delay changed by the offset."""
        return block, delay + self.shape[0]

    def figures(self, controller: Controller) -> dict[str, Any]:
        """See `DriveTerm`. Nothing for offsets far below a controller tick.

        Nothing for a target that acts early either: no file can state that.
        """
        # a controller's tick may lose a tenth of a sample
        late = self.shape[0] > 0.1 * self.sample
        return command_delay.figures(controller, self.shape) if late else {}


class VelocityAge(Timing):
    """Age of the velocity in a controller's damping.

    For a drive computed from commands: the delayed part is an acceleration that looks like inertia.
    """

    name = "age of the velocity"


class DampingAge(Timing):
    """Age of the velocity in viscous friction, in the log of a simulation.

    Its damping acts at the end or at the beginning of a step; a log contains the middle.
    """

    name = "age of the damping"
    # a step is no longer than a sample
    within = (-0.5, 0.5)
