"""Measurement artefacts: torque that was not delivered, sensor saturation, encoder eccentricity.

Like the terms of `smooth`, they are quantities on which a residual depends. They are not simulated,
because the log is wrong and not the model.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import GX, GY, A, Q, V
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.smooth import SmoothTerm, TunedTerm

# what the filter of the motion may change of a torque that does not act, and noise make of one
_ABOUT = 0.1


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
