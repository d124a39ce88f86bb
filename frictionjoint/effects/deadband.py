"""deadband: a controller that does nothing while the error is small.

Two forms: outside the band the whole error acts, or only the part that exceeds the band.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.kernel import DEADBAND, SHIFTED
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape


def _changed(block: Array, delay: float, shape: Shape, shifted: float = 0.0) -> tuple[Array, float]:
    block[DEADBAND], block[SHIFTED] = shape[0], shifted
    return block, delay


def _bands(logs: Sequence[Commands], quantiles: Sequence[float] | Array) -> list[Shape]:
    errors = np.concatenate([np.abs(x.target - x.position)[x.on] for x in logs])
    return [(float(d),) for d in np.unique(np.quantile(errors, quantiles)) if d > 0.0]


EFFECT = Effect(
    name="deadband",
    title="dead band of the controller",
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
    drive=_changed,
    controller=lambda controller, shape: {"deadband": shape[0], "deadband_form": "cut"},
    # the torque is discontinuous, so a start must be within a few per cent of the samples
    drive_shapes=partial(_bands, quantiles=np.linspace(0.02, 0.5, 25)),
)

SHIFTED_BAND = replace(
    EFFECT,
    form="u of the error less deadband sgn(error), 0 where |target - q| <= deadband",
    leaps=False,
    drive=partial(_changed, shifted=1.0),
    controller=lambda controller, shape: {"deadband": shape[0], "deadband_form": "shifted"},
    drive_shapes=partial(_bands, quantiles=(0.05, 0.1, 0.2, 0.35, 0.5)),
)
