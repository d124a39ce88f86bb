"""The passive-force callback: native (a numba C function) and readable (Python), one kernel.

Both keep nothing: parameters are read from the model's numerics, state from the data's userdata,
through the two pointers MuJoCo hands over. A model without friction costs a look at its numerics.
"""

import ctypes
from collections.abc import Iterable
from typing import Any

import mujoco
import numpy as np
from numba import cfunc, types

from frictionjoint.compiled import link
from frictionjoint.law.kernel import link_law
from frictionjoint.simulate.carrier import (
    DOF,
    EFFECTS,
    HEAD,
    JOINT,
    MAGIC,
    QPOS,
    RESOLVED,
    ROW,
)
from frictionjoint.simulate.first_sight import (
    make_ready,
    make_ready_in_c,
    warn_of_no_room,
    warn_of_no_room_in_c,
)
from frictionjoint.simulate.layout import offsets
from frictionjoint.simulate.mass import put_in, take_back
from frictionjoint.simulate.motor_demand import asked_torque, gives_less
from frictionjoint.simulate.pointers import (
    array,
    field,
    mj_factor_m,
    mj_free_stack,
    mj_mark_stack,
    mj_mul_m,
    mj_project_constraint,
    mj_rne,
    mj_stack_numbers,
)
from frictionjoint.simulate.row import BASE, T_EVALUATED, over_the_step, torque_now
from frictionjoint.simulate.shaft_wave import SHAFT, resist
from frictionjoint.simulate.userdata_room import lacks_room
from frictionjoint.simulate.with_effects import (
    asks_for_load,
    coupled_load,
    joint_effects,
    late_joint_effects,
)

PGS = int(mujoco.mjtSolver.mjSOL_PGS)
# its four evaluations a step are no steps of their own: friction stays explicit
RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)


