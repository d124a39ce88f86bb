"""duty-drop: a protection that reduces the drive above an error, or above an output.

Two forms, one per monitored quantity.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import DROP_ERROR, DROP_LEFT, DROP_OUTPUT, KP
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape

# Initial values: quantiles of the magnitude of the monitored quantity, over samples and over their
# squares, and the remaining fraction. The torque is discontinuous, so a start must be within a few
# per cent of the samples or of the drive. A leg that follows slowly and jumps now and then has most
# of its samples at small errors and most of its drive at large ones.
_OF_SAMPLES, _OF_SQUARES = np.linspace(0.02, 0.98, 30), np.linspace(0.02, 0.98, 20)
_LEFT = 0.4


def of_error(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """A fraction of the output above an error."""
    block[DROP_ERROR], block[DROP_LEFT] = shape
    return block, delay


def of_output(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """A fraction of the output above an output."""
    block[DROP_OUTPUT], block[DROP_LEFT] = shape
    return block, delay


def error_figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    return {"drop_above": shape[0], "drop_of": "error", "drop_left": shape[1]}


def output_figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    return {"drop_above": shape[0], "drop_of": "output", "drop_left": shape[1]}


def _errors(logs: Sequence[Commands]) -> list[Shape]:
    return _starts([np.abs(x.target - x.position)[x.on] for x in logs])


def _outputs(logs: Sequence[Commands]) -> list[Shape]:
    return _starts([x.block[KP] * np.abs(x.target - x.position)[x.on] for x in logs])


def _starts(watched: Sequence[Array]) -> list[Shape]:
    """Initial thresholds of the monitored quantity, each with remaining fractions."""
    size = np.sort(np.concatenate(watched))
    squares = np.cumsum(size**2)
    at = np.minimum(np.searchsorted(squares, _OF_SQUARES * squares[-1]), len(size) - 1)
    thresholds = np.unique(np.concatenate([np.quantile(size, _OF_SAMPLES), size[at]]))
    return [(float(x), _LEFT) for x in thresholds if x > 0.0]


EFFECT = Effect(
    name="duty-drop",
    title="output reduced at large error",
    effect_id=0,
    coefficients=(),
    units=(),
    cause="overload protection that lowers the duty",
    form="left u where |target - q| > threshold",
    source="protective torque and overload registers of Feetech STS servos; scope measurements of "
    "K-Scale Labs (2025)",
    signature="less drive at large errors than at smaller ones",
    separating_motion="hold the joint away from its target by several distances, at two gains",
    entry="acts on the drive",
    shape=("threshold", "left"),
    shape_units=("x", "1"),
    shape_bounds=((0.0, float("inf")), (0.0, 1.0)),
    leaps=True,
    drive=of_error,
    controller=error_figures,
    drive_shapes=_errors,
)

OF_OUTPUT = replace(
    EFFECT,
    form="left u where |u| > threshold, u in the unit of the controller's output",
    shape_units=("output", "1"),
    drive=of_output,
    controller=output_figures,
    drive_shapes=_outputs,
)
