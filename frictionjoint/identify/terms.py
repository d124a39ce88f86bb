"""Terms that a fit can add to the friction law: their interface, and the catalogue's effects."""

from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.reconstruct import AllCommands
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.kernel import torques
from frictionjoint.effects.signals import GEAR, SAG, SWAY
from frictionjoint.identify.commanded import Change, CommandedLogs
from frictionjoint.identify.segment import Segment
from frictionjoint.identify.timing import TargetTiming, Timing, VelocityAge

_T = TypeVar("_T")


class Term(Protocol):
    """Interface of a term for a fit."""

    @property
    def name(self) -> str:
        """Canonical name of the effect, or the variable of a smooth curve."""

    @property
    def coefficients(self) -> tuple[str, ...]:
        """One name per column."""

    @property
    def shape(self) -> tuple[float, ...]:
        """Nonlinear numbers."""

    @property
    def free_shape(self) -> tuple[float, ...]:
        """Nonlinear numbers that a fit may refine."""

    @property
    def limits(self) -> tuple[tuple[float, float], ...]:
        """Physical range of each of them, infinite where there is none."""

    def with_shape(self, shape: tuple[float, ...]) -> "Term":
        """The term with other shape numbers."""

    @property
    def follows_law(self) -> bool:
        """Whether the columns change with the law's shape."""

    @property
    def effect(self) -> Effect:
        """Effect of the catalogue, `NOTHING` for a term of another kind."""

    @property
    def delay(self) -> float:
        """Time by which the drive is logged early, s."""

    def columns(self, segment: Segment, signals: Array) -> Array:
        """Torque per unit of each coefficient, shape (n, k)."""


@dataclass(frozen=True)
class EffectTerm:
    """An effect of the catalogue with given shape numbers.

    Attributes:
        part: ratio of the effect's own inertia to the inertia on which gravity acts, see
            `elastic_share`.
    """

    effect: Effect
    shape: tuple[float, ...] = ()
    part: float = 1.0

    @property
    def name(self) -> str:
        """Canonical name."""
        return self.effect.name

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Names of the linear coefficients."""
        return self.effect.coefficients

    @property
    def free_shape(self) -> tuple[float, ...]:
        """Shape numbers after the fixed references."""
        return self.shape[self.effect.shape_fixed :]

    @property
    def limits(self) -> tuple[tuple[float, float], ...]:
        """Bounds of the effect."""
        found = self.effect.shape_bounds[self.effect.shape_fixed :]
        return found or ((-np.inf, np.inf),) * len(self.free_shape)

    def with_shape(self, shape: tuple[float, ...]) -> "EffectTerm":
        """The effect with other shape numbers."""
        return replace(self, shape=(*self.shape[: len(self.shape) - len(shape)], *shape))

    @property
    def follows_law(self) -> bool:
        """Whether the columns depend on the law; effects on the friction level depend on Fh."""
        return self.effect.entry == "scales the friction level"

    @property
    def delay(self) -> float:
        """Time by which the drive is logged early, s."""
        return self.shape[0] if self.effect.delays else 0.0

    def columns(self, segment: Segment, signals: Array) -> Array:
        """Torque per unit of each coefficient along a log, shape (n, k)."""
        return self._torques(segment, signals, np.eye(len(self.coefficients)))

    def torque(self, segment: Segment, signals: Array, coefficients: Array) -> Array:
        """Torque with given coefficients, shape (n,): the sum of the columns, at the cost of
        one."""
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

    def change(self, block: Array, delay: float) -> tuple[Array, float]:
        """A controller's block and delay as changed by the effect."""
        assert self.effect.drive is not None
        return self.effect.drive(block, delay, self.shape)

    def figures(self, controller: Controller) -> dict[str, Any]:
        """Changes of a controller file that the effect corresponds to."""
        assert self.effect.controller is not None
        return self.effect.controller(controller, self.shape)

    def _torques(self, segment: Segment, signals: Array, coefficients: Array) -> Array:
        """None: it changes the drive, see `changed_drive`."""
        return np.zeros((len(signals), len(coefficients)))


def torque_of(term: Term, segment: Segment, signals: Array, coefficients: Array) -> Array:
    """Torque of a term with given coefficients along a log, shape (n,)."""
    if isinstance(term, EffectTerm):
        return term.torque(segment, signals, coefficients)
    return term.columns(segment, signals) @ coefficients


def changing_drive(terms: tuple[Term, ...]) -> list[DriveTerm | TargetTiming]:
    """Terms that change the controller output."""
    return [
        t
        for t in terms
        if isinstance(t, DriveTerm) or (isinstance(t, TargetTiming) and any(t.shape))
    ]


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


def age_of(terms: tuple[Term, ...], kind: type[Timing] = VelocityAge) -> float:
    """Age of the velocity in a controller's damping, or of another kind, s."""
    return sum(t.shape[0] for t in terms if isinstance(t, kind))


def delay_of(terms: tuple[Term, ...]) -> float:
    """Time by which the position is logged later than the drive, s."""
    return sum(t.delay for t in terms)


def in_place(items: tuple[_T, ...], i: int, other: _T) -> tuple[_T, ...]:
    """Some items, such as terms, with another one in place of the i-th."""
    return (*items[:i], other, *items[i + 1 :])


def all_but(terms: tuple[Term, ...], term: Term) -> tuple[Term, ...]:
    """All terms but one."""
    return tuple(t for t in terms if t is not term)
