"""drive-limit: a duty, voltage or torque that the controller does not exceed."""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.kernel import LIMIT, SUPPLY
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The controller block with a lower limit."""
    block[LIMIT] = min(block[LIMIT], shape[0])
    return block, delay


def _limits(logs: Sequence[Commands]) -> list[Shape]:
    most = max(float(np.abs(x.drive() / x.supply).max() / x.block[SUPPLY]) for x in logs)
    return [(fraction * most,) for fraction in (0.15, 0.3, 0.45, 0.6, 0.75, 0.9) if most > 0.0]


EFFECT = Effect(
    name="drive-limit",
    title="limit of the drive",
    cause="a current, torque or duty limit in the firmware",
    form="|u| <= limit, u in the unit of the controller's output",
    source="goal PWM and torque limit registers of servos",
    signature="at large position errors the output stays at one value",
    separating_motion="steps of the target of several sizes",
    entry="acts on the drive",
    shape=("limit",),
    shape_units=("output",),
    shape_bounds=((0.0, float("inf")),),
    drive=changed,
    controller=lambda controller, shape: {"limit": shape[0]},
    drive_shapes=_limits,
)