def build_native() -> Any:
    """The C function for this MuJoCo build; compiled code is cached by numba."""
    model_at, data_at = offsets()
    # closure variables are part of numba's cache key: another layout compiles anew
    at_nv, at_nnumeric = model_at["nv"], model_at["nnumeric"]
    at_adr, at_numeric = model_at["numeric_adr"], model_at["numeric_data"]
    at_step, at_integrator = model_at["timestep"], model_at["integrator"]
    at_weight, at_armature = model_at["dof_invweight0"], model_at["dof_armature"]
    at_gravity = model_at["gravity"]
    at_body, at_axis = model_at["jnt_bodyid"], model_at["jnt_axis"]
    at_rowadr, at_rownnz = model_at["M_rowadr"], model_at["M_rownnz"]
    at_mass, at_xmat, at_xaxis = (data_at[k] for k in ("M", "xmat", "xaxis"))
    at_time, at_qpos, at_qvel = (data_at[k] for k in ("time", "qpos", "qvel"))
    at_passive, at_user = data_at["qfrc_passive"], data_at["userdata"]
    at_behind_user, at_nuser = data_at["sensordata"], model_at["nuserdata"]
    at_qacc, at_constraint = data_at["qacc"], data_at["qfrc_constraint"]
    at_nu, at_flags, at_off = (model_at[k] for k in ("nu", "disableflags", "disableactuator"))
    at_kind, at_target = model_at["actuator_trntype"], model_at["actuator_trnid"]
    at_group, at_gear = model_at["actuator_group"], model_at["actuator_gear"]
    at_gain, at_bias = model_at["actuator_gainprm"], model_at["actuator_biasprm"]
    at_limited, at_range = model_at["actuator_ctrllimited"], model_at["actuator_ctrlrange"]
    at_ctrl = data_at["ctrl"]
    at_solver, at_noslip = model_at["solver"], model_at["noslip_iterations"]
    at_nefc, at_arena, at_used = (data_at[k] for k in ("nefc", "arena", "parena"))
    projected = ("efc_Y_rownnz", "efc_Y", "efc_AR_rownnz", "efc_AR")
    at_projected = tuple(data_at[k] for k in projected if k in data_at)
    has_copies = "iM" in data_at
    at_second, at_second_entry = data_at.get("qM", 0), model_at.get("dof_Madr", 0)
    at_island_mass, at_island_factor, at_island_diagonal = (
        data_at.get(k, 0) for k in ("iM", "iLD", "iLDiagInv")
    )
    at_factor, at_diagonal = data_at.get("qLD", 0), data_at.get("qLDiagInv", 0)
    at_island_row, at_dof_of, at_island_dofs = (
        data_at.get(k, 0) for k in ("iM_rowadr", "map_idof2dof", "nidof")
    )
    real, short, whole, byte = types.float64, types.int32, types.int64, types.uint8

    @cfunc(types.void(types.voidptr, types.voidptr), cache=True, error_model="numpy")
    def native(m: ctypes.c_void_p, d: ctypes.c_void_p) -> None:
        n = int(field(m, at_nnumeric, whole)[0])
        if n == 0:
            return
        there = field(d, at_behind_user, whole)[0] - field(d, at_user, whole)[0]
        if there < 8 * field(m, at_nuser, whole)[0]:
            warn_of_no_room_in_c(m)
            return
        address, P = array(m, at_adr, short), array(m, at_numeric, real)
        qpos, qvel = array(d, at_qpos, real), array(d, at_qvel, real)
        passive, X = array(d, at_passive, real), array(d, at_user, real)
        t = field(d, at_time, real)[0]
        step = field(m, at_step, real)[0]
        h = step
        if field(m, at_integrator, short)[0] == RK4:
            h = 0.0
        weights = array(m, at_weight, real)
        nv = int(field(m, at_nv, whole)[0])
        M = array(d, at_mass, real)
        first_of, count_of = array(m, at_rowadr, short), array(m, at_rownnz, short)
        changed = False
        loaded = False
        bias = moved = qvel
        for i in range(n):
            block = int(address[i])
            if P[block] != MAGIC and P[block] != SHAFT:
                continue
            if P[block + RESOLVED] != 1.0:
                if P[block + RESOLVED] == 0.0:
                    make_ready_in_c(m)
                if P[block + RESOLVED] != 1.0:
                    continue
            if P[block] == SHAFT:
                resist(P, block, qpos, qvel, passive)
                continue
            x = int(P[block + ROW])
            q = qpos[int(P[block + QPOS])]
            dof = int(P[block + DOF])
            v = qvel[dof]
            effects = block + int(P[block + EFFECTS])
            later = X[x + T_EVALUATED] != t
            entry = int(first_of[dof] + count_of[dof]) - 1
            take_back(X, x, M, entry)
            own = X[x + BASE]
            F = torque_now(P, block + HEAD, effects, X, x, t, q, v, step)
            if F == F and h > 0.0:
                F = over_the_step(P, block + HEAD, X, x, h, v, own, weights[dof])
            if P[effects] > 0.0:
                joint = int(P[block + JOINT])
                asked = 0.0
                if gives_less(P, effects):
                    asked = asked_torque(
                        joint,
                        q,
                        v,
                        int(field(m, at_nu, whole)[0]),
                        int(field(m, at_flags, short)[0]),
                        int(field(m, at_off, short)[0]),
                        array(m, at_kind, short),
                        array(m, at_target, short),
                        array(m, at_group, short),
                        array(m, at_gear, real),
                        array(m, at_gain, real),
                        array(m, at_bias, real),
                        array(m, at_limited, byte),
                        array(m, at_range, real),
                        array(d, at_ctrl, real),
                    )
                load = 0.0
                loads = asks_for_load(P, effects)
                if loads >= 0:
                    if not loaded:
                        loaded = True
                        mj_mark_stack(d)
                        bias, moved = mj_stack_numbers(d, nv), mj_stack_numbers(d, nv)
                        mj_rne(m, d, 0, bias)
                        qacc = array(d, at_qacc, real)
                        mj_mul_m(m, d, moved, qacc)
                        for k in range(nv):  # friction changes the diagonal entries
                            moved[k] -= M[int(first_of[k] + count_of[k]) - 1] * qacc[k]
                    others = moved[dof] - array(d, at_constraint, real)[dof]
                    load = bias[dof]
                    load += coupled_load(P, block + HEAD, X, x, loads, later, others)
                F += late_joint_effects(
                    P,
                    block,
                    X,
                    t,
                    q,
                    v,
                    load,
                    own - array(m, at_armature, real)[dof],
                    array(m, at_armature, real)[dof],
                    joint,
                    array(m, at_axis, real),
                    array(d, at_xaxis, real),
                    field(m, at_gravity, real),
                    array(d, at_xmat, real),
                    int(array(m, at_body, short)[joint]),
                    asked,
                )
            passive[dof] -= F
            if put_in(X, x, M, entry, h):
                changed = True
                if has_copies:
                    second = int(array(m, at_second_entry, short)[dof])
                    array(d, at_second, real)[second] = M[entry]
            if F != F:
                break  # gone astray: MuJoCo resets the whole state
        if loaded:
            mj_free_stack(d)
        if not changed:
            return
        mj_factor_m(m, d)
        if has_copies and field(d, at_island_mass, whole)[0] != 0:
            factor, diagonal = array(d, at_factor, real), array(d, at_diagonal, real)
            island_mass = array(d, at_island_mass, real)
            island_factor = array(d, at_island_factor, real)
            island_diagonal = array(d, at_island_diagonal, real)
            row, dof_of = array(d, at_island_row, short), array(d, at_dof_of, short)
            for i in range(int(field(d, at_island_dofs, short)[0])):
                dof = int(dof_of[i])
                island_diagonal[i] = diagonal[dof]
                for k in range(int(count_of[dof])):
                    island_mass[int(row[i]) + k] = M[int(first_of[dof]) + k]
                    island_factor[int(row[i]) + k] = factor[int(first_of[dof]) + k]
        if field(d, at_nefc, short)[0] == 0:
            return
        if field(m, at_solver, short)[0] == PGS or field(m, at_noslip, short)[0] > 0:
            # the projection that the position stage made goes: it is the last in the arena
            lowest = 0
            for at in at_projected:
                begin = int(field(d, at, whole)[0])
                if begin != 0 and (lowest == 0 or begin < lowest):
                    lowest = begin
            if lowest != 0:
                field(d, at_used, whole)[0] = lowest - int(field(d, at_arena, whole)[0])
            mj_project_constraint(m, d)

    return native


