"""command-rate: firmware that limits the speed of its target."""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.kernel import SLEW
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The controller block with a target of limited speed."""
    block[SLEW] = min(block[SLEW], shape[0])
    return block, delay


def _rates(logs: Sequence[Commands]) -> list[Shape]:
    fastest = max(float(np.quantile(np.abs(x.velocity), 0.999)) for x in logs)
    # with a limit far above the right one the gradient vanishes: one starts slightly above it
    fractions = np.geomspace(0.4, 1.8, 10)
    return [(float(fraction * fastest),) for fraction in fractions if fastest > 0.0]


EFFECT = Effect(
    name="command-rate",
    title="speed limit of the target",
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
    controller=lambda controller, shape: {"target_rate": shape[0]},
    drive_shapes=_rates,
)
