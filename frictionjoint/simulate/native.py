"""The passive callback, in C and in Python.

MuJoCo calls it in C with the addresses of a model and its data; the offsets of their fields
(``simulate.layout``) are known after the process has loaded its MuJoCo. In Python the same code has
MjModel and MjData for addresses, and their attributes for offsets. It is stateless: parameters are
read from the model's numerics, state from the data's userdata.
"""

import ctypes
import functools
import types
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled, entry_point, external, in_line, pointer
from frictionjoint.simulate.block import DOF, EFFECTS, HEAD, JOINT, MAGIC, QPOS, RESOLVED, ROW
from frictionjoint.simulate.fast_step import usual_torque
from frictionjoint.simulate.joint_effects import (
    asks_for_load,
    coupled_load,
    effects_torque,
    unit_gravity,
)
from frictionjoint.simulate.layout import DATA_NAMES, MODEL_NAMES, offsets, structure
from frictionjoint.simulate.motor import commanded_torque, gives_less
from frictionjoint.simulate.pointers import (
    AT,
    DATA,
    MODEL,
    Address,
    bind_mujoco,
    mj_applyFT,
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
from frictionjoint.simulate.resolve_when_stepped import bind_python, make_ready, warn_of_no_room
from frictionjoint.simulate.row import BASE, GAIN, T_EVALUATED, TORQUE, WRITTEN, rare_torque
from frictionjoint.simulate.shaft_wave import SHAFT, resist

PGS = int(mujoco.mjtSolver.mjSOL_PGS)
# its four evaluations a step are no steps of their own: friction stays explicit
RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)
# the projection of the constraints, whichever of them this MuJoCo has
PROJECTED = ("efc_Y_rownnz", "efc_Y", "efc_AR_rownnz", "efc_AR")
_D_PROJECTED = tuple(getattr(DATA, name) for name in PROJECTED)
CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)


@in_line
def lacks_room(m: Address, d: Address) -> bool:
    """Whether data were made before their model got room for friction."""
    there = wholes_in(d, AT[DATA.sensordata])[0] - wholes_in(d, AT[DATA.userdata])[0]
    return bool(there < 8 * wholes_in(m, AT[MODEL.nuserdata])[0])


@in_line
def give_back_projection(d: Address) -> None:
    """Free the projection of the constraints made before, which is the last in the arena."""
    lowest = 0
    for k in range(len(_D_PROJECTED)):
        at = AT[_D_PROJECTED[k]]
        begin = int(wholes_in(d, at)[0]) if at != 0 else 0
        if begin != 0 and (lowest == 0 or begin < lowest):
            lowest = begin
    if lowest != 0:
        wholes_in(d, AT[DATA.parena])[0] = lowest - int(wholes_in(d, AT[DATA.arena])[0])


@compiled
def outside(m: Address, d: Address, nv: int, result: Vector) -> None:
    """Joint torques of the forces and torques that a user applies to bodies, N m."""
    forces, centres = reals(d, AT[DATA.xfrc_applied]), reals(d, AT[DATA.xipos])
    for k in range(nv):
        result[k] = 0.0
    for body in range(1, int(wholes_in(m, AT[MODEL.nbody])[0])):
        force, torque = pointer(forces, 6 * body), pointer(forces, 6 * body + 3)
        for k in range(3):
            if force[k] != 0.0 or torque[k] != 0.0:
                mj_applyFT(m, d, force, torque, pointer(centres, 3 * body), body, result)
                break


