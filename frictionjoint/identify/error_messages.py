"""Error messages for logs inconsistent with the model: what is wrong, where, and the fix."""

from typing import NamedTuple

from frictionjoint.identify.segment import Prepared

_MEASURED = {"voltage": "voltage_v", "current": "current_a"}


class _Columns(NamedTuple):
    """Names and units of the columns of the position and of the drive; `what` is the drive, or the
    target if a controller computes the drive, and `rest` are further checks for the message."""

    position: str
    position_unit: str
    drive: str
    drive_unit: str
    what: str
    rest: str = ""


def friction_drives(prepared: Prepared, name: str, errors: float) -> str:
    """Message: friction would drive the joint, by this number of standard errors."""
    return _wrong_sign(
        prepared, name, f"friction would drive the joint ({errors:.0f} standard errors)"
    )


def reversed_load(prepared: Prepared, gravity: float, inertia: float) -> str:
    """Message: gravity and inertia of the model appear in the drive with these negative factors."""
    why = (
        f"the drive matches the model with opposite sign (gravity x {gravity:.3g}, inertia x "
        f"{inertia:.3g})"
    )
    return _wrong_sign(prepared, prepared.names, why)


def _wrong_sign(prepared: Prepared, name: str, why: str) -> str:
    c = _columns(prepared)
    wrong = "wrong sign, gain or feed_forward" if prepared.commanded else "wrong sign"
    exchanged = f", that the two are not exchanged{c.rest}" if prepared.commanded else ""
    return (
        f"{name}: {wrong} of position or {c.what}: {why}: check the signs of {c.position} and "
        f"{c.drive}, both positive along the joint's axis in the MJCF{exchanged}, and their clocks"
    )


def too_large(prepared: Prepared, factor: float) -> str:
    """Message: the torque is this many times the load of the model, in gravity and in inertia."""
    c = _columns(prepared)
    torque, check = f"measured {c.what}", f"the unit of {c.drive} (N mm, mN m, N cm?)"
    if prepared.commanded:
        torque, check = "torque of the controller", "its gains (per rad, not per degree?)"
    return (
        f"{prepared.names}: the {torque} is {factor:.3g} times the load of the model: check "
        f"{check} and the masses in the MJCF"
    )


def unexplained(prepared: Prepared, left: float, hint: str) -> str:
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
