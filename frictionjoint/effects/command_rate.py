"""command-rate: firmware that limits the speed of its target."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import SLEW
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape

# initial limits relative to the joint's fastest motion. With a limit far above the right one the
# gradient vanishes, so there must be a start slightly above it
_FRACTIONS = tuple(np.geomspace(0.4, 1.8, 10))


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The controller block with a target of limited speed."""
    block[SLEW] = min(block[SLEW], shape[0])
    return block, delay


def figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    return {"target_rate": shape[0]}


def _rates(logs: Sequence[Commands]) -> list[Shape]:
    fastest = max(float(np.quantile(np.abs(x.velocity), 0.999)) for x in logs)
    return [(float(fraction * fastest),) for fraction in _FRACTIONS if fastest > 0.0]


EFFECT = Effect(
    name="command-rate",
    title="speed limit of the target",
    effect_id=0,
    coefficients=(),
    units=(),
    cause="a motion profile in the firmware, with a largest speed",
    form="u of a target that moves towards the commanded one at most at `rate`",
    source="goal speed and acceleration registers of servos (Feetech STS, Dynamixel profile "
    "velocity)",
    signature="after a step of the target the output rises steadily, more slowly at a lower kp",
    separating_motion="steps of the target at two gains",
    entry="acts on the drive",
    shape=("rate",),
    shape_units=("x/s",),
    shape_bounds=((0.0, float("inf")),),
    drive=changed,
    controller=figures,
    drive_shapes=_rates,
)
