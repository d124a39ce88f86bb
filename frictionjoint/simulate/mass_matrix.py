"""The mass matrix of a model with friction.

Friction is implicit: from the passive forces of a step until the next position stage,
``mjData.M`` contains the joints' friction on its diagonal (see
`simulate.implicit_mass`), and ``mj_fullM`` returns it.
"""

import mujoco
import numpy as np

from frictionjoint.arguments import require_data
from frictionjoint.arrays import Array
from frictionjoint.simulate.block import DOF, ROW
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.row import BASE, WRITTEN


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """The mass matrix without friction, for a controller that needs it after a step.

    Args:
        model: with or without friction. data: of that model; unchanged.
    Returns:
        M(q) of the last position stage, armature included, shape (nv, nv), as ``mj_fullM`` returns
        it without friction.
    Raises:
        ModelError: the data belong to another model. TypeError: no MjModel or MjData.
    """
    require_data(data, model, "mass_matrix")
    entries, P, X = data.M.copy(), model.numeric_data, data.userdata
    for block in resolve(model).values():
        dof, row = int(P[block + DOF]), int(P[block + ROW])
        diagonal = model.M_rowadr[dof] + model.M_rownnz[dof] - 1
        if entries[diagonal] == X[row + WRITTEN]:
            entries[diagonal] = X[row + BASE]
    dense = np.zeros((model.nv, model.nv))
    rows = np.repeat(np.arange(model.nv), model.M_rownnz)
    dense[rows, model.M_colind] = entries
    dense[model.M_colind, rows] = entries
    return dense
