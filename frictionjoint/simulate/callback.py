"""The passive-force callback in Python; ``simulate.native`` is the same in C, from the same
kernels.

Both are stateless: parameters are read from the model's numerics, state from the data's userdata.
For a model without friction they only look through its numerics.
"""

import mujoco
import numpy as np

from frictionjoint.simulate.block import DOF, EFFECTS, HEAD, JOINT, MAGIC, QPOS, RESOLVED, ROW
from frictionjoint.simulate.fast_step import joint_torque
from frictionjoint.simulate.implicit_mass import put_in, take_back
from frictionjoint.simulate.joint_effects import asks_for_load, coupled_load, joint_effects
from frictionjoint.simulate.layout import data_structure
from frictionjoint.simulate.motor_demand import commanded_torque, controls, gives_less
from frictionjoint.simulate.native import PGS, PROJECTED, RK4
from frictionjoint.simulate.resolve_when_stepped import make_ready
from frictionjoint.simulate.row import BASE, T_EVALUATED
from frictionjoint.simulate.shaft_wave import SHAFT, resist
from frictionjoint.simulate.userdata_room import lacks_room, warn_of_no_room


def python_callback(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """The passive callback in Python: slower than in C, but every line can be stepped through."""
    P, X = model.numeric_data, data.userdata
    if lacks_room(model, data):
        warn_of_no_room(model._address)
        return
    step = model.opt.timestep
    h = 0.0 if model.opt.integrator == RK4 else step
    bias, moved = np.zeros(model.nv), np.zeros(model.nv)
    loaded = changed = False
    diagonal = model.M_rowadr + model.M_rownnz - 1
    for i in range(model.nnumeric):
        block = int(model.numeric_adr[i])
        if P[block] != MAGIC and P[block] != SHAFT:
            continue
        if P[block + RESOLVED] == 0.0:
            make_ready(model)
            block = int(model.numeric_adr[i])
        if P[block + RESOLVED] != 1.0:
            continue
        if P[block] == SHAFT:
            resist(P, block, data.qpos, data.qvel, data.qfrc_passive)
            continue
        x, dof, joint = (int(P[block + k]) for k in (ROW, DOF, JOINT))
        q, v, t = float(data.qpos[int(P[block + QPOS])]), float(data.qvel[dof]), data.time
        effects = block + int(P[block + EFFECTS])
        entry = int(diagonal[dof])
        later = X[x + T_EVALUATED] != t
        take_back(X, x, data.M, entry)
        own = float(X[x + BASE])
        weight = float(model.dof_invweight0[dof])
        F = joint_torque(P, block + HEAD, effects, X, x, t, q, v, step, h, own, weight)
        if P[effects] > 0.0:
            commanded = 0.0
            if gives_less(P, effects):
                commanded = commanded_torque(
                    joint,
                    q,
                    v,
                    *controls(model),
                    model.opt.disableflags,
                    model.opt.disableactuator,
                    model.actuator_trntype,
                    model.actuator_trnid.reshape(-1),
                    model.actuator_group,
                    model.actuator_gear.reshape(-1),
                    model.actuator_gainprm.reshape(-1),
                    model.actuator_biasprm.reshape(-1),
                    model.actuator_ctrllimited.view(np.bool_),
                    model.actuator_ctrlrange.reshape(-1),
                    data.ctrl,
                )
            load = 0.0
            loads = asks_for_load(P, effects)
            if loads >= 0:
                if not loaded:
                    loaded = True
                    mujoco.mj_rne(model, data, 0, bias)
                    mujoco.mj_mulM(model, data, moved, data.qacc)
                    moved -= data.M[diagonal] * data.qacc
                others = moved[dof] - data.qfrc_constraint[dof]
                load = bias[dof] + coupled_load(P, block + HEAD, X, x, loads, later, others)
            F += joint_effects(
                P,
                block,
                X,
                t,
                q,
                v,
                load,
                own - model.dof_armature[dof],
                model.dof_armature[dof],
                joint,
                model.jnt_axis.reshape(-1),
                data.xaxis.reshape(-1),
                model.opt.gravity,
                data.xmat.reshape(-1),
                int(model.jnt_bodyid[joint]),
                commanded,
            )
        data.qfrc_passive[dof] -= F
        if put_in(X, x, data.M, entry, h):
            changed = True
            if hasattr(data, "qM"):
                data.qM[model.dof_Madr[dof]] = data.M[entry]
        if F != F:
            break
    if changed:
        mujoco.mj_factorM(model, data)
        if hasattr(data, "iM"):
            _copy_to_islands(model, data)
        if data.nefc and (model.opt.solver == PGS or model.opt.noslip_iterations > 0):
            _give_back_projection(data)
            mujoco.mj_projectConstraint(model, data)


def _give_back_projection(data: mujoco.MjData) -> None:
    """Free the projection of the constraints made before, which is the last in the arena."""
    fields = data_structure().from_address(data._address)
    begins = [getattr(fields, name, None) for name in PROJECTED]
    lowest = min((begin for begin in begins if begin), default=None)
    if lowest is not None:
        fields.parena = lowest - fields.arena


def _copy_to_islands(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Mass matrix and factors of MuJoCo up to 3.10, which also stores them by island."""
    for i, dof in enumerate(data.map_idof2dof[: data.nidof]):
        data.iLDiagInv[i] = data.qLDiagInv[dof]
        begin, n, to = model.M_rowadr[dof], model.M_rownnz[dof], data.iM_rowadr[i]
        data.iM[to : to + n] = data.M[begin : begin + n]
        data.iLD[to : to + n] = data.qLD[begin : begin + n]
