"""How far a joint moves behind a reversal before it slides."""

import numpy as np

from frictionjoint.law.motion import friction_torque
from frictionjoint.parameters import Friction


def presliding_distance(parameters: Friction, part: float) -> float:
    """Displacement behind a reversal until friction has made a part of its change, rad (m).

    Args:
        part: of the change from one direction of sliding to the other, 0 to 1.
    """
    x = np.geomspace(1e-9, 1.0, 2000)
    q = np.concatenate([[0.0], x, x[-1] - x])
    # at 1e-6 rad/s no law has a viscous part
    F = friction_torque(parameters, np.arange(len(q)) / 1e-6, q)
    back = F[len(x) + 1 :]
    return float(x[np.argmax(back <= F[len(x)] + part * (back[-1] - F[len(x)]))])
