"""command-delay: a target acts later than its time in the log."""

from collections.abc import Sequence
from typing import Any

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape

# s: from a tick of a fast bus to a slow camera
_DELAYS = (0.004, 0.012, 0.03, 0.08)


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The controller block whose target arrives later."""
    return block, delay + shape[0]


def figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    before = controller.delay_s
    return {"delay_s": shape[0] + (0.0 if isinstance(before, str) else before)}


def _delays(logs: Sequence[Commands]) -> list[Shape]:
    return [(delay,) for delay in _DELAYS]


EFFECT = Effect(
    name="command-delay",
    title="command delay",
    effect_id=0,
    coefficients=(),
    units=(),
    cause="buses, queues and firmware between a command and the drive",
    form="u of target(t - delay), each target held until the next",
    source="pure delay of the reference channel",
    signature="proportional to the target's velocity; nothing while the target stands",
    separating_motion="steps of the target, and a fast sine",
    entry="acts on the drive",
    shape=("delay",),
    shape_units=("s",),
    shape_bounds=((0.0, 0.5),),
    drive=changed,
    controller=figures,
    drive_shapes=_delays,
    delays_target=True,
)
