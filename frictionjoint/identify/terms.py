"""Terms that a fit can add to the friction law: their interface, the catalogue's effects, and
sub-sample time offsets, which are nuisance parameters and no effects.
"""

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, Self, TypeVar

import numpy as np
from scipy.linalg import block_diag

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.reconstruct import AllCommands
from frictionjoint.effects.drive import delayed
from frictionjoint.effects.effect import NOTHING, Effect
from frictionjoint.effects.kernel import torques
from frictionjoint.effects.signals import GEAR, SAG, SWAY
from frictionjoint.identify.bundle import Change, CommandedLogs
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape

_T = TypeVar("_T")


class Term(Protocol):
    """Interface of a term for a fit; the defaults are those of a term without shape numbers.

    Implementations say only what is theirs.
    """

    @property
    def name(self) -> str:
        """Canonical name of the effect, or the variable of a smooth curve."""

    @property
    def effect(self) -> Effect:
        """Effect of the catalogue, `NOTHING` for a term of another kind."""
        return NOTHING

    @property
    def coefficients(self) -> tuple[str, ...]:
        """One name per column."""

    @property
    def shape(self) -> tuple[float, ...]:
        """Nonlinear numbers."""
        return ()

    @property
    def free_shape(self) -> tuple[float, ...]:
        """Nonlinear numbers that a fit may refine."""
        return self.shape

    @property
    def limits(self) -> tuple[tuple[float, float], ...]:
        """Physical range of each of them, infinite where there is none."""
        return ()

    def with_shape(self, shape: tuple[float, ...]) -> Self:
        """The term with other shape numbers."""
        return self

    @property
    def follows_law(self) -> bool:
        """Whether the columns change with the law's shape."""
        return False

    @property
    def changes_drive(self) -> bool:
        """Whether it changes the output of a controller, see `change`."""
        return False

    @property
    def delay(self) -> float:
        """Time by which the drive is logged early, s."""
        return 0.0

    def change(self, block: Array, delay: float) -> tuple[Array, float]:
        """A controller's block and delay as changed by the term."""
        return block, delay

    def figures(self, controller: Controller) -> dict[str, Any]:
        """Changes of a controller file that the term corresponds to."""
        return {}

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Range of each coefficient, in N m per unit of its column; none if empty."""
        return self.effect.bounds

    def columns(self, segment: Segment, signals: Array) -> Array:
        """Torque per unit of each coefficient, shape (n, k)."""

    def torque(self, segment: Segment, signals: Array, coefficients: Array) -> Array:
        """Torque with given coefficients along a log, shape (n,)."""
        return self.columns(segment, signals) @ coefficients


# range of the share of the inertia behind a spring
SHARES = (0.05, 1.0)


@dataclass(frozen=True)
class EffectTerm(Term):
    """An effect of the catalogue with given shape numbers, and the ratio of its own inertia to the
    inertia on which gravity acts, see `fit.implied_share`; a search may move that too."""

    effect: Effect = NOTHING
    shape: tuple[float, ...] = ()
    part: float = 1.0
    part_searched: bool = False

    @property
    def name(self) -> str:
        return self.effect.name

    @property
    def coefficients(self) -> tuple[str, ...]:
        return self.effect.coefficients

    @property
    def free_shape(self) -> tuple[float, ...]:
        """Numbers that a search moves: the shape after the fixed references, and the ratio."""
        return (*self.shape[self.effect.shape_fixed :], *[self.part] * self.part_searched)

    @property
    def limits(self) -> tuple[tuple[float, float], ...]:
        fixed = self.effect.shape_fixed
        found = self.effect.shape_bounds[fixed:] or ((-np.inf, np.inf),) * len(self.shape[fixed:])
        return (*found, *[SHARES] * self.part_searched)

    def with_shape(self, shape: tuple[float, ...]) -> Self:
        """The effect with other values of its last numbers."""
        part = self.part
        if self.part_searched:
            shape, part = shape[:-1], shape[-1]
        return replace(self, shape=(*self.shape[: len(self.shape) - len(shape)], *shape), part=part)

    @property
    def follows_law(self) -> bool:
        """Whether the columns depend on the law; effects on the friction level depend on Fh."""
        return self.effect.entry == "scales the friction level"

    @property
    def delay(self) -> float:
        return self.shape[0] if self.effect.delays else 0.0

    def columns(self, segment: Segment, signals: Array) -> Array:
        return self._torques(segment, signals, np.eye(len(self.coefficients)))

    def torque(self, segment: Segment, signals: Array, coefficients: Array) -> Array:
        """The sum of the columns, at the cost of one."""
        return self._torques(segment, signals, coefficients[None])[:, 0]

    def _torques(self, segment: Segment, signals: Array, coefficients: Array) -> Array:
        """Torque for each row of coefficients, by the kernel of a simulation."""
        signals = self.hung(signals)
        if self.effect.of_size:
            signals = signals.copy()
            signals[:, GEAR] = segment.gear
        found = torques(self.effect.effect_id, self.shape, coefficients, signals)
        if self.effect.free and any(segment.swing):
            free = self.effect.free(self.shape, segment.swing, signals)
            found += np.outer(free, coefficients[:, 0])
        return found * segment.driven[:, None] if self.effect.opposes_voltage else found

    def hung(self, signals: Array) -> Array:
        """The signals, with the gravity torque on the effect's own inertia."""
        if self.part == 1.0:
            return signals
        found = signals.copy()
        found[:, [SAG, SWAY]] /= self.part
        return found


