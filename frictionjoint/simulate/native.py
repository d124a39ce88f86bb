"""The passive callback in C: MuJoCo calls it with the addresses of a model and its data.

The offsets of their fields are known after the process has loaded its MuJoCo. They are kept in a
table (``simulate.layout`` verifies it against a live model).
"""

import ctypes
import functools
from typing import Any

import mujoco

from frictionjoint.compiled import Table, compiled, entry_point, external
from frictionjoint.simulate.carrier import DOF, EFFECTS, HEAD, JOINT, MAGIC, QPOS, RESOLVED, ROW
from frictionjoint.simulate.fast_step import joint_torque
from frictionjoint.simulate.implicit_mass import put_in, take_back
from frictionjoint.simulate.joint_effects import asks_for_load, coupled_load, joint_effects
from frictionjoint.simulate.layout import offsets
from frictionjoint.simulate.motor_demand import commanded_torque, gives_less
from frictionjoint.simulate.pointers import (
    Address,
    bind_mujoco,
    flags,
    mj_factorM,
    mj_freeStack,
    mj_markStack,
    mj_mulM,
    mj_projectConstraint,
    mj_rne,
    mj_stackAllocNum,
    reals,
    reals_in,
    shorts,
    shorts_in,
    wholes_in,
)
from frictionjoint.simulate.resolve_when_stepped import (
    bind_python,
    make_ready_in_c,
    warn_of_no_room_in_c,
)
from frictionjoint.simulate.row import BASE, T_EVALUATED
from frictionjoint.simulate.shaft_wave import SHAFT, resist

PGS = int(mujoco.mjtSolver.mjSOL_PGS)
# its four evaluations a step are no steps of their own: friction stays explicit
RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)

_OF_MODEL = (
    "nv",
    "nnumeric",
    "numeric_adr",
    "numeric_data",
    "timestep",
    "integrator",
    "dof_invweight0",
    "dof_armature",
    "gravity",
    "jnt_bodyid",
    "jnt_axis",
    "M_rowadr",
    "M_rownnz",
    "nuserdata",
    "nu",
    "nactuator",
    "actuator_ctrladr",
    "actuator_ctrlnum",
    "actuator_outadr",
    "disableflags",
    "disableactuator",
    "actuator_trntype",
    "actuator_trnid",
    "actuator_group",
    "actuator_gear",
    "actuator_gainprm",
    "actuator_biasprm",
    "actuator_ctrllimited",
    "actuator_ctrlrange",
    "solver",
    "noslip_iterations",
    "dof_Madr",
)
_OF_DATA = (
    "M",
    "xmat",
    "xaxis",
    "time",
    "qpos",
    "qvel",
    "qfrc_passive",
    "userdata",
    "sensordata",
    "qacc",
    "qfrc_constraint",
    "ctrl",
    "nefc",
    "arena",
    "parena",
    "efc_Y_rownnz",
    "efc_Y",
    "efc_AR_rownnz",
    "efc_AR",
    "qM",
    "iM",
    "iLD",
    "iLDiagInv",
    "qLD",
    "qLDiagInv",
    "iM_rowadr",
    "map_idof2dof",
    "nidof",
)
(
    M_NV,
    M_NNUMERIC,
    M_NUMERIC_ADR,
    M_NUMERIC_DATA,
    M_TIMESTEP,
    M_INTEGRATOR,
    M_DOF_INVWEIGHT0,
    M_DOF_ARMATURE,
    M_GRAVITY,
    M_JNT_BODYID,
    M_JNT_AXIS,
    M_MASS_ROWADR,
    M_MASS_ROWNNZ,
    M_NUSERDATA,
    M_NU,
    M_NACTUATOR,
    M_ACTUATOR_CTRLADR,
    M_ACTUATOR_CTRLNUM,
    M_ACTUATOR_OUTADR,
    M_DISABLEFLAGS,
    M_DISABLEACTUATOR,
    M_ACTUATOR_TRNTYPE,
    M_ACTUATOR_TRNID,
    M_ACTUATOR_GROUP,
    M_ACTUATOR_GEAR,
    M_ACTUATOR_GAINPRM,
    M_ACTUATOR_BIASPRM,
    M_ACTUATOR_CTRLLIMITED,
    M_ACTUATOR_CTRLRANGE,
    M_SOLVER,
    M_NOSLIP_ITERATIONS,
    M_DOF_MADR,
    D_M,
    D_XMAT,
    D_XAXIS,
    D_TIME,
    D_QPOS,
    D_QVEL,
    D_QFRC_PASSIVE,
    D_USERDATA,
    D_SENSORDATA,
    D_QACC,
    D_QFRC_CONSTRAINT,
    D_CTRL,
    D_NEFC,
    D_ARENA,
    D_PARENA,
    D_EFC_Y_ROWNNZ,
    D_EFC_Y,
    D_EFC_AR_ROWNNZ,
    D_EFC_AR,
    D_QM,
    D_IM,
    D_ILD,
    D_ILDIAGINV,
    D_QLD,
    D_QLDIAGINV,
    D_IM_ROWADR,
    D_MAP_IDOF2DOF,
    D_NIDOF,
) = range(len(_OF_MODEL) + len(_OF_DATA))
# the projection of the constraints, whichever of them this MuJoCo has
PROJECTED = ("efc_Y_rownnz", "efc_Y", "efc_AR_rownnz", "efc_AR")
_D_PROJECTED = (D_EFC_Y_ROWNNZ, D_EFC_Y, D_EFC_AR_ROWNNZ, D_EFC_AR)
_CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
AT = Table("offsets", len(_OF_MODEL) + len(_OF_DATA))
"""Bytes from the beginning of mjModel and mjData; 0 for a field that this MuJoCo lacks."""


