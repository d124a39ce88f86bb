"""Early checks whether logs can belong to the model: signs, units and clocks.

A fit adapts to nearly anything: it finds friction that drives, or a gain of a thousand. Here a
linear torque balance is solved, in a fraction of a second:

    torque = load + friction + viscosity * v + residual

* **Signs.** A sign is wrong if friction would supply power, or if gravity and inertia both have the
  opposite sign, as in a torque that was measured behind the friction.
* **Units, clocks, another joint's columns.** The load of the model and friction of any level must
  explain some of the torque.
* **Units too large.** Friction may be large, but gravity and inertia in the torque are not both the
  same large multiple of the model's.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from frictionjoint.arrays import Array, Index, root_mean_square
from frictionjoint.effects.signals import GX, GY, LOAD, A, Q, V
from frictionjoint.errors import LogError
from frictionjoint.identify.basis import lengths, pseudo_inverse
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.law_basis import plain_friction, top_speed
from frictionjoint.identify.segment import Prepared

# Largest part of the torque's rms that a model may leave: a tenth of the mean square is explained
# then. Good logs leave 0.88 at most, noise leaves 0.96 at least.
MOST_LEFT = 0.95
# Standard errors from which on a sign is wrong; good logs are on the right side of zero.
SURE = 5.0
# Blocks of the samples that count as independent.
_BLOCKS = 30
_MEASURED = {"voltage": "voltage_v", "current": "current_a"}


class Balance(NamedTuple):
    """Columns of the linear balance on the kept samples of all logs, shape (n,) or (n, k) each."""

    drive: Array  # measured torque, or current or voltage
    load: Array  # of the model, N m
    gravity: Array  # of 1 kg at 1 m, N m, shape (n, 2)
    q: Array
    v: Array
    a: Array
    jerk: Array
    side: Array  # sign of the velocity, without a step
    elements: Array  # torque of elastic-plastic elements of level 1, shape (n, k)
    log: Index  # index of the log
    block: Index  # of the samples that count as one

    @property
    def one(self) -> Array:
        """A constant torque."""
        return np.ones(len(self.drive))

    def of_log(self, i: int) -> "Balance":
        """The samples of one log, divided into the same number of blocks as all logs together."""
        own = self.log == i
        part = Balance._make(x[own] for x in self)
        return part._replace(block=_blocks(len(part.drive)))


def check_signs(prepared: Prepared) -> None:
    """Check that friction takes power from the joint, and that gravity and inertia are not
    reversed, whatever else the model lacks; LogError: a sign is wrong."""
    balance = _balance(prepared)
    _check_signs(prepared, balance, *_load_factors(balance))


def check(prepared: Prepared) -> None:
    """Check before any fit that the drive of logs can be that of the model's joint along their
    motion; LogError: a sign is wrong, the model explains next to nothing, a unit is too large."""
    balance = _balance(prepared)
    if not balance.drive.any():
        raise LogError(f"{prepared.names}: the {prepared.drive} is zero: check its column")
    factors, errors = _load_factors(balance)
    _check_signs(prepared, balance, factors, errors)
    left = _left(balance, prepared.gain_unknown)
    if left > MOST_LEFT:
        raise LogError(_unexplained(prepared, left, _hint(prepared, balance)))
    # A unit is wrong if gravity and inertia are both ten times the model's or more, and agree
    # within a factor of two. One alone may be too small in a model, without the gripper of a wrist
    # or the inertia of its motor.
    alike = factors.max() < 2.0 * factors.min()
    if not prepared.gain_unknown and np.min(factors - SURE * errors) > 10.0 and alike:
        raise LogError(_too_large(prepared, float(factors.mean())))


def unexplained_fraction(prepared: Prepared) -> float:
    """Fraction of the drive's rms that the model's load and friction of any level leave."""
    return _left(_balance(prepared), prepared.gain_unknown)


def check_fit(prepared: Prepared, fitted: Fit) -> None:
    """Raise LogError if a fit explains hardly any torque, because its parameters mean nothing."""
    left = fitted.rms / fitted.target_rms if fitted.target_rms else np.inf
    if left > MOST_LEFT:
        raise LogError(_unexplained(prepared, left, ""))


def scale_is_determined(prepared: Prepared, fitted: Fit) -> bool:
    """Whether friction is known in N m (N), and not only in amperes or volts.

    If the torque was not measured, the load of the model determines the torque per current. This
    requires that the part of the load torque that no other parameter can explain exceeds the
    residual of the fit, because the residual may be correlated with the load.
    """
    if not prepared.gain_unknown:
        return True
    if not load_shows(fitted):
        return False
    # the first column is that of the load
    columns, per_torque = fitted.free_jacobian, float(fitted.beta[0])
    load, others = columns[:, 0], np.delete(columns, 0, axis=1)
    alone = load - others @ _solved(others, load)
    if root_mean_square(alone * per_torque) <= fitted.rms:
        return False
    error = _errors(alone[:, None], fitted.residual, _blocks(len(alone)))[0, 0]
    return bool(per_torque**2 > SURE**2 * error)


def load_shows(fitted: Fit) -> bool:
    """Whether a fit finds the load of the model in the drive; True for a measured torque."""
    return "load" not in fitted.names or not fitted.bound[fitted.names.index("load")]


def _check_signs(prepared: Prepared, balance: Balance, factors: Array, errors: Array) -> None:
    """Check the signs of the load and of friction, in every log and in all together.

    The balance of one log may be wrong by more than its standard errors, for example if gravity and
    inertia of a free oscillation cancel. So the balance of the other logs must agree that the sign
    is wrong.
    """
    if prepared.gain_unknown:
        _check_drive_changes(prepared)
    if np.max(factors + SURE * errors) < 0.0:
        gravity, inertia = factors
        why = (
            f"the drive matches the model with opposite sign (gravity x {gravity:.3g}, inertia x "
            f"{inertia:.3g})"
        )
        raise LogError(_wrong_sign(prepared, prepared.names, why))
    # in one direction a bias or an error of gravity looks like friction of either sign
    logs = [(prepared.names, balance, _both_ways(balance))]
    if len(prepared) > 1:
        for i, s in enumerate(prepared.segments):
            logs.append((s.name, balance.of_log(i), _turned(balance, i)))
    for name, part, turned in logs:
        power, error, free = _friction_power(part)
        # Signs mean something if the balance with free signs explains some of the drive; a wrong
        # sign is considered only if the right signs leave much of it.
        wrong = turned and power < -SURE * error and free < 0.8
        if wrong and _left(part, prepared.gain_unknown) > 0.3:
            why = f"friction would drive the joint ({-power / error:.0f} standard errors)"
            raise LogError(_wrong_sign(prepared, name, why))


def _check_drive_changes(prepared: Prepared) -> None:
    """Reject a drive of constant magnitude and unknown scale, which looks like a friction level."""
    drive = np.concatenate([s.drive for s in prepared.segments])
    v = np.concatenate([s.signals[:, V] for s in prepared.segments])
    # Above a tenth of the top speed, and outside reversals (a fifth of the samples), the magnitude
    # must change by more than 0.1%.
    along = (drive * np.sign(v))[np.abs(v) > 0.1 * np.max(np.abs(v))]
    size = float(np.median(along)) if len(along) else 0.0
    # around a reversal a resampled drive has other values
    if size > 0.0 and np.mean(np.abs(along - size) > 1e-3 * size) < 0.2:
        raise LogError(
            f"{prepared.names}: the {prepared.drive} has the same magnitude, {size:.4g}, "
            "throughout: friction of that level would explain any speed: record a drive that "
            "changes"
        )


def _turned(b: Balance, i: int) -> bool:
    """Whether the i-th log's torque has the opposite sign to a prediction from all other logs."""
    own = b.log == i
    X = _free(b)
    beta, _ = _regression(X[~own], b.drive[~own], b.block[~own])
    return float(b.drive[own] @ (X[own] @ beta)) < 0.0


