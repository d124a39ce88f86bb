"""deadband: a controller that does nothing while the error is small.

Two forms: outside the band the whole error acts, or only the part that exceeds the band.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import DEADBAND, SHIFTED
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape

# initial values: quantiles of the error's magnitude
_QUANTILES = (0.05, 0.1, 0.2, 0.35, 0.5)
# the torque is discontinuous, so a start must be within a few per cent of the samples
_CLOSE = np.linspace(0.02, 0.5, 25)


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """No output inside the band, the full output outside."""
    block[DEADBAND], block[SHIFTED] = shape[0], 0.0
    return block, delay


def shifted(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """No output inside the band; outside, only the part that exceeds it."""
    block[DEADBAND], block[SHIFTED] = shape[0], 1.0
    return block, delay


def figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    return {"deadband": shape[0], "deadband_form": "cut"}


def shifted_figures(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of the controller file that this effect changes."""
    return {"deadband": shape[0], "deadband_form": "shifted"}


def _bands(logs: Sequence[Commands], quantiles: Sequence[float] | Array) -> list[Shape]:
    errors = np.concatenate([np.abs(x.target - x.position)[x.on] for x in logs])
    return [(float(d),) for d in np.unique(np.quantile(errors, quantiles)) if d > 0.0]


EFFECT = Effect(
    name="deadband",
    title="dead band of the controller",
    effect_id=0,
    coefficients=(),
    units=(),
    cause="a dead zone in the firmware, so that a servo at its target is silent",
    form="u = 0 where |target - q| <= deadband",
    source="dead zone registers of hobby servos (Feetech, memory table, CW and CCW dead zone)",
    signature="no output at small position errors, at any speed",
    separating_motion="slow approach of the target from both sides, at two gains",
    entry="acts on the drive",
    shape=("deadband",),
    shape_units=("x",),
    shape_bounds=((0.0, float("inf")),),
    leaps=True,
    drive=changed,
    controller=figures,
    drive_shapes=partial(_bands, quantiles=_CLOSE),
)

SHIFTED_BAND = replace(
    EFFECT,
    form="u of the error less deadband sgn(error), 0 where |target - q| <= deadband",
    leaps=False,
    drive=shifted,
    controller=shifted_figures,
    drive_shapes=partial(_bands, quantiles=_QUANTILES),
)
