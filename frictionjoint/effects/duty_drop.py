"""duty-drop: a protection that reduces the drive above an error, or above an output.

Two forms, one per monitored quantity.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import DROP_ERROR, DROP_LEFT, DROP_OUTPUT, KP
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape


def _changed(at: int, block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    block[at], block[DROP_LEFT] = shape
    return block, delay


def _figures(of: str, controller: Controller, shape: Shape) -> dict[str, Any]:
    return {"drop_above": shape[0], "drop_of": of, "drop_left": shape[1]}


def _errors(logs: Sequence[Commands]) -> list[Shape]:
    return _starts([np.abs(x.target - x.position)[x.on] for x in logs])


def _outputs(logs: Sequence[Commands]) -> list[Shape]:
    return _starts([x.block[KP] * np.abs(x.target - x.position)[x.on] for x in logs])


def _starts(watched: Sequence[Array]) -> list[Shape]:
    """Quantiles of the monitored quantity, over samples and over their squares, and what is left.

    The torque is discontinuous, so a start must be within a few per cent of the samples or of the
    drive. A leg that follows slowly and jumps now and then has most of its samples at small errors
    and most of its drive at large ones.
    """
    size = np.sort(np.concatenate(watched))
    squares = np.cumsum(size**2)
    parts = np.linspace(0.02, 0.98, 20)
    at = np.minimum(np.searchsorted(squares, parts * squares[-1]), len(size) - 1)
    of_samples = np.quantile(size, np.linspace(0.02, 0.98, 30))
    thresholds = np.unique(np.concatenate([of_samples, size[at]]))
    return [(float(x), 0.4) for x in thresholds if x > 0.0]


EFFECT = Effect(
    name="duty-drop",
    title="output reduced at large error",
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
    drive=partial(_changed, DROP_ERROR),
    controller=partial(_figures, "error"),
    drive_shapes=_errors,
)

OF_OUTPUT = replace(
    EFFECT,
    form="left u where |u| > threshold, u in the unit of the controller's output",
    shape_units=("output", "1"),
    drive=partial(_changed, DROP_OUTPUT),
    controller=partial(_figures, "output"),
    drive_shapes=_outputs,
)
