"""gain-error: gains other than the controller's file says.

Three forms: the proportional gain alone; all gains alike, whose unit is another one; all that the
controller puts out, its limit too, where a unit of the output is worth another torque.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import KD, KFF, KI, KP, LIMIT
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape

_FACTORS = (0.7, 0.85, 1.2, 1.5)


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """Another kp."""
    block[KP] *= shape[0]
    return block, delay


def all_changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """All gains of the error and the velocity in another unit."""
    block[[KP, KI, KD]] *= shape[0]
    return block, delay


def output_changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The whole output in another unit."""
    block[[KP, KI, KD, KFF, LIMIT]] *= shape[0]
    return block, delay


def figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """What it changes in a controller's file."""
    kp = controller.kp
    if isinstance(kp, str):
        return {"gain_unit": controller.gain_unit * shape[0]}
    return {"kp": kp * shape[0]}


def all_figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """What it changes in a controller's file."""
    return {"gain_unit": controller.gain_unit * shape[0]}


def output_figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """What it changes in a controller's file."""
    limit = controller.limit if isinstance(controller.limit, str) else controller.limit * shape[0]
    return {
        "gain_unit": controller.gain_unit * shape[0],
        "feed_forward": controller.feed_forward * shape[0],
        "limit": limit,
    }


def _factors(logs: Sequence[Commands]) -> list[Shape]:
    return [(factor,) for factor in _FACTORS]


def _units(logs: Sequence[Commands]) -> list[Shape]:
    """None where the proportional gain is alone."""
    return _factors(logs) if any(np.any(x.block[[KI, KD]]) for x in logs) else []


def _outputs(logs: Sequence[Commands]) -> list[Shape]:
    """None where the limit is never reached."""
    reached = any(np.any(np.abs(x.drive()) >= x.block[LIMIT]) for x in logs)
    return _factors(logs) if reached else []


EFFECT = Effect(
    name="gain-error",
    effect_id=0,
    coefficients=(),
    units=(),
    cause="a gain that was changed, or whose unit is another one",
    form="factor kp (target - q) in place of kp (target - q)",
    source="definition of the proportional gain",
    signature="proportional to the error; nothing of it where the output is at its limit",
    separating_motion="a motion with a known extra load, and steps that reach the limit",
    entry="acts on the drive",
    shape=("factor",),
    shape_units=("1",),
    shape_bounds=((0.05, 20.0),),
    # a voltage is known up to a gain, and this is that gain
    drives=("torque",),
    drive=changed,
    controller=figures,
    drive_shapes=_factors,
)

UNIT = replace(
    EFFECT,
    form="factor u in place of u, within the same limit",
    drive=all_changed,
    controller=all_figures,
    drive_shapes=_units,
)

OUTPUT = replace(
    EFFECT,
    form="factor u in place of u, the limit with it",
    drive=output_changed,
    controller=output_figures,
    drive_shapes=_outputs,
)