@dataclass(frozen=True)
class DriveTerm(EffectTerm):
    """An effect of the drive, for logs with a known controller: it has no columns of its own."""

    changes_drive = True

    def change(self, block: Array, delay: float) -> tuple[Array, float]:
        assert self.effect.drive is not None
        return self.effect.drive(block, delay, self.shape)

    def figures(self, controller: Controller) -> dict[str, Any]:
        assert self.effect.controller is not None
        return self.effect.controller(controller, self.shape)

    def _torques(self, segment: Segment, signals: Array, coefficients: Array) -> Array:
        """None: it changes the drive, see `changed_drive`."""
        return np.zeros((len(signals), len(coefficients)))


def changing_drive(terms: tuple[Term, ...]) -> list[Term]:
    """Terms that change the controller output."""
    return [t for t in terms if t.changes_drive]


def drive_changes(terms: tuple[Term, ...]) -> list[Change]:
    """Changes of a controller by these terms, in order."""
    return [t.change for t in changing_drive(terms)]


def changed_drive(segment: Segment, terms: tuple[Term, ...]) -> Segment:
    """A log with the controller output changed by the effects of the drive among terms."""
    changes = drive_changes(terms)
    if not changes or segment.commanded is None:
        return segment
    drive = CommandedLogs([segment.commanded]).output(AllCommands.mean_drive, changes)
    return replace(segment, drive=drive[: len(segment.drive)])


def delay_of(terms: tuple[Term, ...]) -> float:
    """Time by which the position is logged later than the drive, s."""
    return sum(t.delay for t in terms)


def in_place(items: tuple[_T, ...], i: int, other: _T) -> tuple[_T, ...]:
    """Some items, such as terms, with another one in place of the i-th."""
    return (*items[:i], other, *items[i + 1 :])


def all_but(terms: tuple[Term, ...], term: Term) -> tuple[Term, ...]:
    """All terms but one."""
    return tuple(t for t in terms if t is not term)


def swing_columns(segment: Segment, term: Term) -> tuple[Array, Array]:
    """Torques of an initial free oscillation, per unit of the term's coefficient: columns on the
    kept samples, shape (n, 2), of a deflection and of a rate with the same amplitude; and these
    two, shape (2,)."""
    assert isinstance(term, EffectTerm)
    assert term.effect.free is not None
    sizes = np.array([1.0, 2.0 * np.pi * term.shape[0]])
    signals = term.hung(segment.signals)
    found = [
        term.effect.free(term.shape, (float(d), float(rate)), signals) for d, rate in np.diag(sizes)
    ]
    return segment.balanced(np.column_stack(found)), sizes


def swings_of(prepared: Prepared, term: Term) -> Array:
    """Columns of `swing_columns` for all logs, two per log, shape (n, 2 k)."""

    def made() -> Array:
        return np.asarray(block_diag(*(swing_columns(s, term)[0] for s in prepared.segments)))

    return prepared.columns.get(("swings", term), made)


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
    """Time by which a measured drive was read before the position, see `measurement-delay`."""

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
