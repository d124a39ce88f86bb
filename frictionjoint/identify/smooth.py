"""Terms without a physical name: dependences of a residual that no known effect explains, and
measurement artefacts (torque that was not delivered, sensor saturation, encoder eccentricity).

Each term names the measured quantity on which it depends. These terms are not simulated. With an
artefact the log is wrong and not the model.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.signals import GX, GY, LOAD, TEMP, TIME, A, H, Q, V
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.terms import Term

VARIABLES = {
    "position": Q,
    "velocity": V,
    "acceleration": A,
    "load": LOAD,
    "time": TIME,
    "temperature_c": TEMP,
}
# quantities of which a model contains a multiple: the torque's gain, viscous friction
_PROPORTIONAL = ("load", "velocity")
# what the filter of the motion may change of a torque that does not act, and noise make of one
_ABOUT = 0.1


def quantity(segment: Segment, signals: Array, variable: str) -> Array:
    """A measured quantity along a segment, shape (n,)."""
    if variable in VARIABLES:
        return signals[:, VARIABLES[variable]]
    return segment.others[variable]


@dataclass(frozen=True)
class SmoothTerm(Term):
    """Common base of all unnamed terms: a dependence on a variable."""

    variable: str

    @property
    def name(self) -> str:
        return self.variable

    def says(self, coefficients: Array, unit: str) -> str:
        """A possible cause, in a sentence, from coefficients in a unit of torque; empty: none."""
        return ""


@dataclass(frozen=True)
class SplineTerm(SmoothTerm):
    """A cubic spline in a quantity, alone or times the direction of friction."""

    # range of the knots; the curve is constant outside
    low: float
    high: float
    odd: bool = False  # multiplied by H, the direction of friction
    # of the columns over the logs, subtracted. A constant is a bias, a named effect, and a curve
    # that contained it would beat every other effect. A part linear in the load is a gain, in the
    # velocity viscous friction: a curve that contained it would leave both undetermined, and their
    # difference would be a bias wherever the mean is not zero.
    means: tuple[float, ...] = ()
    slopes: tuple[float, ...] = ()
    pieces: int = 5

    @property
    def follows_law(self) -> bool:
        """An odd curve is multiplied by the direction of friction."""
        return self.odd

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Spline coefficients, without a constant."""
        return tuple(f"b{i}" for i in range(self.pieces + 2))

    def columns(self, segment: Segment, signals: Array) -> Array:
        x = quantity(segment, signals, self.variable)
        out = self._basis(x)
        if self.means:
            out = out - np.array(self.means)
        if self.slopes:
            out = out - x[:, None] * np.array(self.slopes)
        return out * signals[:, [H]] if self.odd else out

    def _basis(self, x: Array) -> Array:
        """Cubic B-splines of uniform knots at x without the last: all sum to 1, (n, pieces + 2)."""
        at = np.clip((x - self.low) / (self.high - self.low), 0.0, 1.0) * self.pieces
        piece = np.minimum(at.astype(int), self.pieces - 1)
        t = at - piece
        weights = (
            (1.0 - t) ** 3,
            (3.0 * t - 6.0) * t * t + 4.0,
            ((3.0 - 3.0 * t) * t + 3.0) * t + 1.0,
            t**3,
        )
        out = np.zeros((len(x), self.pieces + 3))
        rows = np.arange(len(x))
        for k, weight in enumerate(weights):
            out[rows, piece + k] = weight / 6.0
        return out[:, :-1]

    def centred(self, segments: Sequence[Segment], signals: Sequence[Array]) -> "SplineTerm":
        """The curve without its mean over the kept samples, and without a slope that the model
        contains; an odd curve has neither."""
        if self.odd:
            return self
        pairs = list(zip(segments, signals, strict=True))
        columns = np.concatenate([self.columns(s, x)[s.mask] for s, x in pairs])
        known = np.ones((len(columns), 1))
        if self.variable in _PROPORTIONAL:
            x = np.concatenate([quantity(s, x, self.variable)[s.mask] for s, x in pairs])
            known = np.column_stack([known, x])
        means, *slopes = np.linalg.lstsq(known, columns, rcond=None)[0].tolist()
        return replace(self, means=tuple(means), slopes=tuple(slopes[0]) if slopes else ())


