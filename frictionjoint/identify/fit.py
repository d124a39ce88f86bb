"""A fitted model: the result of a search over a friction law and terms."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.decisions import CLEARLY
from frictionjoint.effects.signals import GEAR, inertia_of
from frictionjoint.identify.basis import lengths, without
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.segment import LEAST_LEVEL, Drive, Prepared
from frictionjoint.identify.shape import ENDLESS, LENGTHS, Shape
from frictionjoint.identify.terms import SHARES, Term, Timing

# squared weight from which on a sample counts as in motion
IN_MOTION = 0.5


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted model."""

    shape: Shape
    terms: tuple[Term, ...]
    drive: Drive
    beta: Array  # linear coefficients, one per column, in the drive's units (see `gain`)
    gain: float  # torque per unit of drive; 1 for a measured torque
    layout: Layout
    residual: Array  # drive minus model times gain, N m, kept samples of all logs, shape (n,)
    jacobian: Array  # of the model in N m by every parameter, linear ones first, shape (n, p)
    weight: Array  # of each sample, shape (n,)
    bound: NDArray[np.bool_]  # which parameters are on a bound of their range, shape (p,)
    # range of each linear coefficient; for a shape number, by how much one search may change it
    low: Array
    high: Array
    log_index: NDArray[np.int64]  # log of each sample, shape (n,)
    # columns of other possible initial states of each log, N m, shape (n, m), which belong to no
    # parameter of the model; empty if the model has no free oscillation
    begun: Array
    target_rms: float  # of the measured torque
    # whether all in N m is in units of the drive, because the logs do not determine the gain
    in_drive_units: bool = False
    # weighted rms of the drive, relative to that before effects of the drive changed it
    acting: float = 1.0
    # torque per small error of position, of the drive and the load, relative to that before effects
    # changed them; geometric mean. 1 for a measured drive
    holding: float = 1.0
    commanded: bool = False  # whether a controller computes the drive from commands

    @property
    def over_kp(self) -> bool:
        """Whether the drive is a controller's torque divided by its unknown kp, an error of
        position, which a fit treats like a current: as a torque of unknown gain."""
        return self.commanded and self.drive == "current"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the linear columns."""
        return self.layout.names[self.layout.linear]

    @property
    def effects(self) -> tuple[Term, ...]:
        """The terms without the timing of the logs."""
        return tuple(t for t in self.terms if not isinstance(t, Timing))

    @property
    def rms(self) -> float:
        """rms of the residual, N m."""
        return root_mean_square(self.residual)

    @property
    def in_motion(self) -> NDArray[np.bool_]:
        """Samples whose torque the position determines, shape (n,)."""
        return np.asarray(self.weight**2 > IN_MOTION)

    @property
    def rms_in_motion(self) -> float:
        """rms of the residual over the samples in motion, N m, used to compare laws."""
        return root_mean_square(self.residual[self.in_motion])

    def clearly_better(self, other: "Fit") -> bool:
        """Whether the residual is clearly smaller than another fit's."""
        return self.drive_rms < (1.0 - CLEARLY) * other.drive_rms

    @property
    def scale(self) -> float:
        """Torque per unit of the minimised error; with an open gain, the acting drive counts."""
        return self.gain if self.drive == "torque" else self.gain * self.acting

    @property
    def error_unit(self) -> float:
        """Torque per unit of error for comparing models.

        A log with a target shows the motion that resulted. A residual torque represents the
        position error that requires this torque: the likelihood of the motion contains the
        determinant of this map in addition to the residual torques. Without this factor, a drive
        with little effect, and so with little residual, would explain any motion.
        """
        return self.gain * self.holding

    @property
    def drive_rms(self) -> float:
        """rms of the weighted residual, in `error_unit`."""
        return root_mean_square(self.residual * self.weight) / self.error_unit

    @cached_property
    def open(self) -> NDArray[np.bool_]:
        """Parameters that can change in both directions, shape (p,).

        A time offset at the end of its range cannot, because it is no longer a sampling offset. The
        residual must also change with the parameter within the range of one search: the parameters
        of a law without a friction level change almost nothing.
        """
        reach = np.maximum(np.abs(self.low), np.abs(self.high))
        size = np.linalg.norm(self.jacobian * self.weight[:, None], axis=0)
        moves = np.zeros(len(size))
        np.multiply(size, reach, out=moves, where=size > 0.0)
        # a parameter with less influence than this fraction of the residual has none
        found = moves > 1e-3 * float(np.linalg.norm(self.residual * self.weight))
        found &= ~self.bound
        for i, term in enumerate(self.terms):
            if isinstance(term, Timing):
                found[self.layout.numbers(i)] &= not term.at_its_end
        return np.asarray(found)

    @property
    def free_jacobian(self) -> Array:
        """Columns of the parameters that can change in both directions, shape (n, free)."""
        return self.layout.with_load(self.jacobian)[:, self.open]

    @property
    def friction(self) -> Array:
        """Torque of the law alone, N m, shape (n,)."""
        return np.asarray(self.jacobian[:, self.of_law] @ self.beta[self.of_law])

    @property
    def of_law(self) -> list[int]:
        """Indices of the linear columns of the law."""
        return [self.names.index(n) for n in ("Fc", "sigma1", "sigma2") if n in self.names]

    def coefficient(self, name: str) -> float:
        """A linear coefficient in N m per unit of its column; 0 where the fit has none."""
        return float(self.beta[self.names.index(name)] * self.gain) if name in self.names else 0.0

    @property
    def levels(self) -> tuple[float, float]:
        """Fc, and sigma2 or 0 where the fit has none, N m and N m s/rad."""
        return self.coefficient("Fc"), self.coefficient("sigma2")

    @property
    def ended(self) -> int:
        """How many of the law's numbers are at an end of a range that only bounds the search."""
        at = zip(self.layout.names, self.bound.tolist(), strict=True)
        ends = {name.removeprefix("law."): bool(is_at) for name, is_at in at}
        # without a Stribeck effect its velocity and exponent have no influence
        return sum(ends.get(n, False) for n in (LENGTHS if ends.get("excess") else ENDLESS))

    @property
    def has_level(self) -> bool:
        """Whether the logs show a Coulomb level; if not, the level is at its bound."""
        return float(self.beta[self.names.index("Fc")]) > 2.0 * LEAST_LEVEL

    @property
    def level_assumed(self) -> bool:
        """Whether the Coulomb level is assumed, see `assumptions.with_assumed_level`."""
        return self.has_level and bool(self.bound[self.names.index("Fc")])

    def term_coefficients(self, i: int) -> Array:
        """Coefficients of term i in N m per unit of their columns."""
        return self.beta[self.layout.coefficients(i)] * self.gain

    def term_torque(self, i: int) -> Array:
        """Torque of term i, N m, shape (n,)."""
        at = self.layout.coefficients(i)
        return np.asarray(self.jacobian[:, at] @ self.beta[at])


