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
from frictionjoint.law.ahead import STIFF
from frictionjoint.law.kernel import link_law, presliding
from frictionjoint.law.kernel import row_size as law_row_size
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
from frictionjoint.simulate.motor_demand import asked_torque, gives_less
from frictionjoint.simulate.pointers import (
    array,
    field,
    mj_free_stack,
    mj_mark_stack,
    mj_mul_m,
    mj_rne,
    mj_solve_m,
    mj_stack_numbers,
)
from frictionjoint.simulate.row import T_EVALUATED, torque_now
from frictionjoint.simulate.shaft_wave import SHAFT, resist
from frictionjoint.simulate.together import between, is_stiff, late_settle, settle
from frictionjoint.simulate.userdata_room import lacks_room
from frictionjoint.simulate.with_effects import (
    asks_for_load,
    coupled_load,
    joint_effects,
    late_joint_effects,
)

# its four evaluations a step are no steps of their own
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
        stiff = 0
        row = 0
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
            F = torque_now(P, block + HEAD, effects, X, x, t, q, v, step)
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
                last = int(array(m, at_rowadr, short)[dof] + array(m, at_rownnz, short)[dof]) - 1
                own = array(d, at_mass, real)[last]
                load = 0.0
                loads = asks_for_load(P, effects)
                if loads >= 0:
                    if not loaded:
                        loaded = True
                        mj_mark_stack(d)
                        bias, moved = mj_stack_numbers(d, nv), mj_stack_numbers(d, nv)
                        mj_rne(m, d, 0, bias)
                        mj_mul_m(m, d, moved, array(d, at_qacc, real))
                    others = moved[dof] - own * array(d, at_qacc, real)[dof]
                    others -= array(d, at_constraint, real)[dof]
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
            if F != F:
                break  # gone astray: MuJoCo resets the whole state
            if is_stiff(P, block + HEAD, X, x, h, weights[dof]):
                stiff += 1
                row = max(row, law_row_size(P, block + HEAD))
        if loaded:
            mj_free_stack(d)
        if stiff == 0 or F != F:
            return
        mj_mark_stack(d)
        blocks, W = mj_stack_numbers(d, stiff), mj_stack_numbers(d, stiff * stiff)
        units, columns = mj_stack_numbers(d, stiff * nv), mj_stack_numbers(d, stiff * nv)
        Y = mj_stack_numbers(d, 3 * stiff + row)
        for i in range(stiff * nv):
            units[i] = 0.0
        k = 0
        for i in range(n):
            block = int(address[i])
            if P[block] != MAGIC or P[block + RESOLVED] != 1.0:
                continue
            dof = int(P[block + DOF])
            if is_stiff(P, block + HEAD, X, int(P[block + ROW]), h, weights[dof]):
                blocks[k] = float(block)
                units[nv * k + dof] = 1.0
                k += 1
        mj_solve_m(m, d, columns, units, stiff)
        between(P, blocks, stiff, columns, nv, W)
        late_settle(P, blocks, stiff, X, h, W, Y)
        for i in range(stiff):
            passive[int(P[int(blocks[i]) + DOF])] -= Y[i]
        mj_free_stack(d)

    return native


def link_what_acts(model: mujoco.MjModel, blocks: Iterable[int]) -> None:
    """Compile or load now what the native callback will need for these blocks of a model."""
    P, h = model.numeric_data, model.opt.timestep
    for block in blocks:
        link_law(P, block + HEAD)
        if P[block + int(P[block + EFFECTS])] > 0.0:
            link(late_joint_effects)
        K, damping = presliding(P, block + HEAD)
        if h * (h * K + damping) * model.dof_invweight0[int(P[block + DOF])] > STIFF:
            link(late_settle)


def python_callback(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """The same callback in Python: slower, but every line can be stepped through."""
    P, X = model.numeric_data, data.userdata
    if lacks_room(model, data):
        warn_of_no_room(model._address)
        return
    step = model.opt.timestep
    h = 0.0 if model.opt.integrator == RK4 else step
    stiff: list[int] = []
    bias, moved = np.zeros(model.nv), np.zeros(model.nv)
    loaded = False
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
        last = model.M_rowadr[dof] + model.M_rownnz[dof] - 1
        later = X[x + T_EVALUATED] != t
        F = torque_now(P, block + HEAD, effects, X, x, t, q, v, step)
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
            own, load = data.M[last], 0.0
            loads = asks_for_load(P, effects)
            if loads >= 0:
                if not loaded:
                    loaded = True
                    mujoco.mj_rne(model, data, 0, bias)
                    mujoco.mj_mulM(model, data, moved, data.qacc)
                others = moved[dof] - own * data.qacc[dof] - data.qfrc_constraint[dof]
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
        if F != F:
            return
        if is_stiff(P, block + HEAD, X, x, h, model.dof_invweight0[dof]):
            stiff.append(block)
    if not stiff:
        return
    k, nv = len(stiff), model.nv
    dofs = [int(P[block + DOF]) for block in stiff]
    units, columns = np.zeros((k, nv)), np.zeros((k, nv))
    units[np.arange(k), dofs] = 1.0
    mujoco.mj_solveM(model, data, columns, units)
    blocks, W = np.array(stiff, dtype=np.float64), np.empty(k * k)
    Y = np.empty(3 * k + max(int(law_row_size(P, block + HEAD)) for block in stiff))
    between(P, blocks, k, columns.reshape(-1), nv, W)
    settle(P, blocks, k, X, h, W, Y)
    data.qfrc_passive[dofs] -= Y[:k]