@compiled
def native(m: Address, d: Address) -> None:
    """Subtract the friction of a model's joints from ``qfrc_passive``."""
    n = int(wholes_in(m, AT[MODEL.nnumeric])[0])
    if n == 0:
        return
    if lacks_room(m, d):
        warn_of_no_room(m)
        return
    address, P = shorts(m, AT[MODEL.numeric_adr]), reals(m, AT[MODEL.numeric_data])
    qpos, qvel = reals(d, AT[DATA.qpos]), reals(d, AT[DATA.qvel])
    passive, X = reals(d, AT[DATA.qfrc_passive]), reals(d, AT[DATA.userdata])
    t = reals_in(d, AT[DATA.time])[0]
    step = reals_in(m, AT[MODEL.timestep])[0]
    h = step
    if shorts_in(m, AT[MODEL.integrator])[0] == RK4:
        h = 0.0
    weights, locked = reals(m, AT[MODEL.dof_invweight0]), reals(m, AT[MODEL.dof_M0])
    nv = int(wholes_in(m, AT[MODEL.nv])[0])
    M = reals(d, AT[DATA.M])
    first_of, count_of = shorts(m, AT[MODEL.M_rowadr]), shorts(m, AT[MODEL.M_rownnz])
    changed = False
    loaded = False
    bias = moved = qvel
    for i in range(n):
        block = int(address[i])
        if P[block] != MAGIC and P[block] != SHAFT:
            continue
        if P[block + RESOLVED] != 1.0:
            if P[block + RESOLVED] == 0.0:
                make_ready(m)
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
        law, effects = block + HEAD, block + int(P[block + EFFECTS])
        later = X[x + T_EVALUATED] != t
        entry = int(first_of[dof] + count_of[dof]) - 1
        # without friction, see `simulate.row`
        written = M[entry]
        if written == X[x + WRITTEN]:
            M[entry] = X[x + BASE]
        own = M[entry]
        X[x + BASE] = own
        X[x + WRITTEN] = written
        # MuJoCo knows the joint's inertia with all others free at qpos0 only
        weight = weights[dof] * locked[dof] / own
        F = usual_torque(P, law, effects, X, x, t, q, v, h, own, weight)
        if F != F:
            F = rare_torque(P, law, effects, X, x, t, q, v, step, h, own, weight)
        if P[effects] > 0.0:
            joint = int(P[block + JOINT])
            commanded = commanded_torque(m, d, joint, q, v) if gives_less(P, effects) else 0.0
            load = 0.0
            loads = asks_for_load(P, effects)
            if loads >= 0:
                if not loaded:
                    loaded = True
                    mj_markStack(d)
                    bias, moved = mj_stackAllocNum(d, nv), mj_stackAllocNum(d, nv)
                    mj_rne(m, d, 0, bias)
                    outside(m, d, nv, moved)
                    for k in range(nv):
                        bias[k] -= moved[k]
                    qacc = reals(d, AT[DATA.qacc])
                    mj_mulM(m, d, moved, qacc)
                    for k in range(nv):  # friction changes the diagonal entries
                        moved[k] -= M[int(first_of[k] + count_of[k]) - 1] * qacc[k]
                others = moved[dof] - reals(d, AT[DATA.qfrc_constraint])[dof]
                load = bias[dof]
                load += coupled_load(P, law, X, x, loads, later, others)
            gx, gy = unit_gravity(
                reals(m, AT[MODEL.jnt_axis]),
                reals(d, AT[DATA.xaxis]),
                3 * joint,
                reals_in(m, AT[MODEL.gravity]),
                reals(d, AT[DATA.xmat]),
                9 * int(shorts(m, AT[MODEL.jnt_bodyid])[joint]),
            )
            rotor = reals(m, AT[MODEL.dof_armature])[dof]
            raised = effects_torque(
                P, law, effects, X, x, t, q, v, load, own - rotor, rotor, gx, gy, commanded
            )
            if F == F:
                F = X[x + TORQUE] + X[x + GAIN] * v + raised
        passive[dof] -= F
        M[entry] = own + h * X[x + GAIN]
        if M[entry] != written:
            changed = True
            X[x + WRITTEN] = M[entry]
            if AT[DATA.iM] != 0:
                second = int(shorts(m, AT[MODEL.dof_Madr])[dof])
                reals(d, AT[DATA.qM])[second] = M[entry]
        if F != F:
            break  # gone astray: MuJoCo resets the whole state
    if loaded:
        mj_freeStack(d)
    if not changed:
        return
    mj_factorM(m, d)
    if AT[DATA.iM] != 0 and wholes_in(d, AT[DATA.iM])[0] != 0:
        factor, diagonal = reals(d, AT[DATA.qLD]), reals(d, AT[DATA.qLDiagInv])
        island_mass = reals(d, AT[DATA.iM])
        island_factor = reals(d, AT[DATA.iLD])
        island_diagonal = reals(d, AT[DATA.iLDiagInv])
        row, dof_of = shorts(d, AT[DATA.iM_rowadr]), shorts(d, AT[DATA.map_idof2dof])
        for i in range(int(shorts_in(d, AT[DATA.nidof])[0])):
            dof = int(dof_of[i])
            island_diagonal[i] = diagonal[dof]
            for k in range(int(count_of[dof])):
                island_mass[int(row[i]) + k] = M[int(first_of[dof]) + k]
                island_factor[int(row[i]) + k] = factor[int(first_of[dof]) + k]
    if shorts_in(d, AT[DATA.nefc])[0] == 0:
        return
    if shorts_in(m, AT[MODEL.solver])[0] == PGS or shorts_in(m, AT[MODEL.noslip_iterations])[0] > 0:
        give_back_projection(d)
        mj_projectConstraint(m, d)