def with_gain(fitted: Fit, gain: float) -> Fit:
    """The same fit with a drive gain that another fit has determined."""
    factor = gain / fitted.gain
    return replace(
        fitted,
        gain=gain,
        residual=fitted.residual * factor,
        jacobian=fitted.jacobian * factor,
        target_rms=fitted.target_rms * factor,
    )


def without_scale(fitted: Fit) -> Fit:
    """The same fit stated in units of its drive, for logs that do not determine the gain."""
    return replace(with_gain(fitted, 1.0), in_drive_units=True)


def unreached(fitted: Fit) -> Array:
    """First-order estimate of the part of each squared residual that a fit could still remove.

    A search that stops before a minimum has already tried the first-order step without success, so
    the residual of the fit is valid, not the smaller first-order value. (N m)^2, shape (n,).
    """
    w = fitted.weight
    left = fitted.residual * w
    free = fitted.free_jacobian * w[:, None]
    return np.asarray(left**2 - without(left, free / lengths(free)) ** 2)


def implied_share(prepared: Prepared, fitted: Fit, i: int) -> float:
    """Share of the inertia that a fit puts behind the spring of term i.

    A model that combines motor and link has one inertia. A rotor is balanced, so gravity acts on
    the link alone. At a given resonance the link sags more if its inertia is smaller.
    """
    whole = float(np.median([inertia_of(s.signals, GEAR) for s in prepared.segments]))
    (behind,) = fitted.term_coefficients(i)
    return float(np.clip(behind / whole, *SHARES)) if whole > 0.0 and behind > 0.0 else 1.0
