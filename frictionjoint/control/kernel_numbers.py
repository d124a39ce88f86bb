"""The numbers of a controller for one log, in the order of `kernel`."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control import kernel as k
from frictionjoint.control.controller import LOG, UNKNOWN, Controller, Value, without_unknowns
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog


def block_of(controller: Controller, log: JointLog) -> Array:
    """Block of a log, shape (BLOCK,).

    An unknown kp counts as 1, so the drive is the error in rad. An unknown supply counts as 1, so
    the drive is the duty.

    Raises:
        LogError: a log lacks a number that the controller reads from it.
    """
    c = without_unknowns(controller)

    def value(name: str, instead: float) -> float:
        return _value(getattr(c, name), name, log, instead)

    B = np.zeros(k.BLOCK)
    B[k.KP] = value("kp", 1.0 / c.gain_unit) * c.gain_unit
    B[k.KI] = value("ki", 0.0) * c.gain_unit
    B[k.KD] = value("kd", 0.0) * c.gain_unit
    B[k.KFF] = c.feed_forward
    B[k.SUPPLY] = value("supply_v", 1.0) if c.output == "duty" else 1.0
    # the limit of an output in another unit is not known
    B[k.LIMIT] = np.inf if c.kp == UNKNOWN else value("limit", np.inf)
    B[k.DEADBAND] = value("deadband", 0.0)
    B[k.SHIFTED] = c.deadband_form == "shifted"
    B[k.PERIOD] = 1.0 / c.rate_hz if c.rate_hz else 0.0
    B[k.COUNT] = c.count_rad
    B[k.DIFFERENTIATED] = c.velocity == "differentiated"
    B[k.DROP_ERROR] = value("drop_above", np.inf) if c.drop_of == "error" else np.inf
    B[k.DROP_OUTPUT] = value("drop_above", np.inf) if c.drop_of == "output" else np.inf
    B[k.DROP_LEFT] = c.drop_left
    B[k.SAG], B[k.SAG_EMF] = value("sag", 0.0), c.sag_emf
    B[k.SLEW] = value("target_rate", np.inf)
    return B


def delay_of(controller: Controller) -> float:
    """Time from a target to the tick that uses it, s; an unknown delay counts as 0."""
    return 0.0 if isinstance(controller.delay_s, str) else float(controller.delay_s)


def supply_of(controller: Controller, log: JointLog) -> Array:
    """The log's supply voltage relative to that of its block, shape (n,); ones if not logged."""
    if controller.output != "duty" or log.supply is None:
        return np.ones_like(log.time)
    return np.asarray(log.supply / block_of(controller, log)[k.SUPPLY])


def _value(value: Value | None, name: str, log: JointLog, unknown: float) -> float:
    if value is None or value == UNKNOWN:
        return unknown
    if not isinstance(value, str):
        return float(value)
    key = value.removeprefix(LOG)
    if key not in log.metadata:
        if name == "supply_v" and log.supply is not None:
            return float(np.median(log.supply))
        raise LogError(
            f"{log.name}: the controller takes {name} from the log, which has no {key!r}: add a "
            f"column {key!r} with one number, or give a controller file with {name} as a number"
        )
    return float(log.metadata[key])
