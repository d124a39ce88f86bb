"""What friction a model carries, and whether its time step suits it."""

from typing import Any

import mujoco
import numpy as np

from frictionjoint.simulate.carrier import read_friction

# Above this the presliding spring turns over within a step; see docs on time steps.
_LARGEST_STEP_RATIO = 1.0


def check_model(model: mujoco.MjModel) -> list[dict[str, Any]]:
    """One row a joint: law, presliding stiffness K, h sqrt(K/J) at qpos0, effects, remark."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    inverse = np.linalg.inv(mass)
    rows = []
    for name, carried in read_friction(model).items():
        dof = int(model.jnt_dofadr[model.joint(name).id])
        stiffness = carried.parameters.stiffness
        ratio = model.opt.timestep * float(np.sqrt(stiffness * inverse[dof, dof]))
        remark = "suits the time step"
        if ratio > _LARGEST_STEP_RATIO:
            longest = model.opt.timestep * _LARGEST_STEP_RATIO / ratio
            remark = f"stiff: held, and presliding resolved at timestep <= {longest:.2g} s"
        if model.dof_frictionloss[dof] > 0.0:
            remark += "; native frictionloss acts too"
        rows.append(
            {
                "joint": name,
                "law": carried.parameters.law,
                "stiffness": stiffness,
                "step_ratio": ratio,
                "effects": [e.effect.name for e in carried.effects],
                "remark": remark,
            }
        )
    return rows
