"""command-delay: a target acts later than its time in the log."""

from typing import Any

from frictionjoint.control.controller import Controller
from frictionjoint.effects.effect import Effect, Shape


def figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    before = controller.delay_s
    return {"delay_s": shape[0] + (0.0 if isinstance(before, str) else before)}


EFFECT = Effect(
    name="command-delay",
    title="command delay",
    cause="buses, queues and firmware between a command and the drive",
    form="u of target(t - delay), each target held until the next",
    source="pure delay of the reference channel",
    signature="proportional to the target's velocity; nothing while the target stands",
    separating_motion="steps of the target, and a fast sine",
    entry="acts on the drive",
    shape=("delay",),
    shape_units=("s",),
    shape_bounds=((0.0, 0.5),),
    drive=lambda block, delay, shape: (block, delay + shape[0]),
    controller=figures,
    # from a tick of a fast bus to a slow camera
    drive_shapes=lambda logs: [(delay,) for delay in (0.004, 0.012, 0.03, 0.08)],
    delays_target=True,
)
