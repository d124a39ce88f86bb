"""Sub-sample time offsets: nuisance parameters, not effects."""

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.effects.drive import delayed
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import Term


@dataclass(frozen=True)
class Timing(Term):
    """A time offset, s, that is fitted together with the law, within a range in samples."""

    sample: float
    shape: tuple[float, ...] = (0.0,)
    within: ClassVar[tuple[float, float]] = (-1.0, 1.0)
    coefficients = ()

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
    def limits(self) -> tuple[tuple[float, float], ...]:
        first, last = self.within
        return ((first * self.sample, last * self.sample),)

    def with_shape(self, shape: tuple[float, ...]) -> Self:
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
        return self.shape[0]


class TargetTiming(Timing):
    """Time by which a target acts later than a target held until the next row, within a sample.

    A target that is interpolated acts half a sample earlier; one that acts much later has the
    effect `command-delay`. The controller's position stays that of the log: if the whole drive were
    shifted, kp times the shift would look like viscous friction.
    """

    name = "timing of the target"
    within = (-0.5, 1.0)

    @property
    def changes_drive(self) -> bool:
        """Unless the offset is zero."""
        return any(self.shape)

    def change(self, block: Array, delay: float) -> tuple[Array, float]:
        return block, delay + self.shape[0]

    def figures(self, controller: Controller) -> dict[str, Any]:
        """The delay; no file can state that a target acts early."""
        # a controller's tick may lose a tenth of a sample
        late = self.shape[0] > 0.1 * self.sample
        return delayed(controller, self.shape) if late else {}


class VelocityAge(Timing):
    """Age of the velocity in a controller's damping, which computes the drive from commands: the
    delayed part is an acceleration that looks like inertia."""

    name = "age of the velocity"


class DampingAge(Timing):
    """Age of the velocity in viscous friction, in the log of a simulation, whose damping acts at
    the end or at the beginning of a step; a log contains the middle."""

    name = "age of the damping"
    # a step is no longer than a sample
    within = (-0.5, 0.5)


def age_of(terms: tuple[Term, ...], kind: type[Timing] = VelocityAge) -> float:
    """Age of the velocity in a controller's damping, or of another kind, s."""
    return sum(t.shape[0] for t in terms if isinstance(t, kind))


def timed(prepared: Prepared, terms: tuple[Term, ...], law: Shape) -> tuple[Term, ...]:
    """The terms, and the sub-sample time offsets that the logs leave open.

    They are: the time of a measured drive relative to its position, or of a command relative to its
    target, unless an effect states it, because channels are read one after the other. For a target
    with a delay of its own, the offset is that of the controller's tick. The age of a velocity, in
    a controller's damping or in a simulation, is assumed to be zero while an inertia or a gain
    is searched for: logs cannot distinguish them.
    """
    if any(isinstance(t, Timing) for t in terms):
        return terms
    sample = min(s.sample for s in prepared.segments)
    found: list[Timing] = []
    effects = [t.effect for t in terms]
    if not any(e.delays for e in effects):
        of_target = prepared.commanded and not any(e.delays_target for e in effects)
        found.append(TargetTiming(sample) if of_target else DriveTiming(sample))
    if (prepared.damped or law.steps) and not any(
        e.is_inertia or e.of_inertia or e.scales for e in effects
    ):
        found.append(VelocityAge(sample) if prepared.damped else DampingAge(sample))
    return (*terms, *(t for t in found if t.name not in prepared.nothing))
