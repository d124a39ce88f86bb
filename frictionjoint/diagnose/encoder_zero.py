"""An encoder zero that is off: it turns gravity, so a single joint shows it as a wrong mass."""

from collections.abc import Mapping

import numpy as np

from frictionjoint.arrays import root_mean_square
from frictionjoint.decisions import SURELY
from frictionjoint.effects.signals import GX, GY, LOAD, A, parts_of_load
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.segment import Prepared


def offset_instead(prepared: Prepared, found: Mapping[str, Estimate]) -> float | None:
    """Offset of the encoder, rad, that explains the logs as well as a gravity error; or None.

    It does if the first moment of mass, with the error, is the model's own, turned about the axis.

    Args:
        found: first moments of the gravity error by name, kg m.
    """
    x, y = found.get("moment_x"), found.get("moment_y")
    if prepared.slide or x is None or y is None or x.stderr is None or y.stderr is None:
        return None
    signals = np.concatenate([s.signals for s in prepared.segments])
    parts = parts_of_load(signals)
    load = signals[:, LOAD]
    # moments that change, because joints beyond this one move, do not turn as one
    if root_mean_square(load - signals[:, [A, GX, GY]] @ parts) > 0.01 * root_mean_square(load):
        return None
    own, true = complex(*parts[1:]), complex(*parts[1:]) + complex(x.value, y.value)
    error = SURELY * np.hypot(x.stderr, y.stderr)
    # a model states masses and lengths to about 1%
    if abs(own) < error or abs(abs(true) - abs(own)) > max(error, 0.01 * abs(own)):
        return None
    return float(np.angle(own / true))