def _free(b: Balance) -> Array:
    """Columns of a balance with free signs, shape (n, k); the first two are friction's.

    The others are the load and its possible errors, gravity, a spring, a bias, and a delay of the
    inertial torque, which looks like viscosity. Without motion in both directions a bias cannot be
    distinguished from friction and counts as friction.
    """
    bias = [b.one] if _both_ways(b) else []
    return np.column_stack([b.side, b.v, b.load, b.a, b.jerk, b.gravity, b.q, *bias])


def _both_ways(b: Balance) -> bool:
    """Whether 2% of the samples move in the rarer direction."""
    return min(float(np.mean(b.side > 0.0)), float(np.mean(b.side < 0.0))) > 0.02


def _friction_power(b: Balance) -> tuple[float, float, float]:
    """Mean power of friction, its standard error, and the residual over the drive's rms."""
    X = _free(b)
    beta, cov = _regression(X, b.drive, b.block)
    each = np.zeros(X.shape[1])
    each[:2] = np.mean(b.side * b.v), np.mean(b.v**2)
    left = root_mean_square(b.drive - X @ beta) / (root_mean_square(b.drive) or 1.0)
    return float(each @ beta), float(np.sqrt(each @ cov @ each)), left


def _left(b: Balance, gain_unknown: bool) -> float:
    """Residual of the model's load and friction of any level, as a fraction of the drive's rms."""
    friction = np.column_stack([b.elements, b.side, b.v])
    X = np.column_stack([b.load, friction]) if gain_unknown else friction
    target = b.drive if gain_unknown else b.drive - b.load
    size = lengths(X)
    return float(nnls(X / size, target)[1] / np.linalg.norm(b.drive))


def _load_factors(b: Balance) -> tuple[Array, Array]:
    """Factors of the model's gravity and inertia in the drive, and their errors, shape (2,) each,
    from a balance that also contains friction and a constant torque; 0 without an error for a
    missing one, such as gravity about a vertical axis."""
    gravity = b.gravity @ _solved(np.column_stack([b.a, b.gravity]), b.load)[1:]
    X = np.column_stack([gravity, b.load - gravity, b.one, b.side, b.v])
    beta, cov = _regression(X, b.drive, b.block)
    return beta[:2], np.sqrt(np.diag(cov)[:2])


