"""gain-error: a proportional gain that differs from the controller file."""

from typing import Any

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import KP
from frictionjoint.effects.effect import Effect, Shape


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The controller block with another kp."""
    block[KP] *= shape[0]
    return block, delay


def figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    kp = controller.kp
    if isinstance(kp, str):
        return {"gain_unit": controller.gain_unit * shape[0]}
    return {"kp": kp * shape[0]}


EFFECT = Effect(
    name="gain-error",
    title="wrong controller gain",
    cause="a gain that was changed or is in another unit",
    form="factor kp (target - q) in place of kp (target - q)",
    source="definition of the proportional gain",
    signature="proportional to the position error; absent where the output is at its limit",
    separating_motion="a motion with a known extra load, and steps that reach the limit",
    entry="acts on the drive",
    shape=("factor",),
    shape_units=("1",),
    shape_bounds=((0.05, 20.0),),
    # with a voltage the motor gain is unknown anyway, and the two are the same number
    drives=("torque",),
    drive=changed,
    controller=figures,
    drive_shapes=lambda logs: [(factor,) for factor in (0.7, 0.85, 1.2, 1.5)],
    none=(1.0,),
)
