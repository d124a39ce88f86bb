"""The ten inertial parameters of a rigid body: from a model, as a pseudo-inertia, into a spec.

    phi = (m, mx, my, mz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz)

Mass, first moments and the inertia about the origin of the body's own frame, kg, kg m, kg m^2: a
rigid body's torques are linear in them. A body can exist if its pseudo-inertia, the second moment
of its density over (x, y, z, 1), is positive definite (Wensing, Kim and Slotine 2018).
"""

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError

NAMES = (
    "mass",
    *(f"first moment {x}" for x in "xyz"),
    *(f"inertia {x}" for x in ("xx", "xy", "xz", "yy", "yz", "zz")),
)
UNITS = ("kg", *("kg m",) * 3, *("kg m^2",) * 6)
TEN = len(NAMES)
# where Ixx ... Izz stand in the symmetric matrix
_ROWS, _COLUMNS = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)


def of_model(model: mujoco.MjModel) -> Array:
    """Parameters of every body of a model, shape (nbody, 10)."""
    found = np.zeros((model.nbody, TEN))
    for b in range(model.nbody):
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, model.body_iquat[b])
        R = rotation.reshape(3, 3)
        about_centre = R @ np.diag(model.body_inertia[b]) @ R.T
        found[b] = of_body(float(model.body_mass[b]), model.body_ipos[b], about_centre)
    return found


def of_body(mass: float, centre: Array, about_centre: Array) -> Array:
    """Parameters from mass, centre of mass (m) and inertia about it, shape (3, 3), kg m^2."""
    inertia = about_centre + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return np.array([mass, *(mass * centre), *inertia[_ROWS, _COLUMNS]])


def about_centre(phi: Array) -> tuple[float, Array, Array]:
    """Mass, centre of mass and the inertia about it, shape (3, 3), of a body with mass."""
    centre = phi[1:4] / phi[0]
    own = matrix(phi) - phi[0] * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return float(phi[0]), centre, own


def matrix(phi: Array) -> Array:
    """Inertia about the origin of the body's frame, shape (3, 3)."""
    inertia = np.zeros((3, 3))
    inertia[_ROWS, _COLUMNS] = inertia[_COLUMNS, _ROWS] = phi[4:]
    return inertia


def pseudo(phi: Array) -> Array:
    """Pseudo-inertia, shape (4, 4)."""
    m, x, y, z, xx, xy, xz, yy, yz, zz = phi.tolist()
    half = 0.5 * (xx + yy + zz)
    return np.array(
        ((half - xx, -xy, -xz, x), (-xy, half - yy, -yz, y), (-xz, -yz, half - zz, z), (x, y, z, m))
    )


def of_pseudo(P: Array) -> Array:
    """Parameters of a pseudo-inertia, the inverse of `pseudo`."""
    (xx, xy, xz, x), (_, yy, yz, y), (_, _, zz, z), (*_, m) = P.tolist()
    return np.array((m, x, y, z, yy + zz, -xy, -xz, xx + zz, -yz, xx + yy))


def possible(phi: Array) -> bool:
    """Whether a body with these parameters can exist: positive mass, pseudo-inertia definite."""
    return bool(phi[0] > 0.0 and np.linalg.eigvalsh(pseudo(phi)).min() > 0.0)


def write(body: mujoco.MjsBody, phi: Array) -> None:
    """Give a body of a spec these parameters; ModelError if no physical body has them."""
    if not possible(phi):
        what = f"mass {phi[0]:.4g} kg and its moments belong to no possible body"
        raise ModelError(f"body {body.name!r}: {what}")
    mass, centre, own = about_centre(phi)
    body.explicitinertial = True
    body.mass, body.ipos = mass, centre
    body.iquat = np.array([1.0, 0.0, 0.0, 0.0])
    body.inertia = np.zeros(3)
    body.fullinertia = np.array([own[0, 0], own[1, 1], own[2, 2], own[0, 1], own[0, 2], own[1, 2]])