@compiled
def native(m: Address, d: Address) -> None:
    """Subtract the friction of a model's joints from ``qfrc_passive``; see ``python_callback``."""
    n = int(wholes_in(m, AT[M_NNUMERIC])[0])
    if n == 0:
        return
    there = wholes_in(d, AT[D_SENSORDATA])[0] - wholes_in(d, AT[D_USERDATA])[0]
    if there < 8 * wholes_in(m, AT[M_NUSERDATA])[0]:
        warn_of_no_room_in_c(m)
        return
    address, P = shorts(m, AT[M_NUMERIC_ADR]), reals(m, AT[M_NUMERIC_DATA])
    qpos, qvel = reals(d, AT[D_QPOS]), reals(d, AT[D_QVEL])
    passive, X = reals(d, AT[D_QFRC_PASSIVE]), reals(d, AT[D_USERDATA])
    t = reals_in(d, AT[D_TIME])[0]
    step = reals_in(m, AT[M_TIMESTEP])[0]
    h = step
    if shorts_in(m, AT[M_INTEGRATOR])[0] == RK4:
        h = 0.0
    weights = reals(m, AT[M_DOF_INVWEIGHT0])
    nv = int(wholes_in(m, AT[M_NV])[0])
    M = reals(d, AT[D_M])
    first_of, count_of = shorts(m, AT[M_MASS_ROWADR]), shorts(m, AT[M_MASS_ROWNNZ])
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
                block = int(address[i])
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
        F = joint_torque(P, block + HEAD, effects, X, x, t, q, v, step, h, own, weights[dof])
        if P[effects] > 0.0:
            joint = int(P[block + JOINT])
            commanded = 0.0
            if gives_less(P, effects):
                # until MuJoCo 3.12 each actuator has one control and one output, of its number
                apart = AT[M_NACTUATOR] != 0
                commanded = commanded_torque(
                    joint,
                    q,
                    v,
                    int(wholes_in(m, AT[M_NACTUATOR] if apart else AT[M_NU])[0]),
                    apart,
                    shorts(m, AT[M_ACTUATOR_CTRLADR]),
                    shorts(m, AT[M_ACTUATOR_CTRLNUM]),
                    shorts(m, AT[M_ACTUATOR_OUTADR]),
                    int(shorts_in(m, AT[M_DISABLEFLAGS])[0]),
                    int(shorts_in(m, AT[M_DISABLEACTUATOR])[0]),
                    shorts(m, AT[M_ACTUATOR_TRNTYPE]),
                    shorts(m, AT[M_ACTUATOR_TRNID]),
                    shorts(m, AT[M_ACTUATOR_GROUP]),
                    reals(m, AT[M_ACTUATOR_GEAR]),
                    reals(m, AT[M_ACTUATOR_GAINPRM]),
                    reals(m, AT[M_ACTUATOR_BIASPRM]),
                    flags(m, AT[M_ACTUATOR_CTRLLIMITED]),
                    reals(m, AT[M_ACTUATOR_CTRLRANGE]),
                    reals(d, AT[D_CTRL]),
                )
            load = 0.0
            loads = asks_for_load(P, effects)
            if loads >= 0:
                if not loaded:
                    loaded = True
                    mj_markStack(d)
                    bias, moved = mj_stackAllocNum(d, nv), mj_stackAllocNum(d, nv)
                    mj_rne(m, d, 0, bias)
                    qacc = reals(d, AT[D_QACC])
                    mj_mulM(m, d, moved, qacc)
                    for k in range(nv):  # friction changes the diagonal entries
                        moved[k] -= M[int(first_of[k] + count_of[k]) - 1] * qacc[k]
                others = moved[dof] - reals(d, AT[D_QFRC_CONSTRAINT])[dof]
                load = bias[dof]
                load += coupled_load(P, block + HEAD, X, x, loads, later, others)
            F += joint_effects(
                P,
                block,
                X,
                t,
                q,
                v,
                load,
                own - reals(m, AT[M_DOF_ARMATURE])[dof],
                reals(m, AT[M_DOF_ARMATURE])[dof],
                joint,
                reals(m, AT[M_JNT_AXIS]),
                reals(d, AT[D_XAXIS]),
                reals_in(m, AT[M_GRAVITY]),
                reals(d, AT[D_XMAT]),
                int(shorts(m, AT[M_JNT_BODYID])[joint]),
                commanded,
            )
        passive[dof] -= F
        if put_in(X, x, M, entry, h):
            changed = True
            if AT[D_IM] != 0:
                second = int(shorts(m, AT[M_DOF_MADR])[dof])
                reals(d, AT[D_QM])[second] = M[entry]
        if F != F:
            break  # gone astray: MuJoCo resets the whole state
    if loaded:
        mj_freeStack(d)
    if not changed:
        return
    mj_factorM(m, d)
    if AT[D_IM] != 0 and wholes_in(d, AT[D_IM])[0] != 0:
        factor, diagonal = reals(d, AT[D_QLD]), reals(d, AT[D_QLDIAGINV])
        island_mass = reals(d, AT[D_IM])
        island_factor = reals(d, AT[D_ILD])
        island_diagonal = reals(d, AT[D_ILDIAGINV])
        row, dof_of = shorts(d, AT[D_IM_ROWADR]), shorts(d, AT[D_MAP_IDOF2DOF])
        for i in range(int(shorts_in(d, AT[D_NIDOF])[0])):
            dof = int(dof_of[i])
            island_diagonal[i] = diagonal[dof]
            for k in range(int(count_of[dof])):
                island_mass[int(row[i]) + k] = M[int(first_of[dof]) + k]
                island_factor[int(row[i]) + k] = factor[int(first_of[dof]) + k]
    if shorts_in(d, AT[D_NEFC])[0] == 0:
        return
    if shorts_in(m, AT[M_SOLVER])[0] == PGS or shorts_in(m, AT[M_NOSLIP_ITERATIONS])[0] > 0:
        # the projection that the position stage made goes: it is the last in the arena
        lowest = 0
        for which in _D_PROJECTED:
            begin = int(wholes_in(d, AT[which])[0]) if AT[which] != 0 else 0
            if begin != 0 and (lowest == 0 or begin < lowest):
                lowest = begin
        if lowest != 0:
            wholes_in(d, AT[D_PARENA])[0] = lowest - int(wholes_in(d, AT[D_ARENA])[0])
        mj_projectConstraint(m, d)


@external
def first_callback(m: Address, d: Address) -> None:
    """The callback that a user had installed before."""


@compiled
def both(m: Address, d: Address) -> None:
    """A user's own C callback, then ours."""
    first_callback(m, d)
    native(m, d)


def build_both(first: int) -> Any:
    """The callback `both`, as a ctypes function of its own.

    Args:
        first: address of the user's callback; there is one for the process.
    """
    build_native()
    first_callback.bind(first)
    return _CALLBACK(entry_point(both))


@functools.cache
def build_native() -> Any:
    """The callback for this process's MuJoCo, as a ctypes function.

    Raises:
        LayoutMismatchError: the structures differ from MuJoCo's own listing.
    """
    model_at, data_at = offsets()
    AT.numbers[:] = [
        *(model_at.get(name, 0) for name in _OF_MODEL),
        *(data_at.get(name, 0) for name in _OF_DATA),
    ]
    bind_mujoco(
        mj_factorM,
        mj_freeStack,
        mj_markStack,
        mj_mulM,
        mj_projectConstraint,
        mj_rne,
        mj_stackAllocNum,
    )
    bind_python()
    return _CALLBACK(entry_point(native))
