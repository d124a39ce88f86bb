"""The numbers of a controller for one log, in the order of `kernel`."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control import kernel as k
from frictionjoint.control.controller import LOG, UNKNOWN, Controller
from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog


def block_of(controller: Controller, log: JointLog) -> Array:
    """Block of a controller along a log, shape (BLOCK,).

    An unknown kp counts as 1, so the drive is the error in rad. An unknown supply counts as 1, so
    the drive is the duty. What else is unknown is left out.

    Raises:
        LogError: a log lacks a number that the controller reads from it.
    """

    def value(name: str, unknown: float) -> float:
        given = getattr(controller, name)
        if given is None or given == UNKNOWN:
            return unknown
        if not isinstance(given, str):
            return float(given)
        key = given.removeprefix(LOG)
        if key in log.metadata:
            return float(log.metadata[key])
        if name == "supply_v" and log.supply is not None:
            return float(np.median(log.supply))
        raise LogError(
            f"{log.name}: the controller takes {name} from the log, which has no {key!r}: add a "
            f"column {key!r} with one number, or give a controller file with {name} as a number"
        )

    B = np.zeros(k.BLOCK)
    B[k.KP] = value("kp", 1.0 / controller.gain_unit) * controller.gain_unit
    B[k.KI] = value("ki", 0.0) * controller.gain_unit
    B[k.KD] = value("kd", 0.0) * controller.gain_unit
    B[k.KFF] = controller.feed_forward
    B[k.SUPPLY] = value("supply_v", 1.0) if controller.output == "duty" else 1.0
    # the limit of an output in another unit is not known
    B[k.LIMIT] = np.inf if controller.kp == UNKNOWN else value("limit", np.inf)
    B[k.DEADBAND] = value("deadband", 0.0)
    B[k.SHIFTED] = controller.deadband_form == "shifted"
    B[k.PERIOD] = 1.0 / controller.rate_hz if controller.rate_hz else 0.0
    B[k.COUNT] = controller.count_rad
    B[k.DIFFERENTIATED] = controller.velocity == "differentiated"
    B[k.DROP_ERROR] = value("drop_above", np.inf) if controller.drop_of == "error" else np.inf
    B[k.DROP_OUTPUT] = value("drop_above", np.inf) if controller.drop_of == "output" else np.inf
    B[k.DROP_LEFT] = controller.drop_left
    B[k.SAG], B[k.SAG_EMF] = value("sag", 0.0), controller.sag_emf
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
