"""Superposition of elasto-plastic (Jenkins) elements equal to a Masing curve Fd(2z)/2."""

import numpy as np


def jenkins_torque(knots, position) -> np.ndarray:
    """Torque, N m, of parallel elements: stiffness drops of Fd at each knot, yield at z_i / 2."""
    z = np.array([k[0] for k in knots])
    F = np.array([k[1] for k in knots])
    slopes = np.diff(np.concatenate(([0.0], F))) / np.diff(np.concatenate(([0.0], z)))
    stiffness = slopes - np.concatenate((slopes[1:], [0.0]))
    limit = z / 2
    limit[-1] = np.inf  # the last slope goes on
    stretch = np.zeros(len(z))
    torque = np.zeros(len(position))
    for k in range(1, len(position)):
        stretch = np.clip(stretch + position[k] - position[k - 1], -limit, limit)
        torque[k] = float(stiffness @ stretch)
    return torque