@dataclass(frozen=True)
class LogTerm(SmoothTerm):
    """A separate friction level for every log, by name and in order, but the first."""

    logs: tuple[str, ...]

    follows_law = True

    @property
    def coefficients(self) -> tuple[str, ...]:
        return tuple(f"level_{i}" for i in range(1, len(self.logs)))

    def columns(self, segment: Segment, signals: Array) -> Array:
        own = [1.0 if segment.name == name else 0.0 for name in self.logs[1:]]
        level: Array = signals[:, [H]] * np.array(own)
        return level


@dataclass(frozen=True)
class TunedTerm(SmoothTerm):
    """A term with one nonlinear number `at` within bounds."""

    at: float
    within: tuple[float, float]

    @property
    def shape(self) -> tuple[float, ...]:
        return (self.at,)

    @property
    def limits(self) -> tuple[tuple[float, float], ...]:
        return (self.within,)

    def with_shape(self, shape: tuple[float, ...]) -> Self:
        return replace(self, at=shape[0])


@dataclass(frozen=True)
class WaveTerm(TunedTerm):
    """A wave in time, at a frequency in Hz, whose phase differs between logs."""

    logs: tuple[str, ...]  # names, in order
    moved: float = 0.0  # fraction of the wave that the motion itself can produce, 0 to 1

    @property
    def coefficients(self) -> tuple[str, ...]:
        return tuple(f"{c}_{i}" for i in range(len(self.logs)) for c in ("sin", "cos"))

    def columns(self, segment: Segment, signals: Array) -> Array:
        angle = 2.0 * np.pi * self.at * signals[:, [TIME]]
        wave = np.hstack([np.sin(angle), np.cos(angle)])
        own = [1.0 if segment.name == name else 0.0 for name in self.logs]
        return np.hstack([wave * x for x in own])

    def says(self, coefficients: Array, unit: str) -> str:
        size = float(np.hypot(coefficients[::2], coefficients[1::2]).max())
        torque = f"A torque of up to {size:.2g} {unit} comes and goes at {self.at:.3g} Hz"
        # a wave that follows time this well may come from the motion
        if self.moved > 0.1:
            return (
                f"{torque}. The joint also moves at that frequency, so these logs do not show "
                "whether the torque depends on time or on the motion."
            )
        return f"{torque}, whatever the motion: something outside the joint causes it."