def link_what_acts(model: mujoco.MjModel, blocks: Iterable[int]) -> None:
    """Compile or load now what the native callback will need for these blocks of a model."""
    P = model.numeric_data
    for block in blocks:
        link_law(P, block + HEAD)
        if P[block + int(P[block + EFFECTS])] > 0.0:
            link(late_joint_effects)


def python_callback(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """The same callback in Python: slower, but every line can be stepped through."""
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
        F = torque_now(P, block + HEAD, effects, X, x, t, q, v, step)
        if F == F and h > 0.0:
            weight = float(model.dof_invweight0[dof])
            F = over_the_step(P, block + HEAD, X, x, h, v, own, weight)
        if P[effects] > 0.0:
            asked = 0.0
            if gives_less(P, effects):
                asked = asked_torque(
                    joint,
                    q,
                    v,
                    model.nu,
                    model.opt.disableflags,
                    model.opt.disableactuator,
                    model.actuator_trntype,
                    model.actuator_trnid.reshape(-1),
                    model.actuator_group,
                    model.actuator_gear.reshape(-1),
                    model.actuator_gainprm.reshape(-1),
                    model.actuator_biasprm.reshape(-1),
                    model.actuator_ctrllimited,
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
                asked,
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
            mujoco.mj_projectConstraint(model, data)


def _copy_to_islands(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Mass matrix and factors of MuJoCo until 3.10, which keeps them by island too."""
    for i, dof in enumerate(data.map_idof2dof[: data.nidof]):
        data.iLDiagInv[i] = data.qLDiagInv[dof]
        begin, n, to = model.M_rowadr[dof], model.M_rownnz[dof], data.iM_rowadr[i]
        data.iM[to : to + n] = data.M[begin : begin + n]
        data.iLD[to : to + n] = data.qLD[begin : begin + n]