def _hint(prepared: Prepared, b: Balance) -> str:
    """Ratio of a too small torque to the load, if the logs show it."""
    if prepared.gain_unknown:
        return ""
    X = np.column_stack([b.load, b.one, b.side, b.v])
    beta, cov = _regression(X, b.drive, b.block)
    factor, error = float(beta[0]), float(np.sqrt(cov[0, 0]))
    if abs(factor) < SURE * error or 0.5 < factor < 2.0:
        return ""
    return f", which is {factor:.2g} times the load of the model"


def _balance(prepared: Prepared) -> Balance:
    thin = prepared.thinned(6000)
    top = top_speed(thin.segments)
    rows = []
    for s in thin.segments:
        known = s.signals[:, [LOAD, GX, GY, Q, V, A]]
        jerk = np.gradient(s.signals[:, A], s.dt)
        rows.append(s.balanced(np.column_stack([s.drive, known, jerk, plain_friction(s, top)])))
    sizes = [len(row) for row in rows]
    drive, load, gx, gy, q, v, a, jerk, side, *elements = np.concatenate(rows).T
    gravity, friction = np.column_stack([gx, gy]), np.column_stack(elements)
    log = np.repeat(np.arange(len(sizes)), sizes)
    block = _blocks(len(drive))
    return Balance(drive, load, gravity, q, v, a, jerk, side, friction, log, block)


def _blocks(n: int) -> Index:
    return np.arange(n) * _BLOCKS // max(n, 1)


def _regression(X: Array, y: Array, block: Index) -> tuple[Array, Array]:
    """Least squares, and its covariance if samples within a block are not independent."""
    size = lengths(X)
    Z = X / size
    beta = _solved(Z, y)
    return beta / size, _errors(Z, y - Z @ beta, block) / np.outer(size, size)


def _errors(X: Array, residual: Array, block: Index) -> Array:
    """Covariance of the coefficients of X, by blocks."""
    bread = pseudo_inverse(X.T @ X)
    scores = np.zeros((_BLOCKS, X.shape[1]))
    np.add.at(scores, block, X * residual[:, None])
    return np.asarray(bread @ (scores.T @ scores) @ bread)


def _solved(X: Array, y: Array) -> Array:
    return np.asarray(np.linalg.lstsq(X, y, rcond=1e-6)[0])


class _Columns(NamedTuple):
    """Names and units of the columns of the position and of the drive; `what` is the drive, or the
    target if a controller computes the drive, and `rest` are further checks for the message."""

    position: str
    position_unit: str
    drive: str
    drive_unit: str
    what: str
    rest: str = ""


def _wrong_sign(prepared: Prepared, name: str, why: str) -> str:
    c = _columns(prepared)
    wrong = "wrong sign, gain or feed_forward" if prepared.commanded else "wrong sign"
    exchanged = f", that the two are not exchanged{c.rest}" if prepared.commanded else ""
    return (
        f"{name}: {wrong} of position or {c.what}: {why}: check the signs of {c.position} and "
        f"{c.drive}, both positive along the joint's axis in the MJCF{exchanged}, and their clocks"
    )


def _too_large(prepared: Prepared, factor: float) -> str:
    """Message: the torque is this many times the load of the model, in gravity and in inertia."""
    c = _columns(prepared)
    torque, check = f"measured {c.what}", f"the unit of {c.drive} (N mm, mN m, N cm?)"
    if prepared.commanded:
        torque, check = "torque of the controller", "its gains (per rad, not per degree?)"
    return (
        f"{prepared.names}: the {torque} is {factor:.3g} times the load of the model: check "
        f"{check} and the masses in the MJCF"
    )


def _unexplained(prepared: Prepared, left: float, hint: str) -> str:
    """Message: the model leaves too large a fraction of the drive's rms unexplained; the hint is
    the ratio of the torque to the model's load, as text."""
    c = _columns(prepared)
    units = f"the units of {c.position} ({c.position_unit}) and {c.drive} ({c.drive_unit})"
    return (
        f"{prepared.names}: the residual is {left:.3g} times the {prepared.drive}{hint}: check "
        f"{units}{c.rest}, their signs, their clock, the masses in the MJCF, and that they are of "
        f"joint {prepared.joint!r} of the MJCF"
    )


def _columns(prepared: Prepared) -> _Columns:
    """Our names of the columns, as this log has them."""
    position = ("position_m", "m") if prepared.slide else ("position_rad", "rad, not degrees")
    if prepared.commanded:
        target, per = ("target_m", "m") if prepared.slide else ("target_rad", "rad")
        gains = f", the controller's gains (per {per}) and feed_forward"
        return _Columns(*position, target, position[1], "target", gains)
    if prepared.drive in _MEASURED:
        drive = _MEASURED[prepared.drive], "on one clock with the position"
    elif prepared.slide:
        drive = "force_n", "N"
    else:
        drive = "torque_nm", "N m at the joint, not kN m, mN m or at the motor"
    return _Columns(*position, *drive, prepared.drive)