@dataclass(frozen=True)
class HysteresisTerm(SmoothTerm):
    """Additional hysteresis in position: elastic-plastic elements."""

    reaches: tuple[float, ...]  # displacements at which they slip, rad

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Level of each element."""
        return tuple(f"level_{i}" for i in range(len(self.reaches)))

    def columns(self, segment: Segment, signals: Array) -> Array:
        return elastic_plastic(signals[:, Q], np.array(self.reaches))

    def says(self, coefficients: Array, unit: str) -> str:
        """That the displacement since a reversal counts, not the place, in a sentence."""
        size = float(np.abs(coefficients).max())
        return (
            f"A torque of up to {size:.2g} {unit} builds up after each reversal, over a "
            "displacement and not at a place: hysteresis that the friction law lacks."
        )


def elastic_plastic(q: Array, reaches: Array) -> Array:
    """Torque of elastic-plastic elements of level 1 along a motion, shape (n, k)."""
    out = np.zeros((len(q), len(reaches)))
    _fill_elastic_plastic(np.ascontiguousarray(q), reaches, out)
    return out


@compiled
def _fill_elastic_plastic(q: Vector, reaches: Vector, out: Array) -> None:
    for j in range(len(reaches)):
        z = 0.0
        for i in range(1, len(q)):
            z = min(1.0, max(-1.0, z + (q[i] - q[i - 1]) / reaches[j]))
            out[i, j] = z


@dataclass(frozen=True)
class ExcessTerm(TunedTerm):
    """Logged torque beyond a level, N m (N), which was commanded and may not have been delivered;
    `within` are levels that are exceeded, but not always."""

    # a saturated drive delivers nothing of the torque beyond its level
    coefficients = ("fraction",)
    bounds = ((1.0 - _ABOUT, 1.0 + _ABOUT),)

    def columns(self, segment: Segment, signals: Array) -> Array:
        torque = segment.drive[:, None]
        return np.asarray(torque - np.clip(torque, -self.at, self.at))

    def shows(self, segments: Sequence[Segment], motion_hz: float) -> bool:
        """Whether it can be distinguished from torque noise, which exceeds a level too, and from
        torque that an end of the joint's range absorbs without motion; `motion_hz` is the corner of
        the filter that the torque passed."""
        noise, squares, pressing = 0.0, 0.0, 0.0
        q = [s.signals[s.mask, Q] for s in segments]
        whole = np.concatenate(q)
        low, high = whole.min(), whole.max()
        # a joint presses against a hard end within 2% of its range; this may account for half of
        # the excess. A softer end yields as an end stop does, and a saturated drive does not.
        end = 0.02 * (high - low)
        for s, x in zip(segments, q, strict=True):
            excess = self.columns(s, s.signals)[s.mask, 0]
            noise += s.noise.torque * min(motion_hz, 0.5 / s.dt) * np.count_nonzero(excess)
            squares += float(np.sum(excess**2))
            outward = np.where(excess > 0.0, x > high - end, x < low + end)
            pressing += float(np.sum(excess[outward] ** 2))
        return noise < _ABOUT * squares and pressing < 0.5 * squares

    def says(self, coefficients: Array, unit: str) -> str:
        whole = coefficients[0] >= 1.0 - 0.5 * _ABOUT
        missing = "all of it" if whole else f"{coefficients[0]:.0%}"
        return (
            f"Of the torque logged beyond {self.at:.3g} {unit}, {missing} failed to act: a drive "
            "saturates, and the log contains the command. The final fit uses the torque that acted."
        )


# a level beyond which torque did not act, and which fraction of it
NotGiven = tuple[ExcessTerm, float]


def as_delivered(prepared: Prepared, not_given: Sequence[NotGiven]) -> Prepared:
    """Logs with the torque that was delivered."""
    logs = list(prepared.segments)
    for term, fraction in not_given:
        excess = [term.columns(s, s.signals)[:, 0] for s in logs]
        pairs = zip(logs, excess, strict=True)
        logs = [replace(s, drive=s.drive - fraction * x) for s, x in pairs]
    return replace(prepared, segments=tuple(logs))


@dataclass(frozen=True)
class MissingTerm(SmoothTerm):
    """Mean torque that a saturated sensor does not measure."""

    # the negative of the missing torque: the true one is never smaller than the logged one
    coefficients = ("missing",)
    bounds = ((-np.inf, 0.0),)

    def columns(self, segment: Segment, signals: Array) -> Array:
        where = segment.saturated
        return np.zeros((len(signals), 1)) if where is None else where[:, None]

    def says(self, coefficients: Array, unit: str) -> str:
        return (
            f"Where the logged torque is at its largest value, {-coefficients[0]:.2g} {unit} more "
            "acted on average: the sensor or the recorder saturates. The final fit ignores these "
            "samples. Record with a wider range or a slower motion."
        )


@dataclass(frozen=True)
class EncoderTerm(SmoothTerm):
    """A position error that is a wave of the position: an eccentric encoder disc or shaft.

    With q = measured - d(measured), d = a sin(N q) + b cos(N q), the balance is wrong by its change
    along d: in acceleration, gravity and viscous friction, with one d in all of them.
    """

    order: float  # N, waves per turn
    inertia: float  # N m s^2/rad
    arms: tuple[float, float]  # of gravity, kg m, see signals
    viscosity: float  # N m s/rad
    # amplitudes of the two waves, rad
    coefficients = ("sin", "cos")

    def columns(self, segment: Segment, signals: Array) -> Array:
        N, v = self.order, signals[:, [V]]
        angle = N * signals[:, [Q]]
        wave = np.hstack([np.sin(angle), np.cos(angle)])
        rate = N * np.hstack([np.cos(angle), -np.sin(angle)])
        # about the joint's axis the first arm turns into the second
        turned = self.arms[0] * signals[:, [GY]] - self.arms[1] * signals[:, [GX]]
        acceleration = rate * signals[:, [A]] - N * N * wave * v**2
        along = self.inertia * acceleration + turned * wave + self.viscosity * rate * v
        return np.asarray(along)

    def says(self, coefficients: Array, unit: str) -> str:
        return (
            f"The logged position seems off by up to {np.hypot(*coefficients):.2g} rad, "
            f"{self.order:g} per turn: check whether the encoder or the shaft is off its centre."
        )