@external
def first_callback(m: Address, d: Address) -> None:
    """The callback that a user had installed before."""


@compiled
def both(m: Address, d: Address) -> None:
    """A user's own C callback, then ours."""
    first_callback(m, d)
    native(m, d)


def build_both(first: Any) -> Any:
    """The callback `both` with a user's C callback, one for the process."""
    build_native()
    first_callback.bind(first)
    return CALLBACK(entry_point(both))


@functools.cache
def build_native() -> Any:
    """The callback for this process's MuJoCo, as a ctypes function.

    Raises:
        LayoutMismatchError: the structures differ from MuJoCo's own listing.
    """
    model_at, data_at = offsets()
    AT.numbers[:] = [
        *(model_at.get(name, 0) for name in MODEL_NAMES),
        *(data_at.get(name, 0) for name in DATA_NAMES),
    ]
    bind_mujoco()
    bind_python()
    return CALLBACK(entry_point(native))


def _field(owner: Any, name: Any) -> Any:
    """An attribute as an array of one index; empty where this MuJoCo lacks it, which is 0."""
    if name == 0:
        return np.zeros(0, dtype=np.int32)
    return np.ravel(getattr(owner if hasattr(owner, name) else owner.opt, name))


def _whole(owner: Any, name: Any) -> list[Any]:
    """A number of the structure; of an array, in place of its address, the size."""
    value = getattr(owner, name)
    return [value.size if isinstance(value, np.ndarray) else value]


def _give_back_projection(data: mujoco.MjData) -> None:
    """`give_back_projection`; its fields are no attributes."""
    fields = structure("mjData").from_address(data._address)
    begins = [getattr(fields, name, None) for name in PROJECTED]
    lowest = min((begin for begin in begins if begin), default=None)
    if lowest is not None:
        fields.parena = lowest - fields.arena


def _names(names: tuple[str, ...], *owners: type) -> list[Any]:
    return [name if any(hasattr(owner, name) for owner in owners) else 0 for name in names]


_IN_PYTHON: dict[str, Any] = {
    "AT": [
        *_names(MODEL_NAMES, mujoco.MjModel, mujoco.MjOption),
        *_names(DATA_NAMES, mujoco.MjData),
    ],
    **dict.fromkeys(("reals", "shorts", "reals_in", "shorts_in"), _field),
    "wholes_in": _whole,
    "flags": lambda owner, name: _field(owner, name).view(np.bool_),
    "lacks_room": lambda model, data: len(data.userdata) < int(model.nuserdata),
    "give_back_projection": _give_back_projection,
    "warn_of_no_room": lambda model: warn_of_no_room(model._address),
    "make_ready": lambda model: make_ready(model._address),
    **{n: getattr(mujoco, n) for n in ("mj_factorM", "mj_mulM", "mj_projectConstraint", "mj_rne")},
    # Python passes a whole array where C passes its beginning
    "mj_applyFT": lambda m, d, *xs: mujoco.mj_applyFT(m, d, *(x[:3] for x in xs[:3]), *xs[3:]),
    "mj_stackAllocNum": lambda data, n: np.zeros(n),
    # Python's own memory needs no mark
    **dict.fromkeys(("mj_markStack", "mj_freeStack"), lambda data: None),
}


def _in_python(kernel: Any, name: str, **more: Any) -> Any:
    """A kernel of addresses as a function of MuJoCo's own objects."""
    code, names = kernel.py_func.__code__, kernel.py_func.__globals__
    return types.FunctionType(code, {**names, **_IN_PYTHON, **more}, name)


python_callback: Callable[[mujoco.MjModel, mujoco.MjData], None] = _in_python(
    native,
    "python_callback",
    outside=_in_python(outside, "outside"),
    commanded_torque=_in_python(commanded_torque, "commanded_torque"),
)
"""The callback in Python: slower than in C, but every line can be stepped through."""
