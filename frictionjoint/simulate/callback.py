"""The passive-force callback: native (a numba C function) and readable (Python), one kernel.

Both keep nothing: parameters are read from the model's numerics, state from the data's userdata,
through the two pointers MuJoCo hands over. A model without friction costs a look at its numerics.
"""

import ctypes
import functools
import os
from collections.abc import Callable
from typing import Any, cast

import mujoco
import numpy as np
from llvmlite import binding
from numba import carray, cfunc, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

from frictionjoint.arrays import Vector
from frictionjoint.effects.kernel import MEMORY, total_torque
from frictionjoint.effects.signals import DT, GX, GY, LOAD, N_SIGNALS, TEMP, TIME, A, H, Q, V
from frictionjoint.law.kernel import coulomb_level, hysteresis_torque
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
from frictionjoint.simulate.layout import offsets
from frictionjoint.simulate.row import (
    FRONT,
    T_COMMITTED,
    V_COMMITTED,
    evaluate,
)
from frictionjoint.simulate.together import between, is_stiff, settle

# its four evaluations a step are no steps of their own
RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)


@intrinsic
def _inttoptr(typing_context: Any, address: Any) -> tuple[Any, Any]:
    """An integer address as a pointer."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


# the typing context is numba's own business: compiled code passes the address alone
_pointer = cast("Callable[[int], ctypes.c_void_p]", _inttoptr)


@functools.lru_cache(maxsize=1)
def _load_library() -> None:
    """Let compiled code find MuJoCo's own functions by name, so that it can be cached."""
    folder = os.path.dirname(mujoco.__file__)
    library = next(f for f in sorted(os.listdir(folder)) if "libmujoco" in f or f == "mujoco.dll")
    binding.load_library_permanently(os.path.join(folder, library))


_load_library()
_mj_rne = cast(
    "Callable[[ctypes.c_void_p, ctypes.c_void_p, int, ctypes.c_void_p], None]",
    types.ExternalFunction(
        "mj_rne", types.void(types.voidptr, types.voidptr, types.int32, types.voidptr)
    ),
)

_mj_solve_m = cast(
    "Callable[[ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, int], None]",
    types.ExternalFunction(
        "mj_solveM",
        types.void(types.voidptr, types.voidptr, types.voidptr, types.voidptr, types.int32),
    ),
)


@njit(cache=True)
def effects_torque(
    P: Vector,
    p: int,
    effects: int,
    X: Vector,
    x: int,
    t: float,
    q: float,
    v: float,
    F: float,
    bias: float,
    inertia: float,
    gx: float,
    gy: float,
) -> float:
    """Torque of a block's effects at one instant; the memory written is the evaluated one.

    The load is the rigid body's torque at this joint: bias forces plus the joint's own inertia
    times the acceleration since the committed point.
    """
    sig = np.zeros(N_SIGNALS)
    dt = t - X[x + T_COMMITTED]
    sig[TIME] = t
    sig[Q] = q
    sig[V] = v
    sig[A] = (v - X[x + V_COMMITTED]) / dt if dt > 0.0 else 0.0
    sig[LOAD] = bias + inertia * sig[A]
    sig[GX] = gx
    sig[GY] = gy
    sig[DT] = dt
    sig[TEMP] = np.nan  # a simulation has no thermometer
    law = x + FRONT
    sig[H] = hysteresis_torque(P, p, X, law) / coulomb_level(P, p)
    n = MEMORY * int(P[effects])
    memory = law + law_row_size(P, p)
    for i in range(n):
        X[memory + n + i] = X[memory + i]
    return total_torque(P, effects, sig, X, memory + n)


def build_native() -> Any:
    """The C function for this MuJoCo build; compiled code is cached by numba."""
    model_at, data_at = offsets()
    # closure variables are part of numba's cache key: another layout compiles anew
    at_nv, at_nnumeric = model_at["nv"] // 8, model_at["nnumeric"] // 8
    at_adr, at_numeric = model_at["numeric_adr"] // 8, model_at["numeric_data"] // 8
    at_gravity = model_at["gravity"] // 8
    at_step, at_integrator = model_at["timestep"] // 8, model_at["integrator"] // 4
    at_body, at_axis = model_at["jnt_bodyid"] // 8, model_at["jnt_axis"] // 8
    at_rowadr, at_rownnz = model_at["M_rowadr"] // 8, model_at["M_rownnz"] // 8
    at_weight = model_at["dof_invweight0"] // 8
    at_time, at_qpos, at_qvel = (data_at[k] // 8 for k in ("time", "qpos", "qvel"))
    at_passive, at_user = data_at["qfrc_passive"] // 8, data_at["userdata"] // 8
    at_mass, at_xmat, at_xaxis = (data_at[k] // 8 for k in ("M", "xmat", "xaxis"))

    @njit(cache=True)
    def with_effects(
        m: ctypes.c_void_p,
        d: ctypes.c_void_p,
        P: Vector,
        block: int,
        X: Vector,
        x: int,
        t: float,
        q: float,
        v: float,
        F: float,
    ) -> float:
        model = carray(m, (1,), np.int64)
        model_f = carray(m, (1,), np.float64)
        data = carray(d, (1,), np.int64)
        dof, joint = int(P[block + DOF]), int(P[block + JOINT])
        nv = model[at_nv]
        bias = np.zeros(nv)
        _mj_rne(m, d, 0, _pointer(bias.ctypes.data))
        rowadr = carray(_pointer(model[at_rowadr]), (nv,), np.int32)
        rownnz = carray(_pointer(model[at_rownnz]), (nv,), np.int32)
        mass = carray(_pointer(data[at_mass]), (1,), np.float64)
        inertia = mass[rowadr[dof] + rownnz[dof] - 1]
        body = carray(_pointer(model[at_body]), (joint + 1,), np.int32)[joint]
        axis = carray(_pointer(model[at_axis]), (1,), np.float64)
        world = carray(_pointer(data[at_xaxis]), (1,), np.float64)
        R = carray(_pointer(data[at_xmat]), (1,), np.float64)
        gx, gy = unit_gravity(
            axis[3 * joint],
            axis[3 * joint + 1],
            axis[3 * joint + 2],
            world[3 * joint],
            world[3 * joint + 1],
            world[3 * joint + 2],
            model_f[at_gravity],
            model_f[at_gravity + 1],
            model_f[at_gravity + 2],
            R,
            9 * body,
        )
        effects = block + int(P[block + EFFECTS])
        return effects_torque(
            P, block + HEAD, effects, X, x, t, q, v, F, bias[dof], inertia, gx, gy
        )

    @cfunc(types.void(types.voidptr, types.voidptr), cache=True)
    def native(m: ctypes.c_void_p, d: ctypes.c_void_p) -> None:
        model = carray(m, (1,), np.int64)
        n = model[at_nnumeric]
        if n == 0:
            return
        data = carray(d, (1,), np.int64)
        address = carray(_pointer(model[at_adr]), (n,), np.int32)
        P = carray(_pointer(model[at_numeric]), (1,), np.float64)
        qpos = carray(_pointer(data[at_qpos]), (1,), np.float64)
        qvel = carray(_pointer(data[at_qvel]), (1,), np.float64)
        passive = carray(_pointer(data[at_passive]), (1,), np.float64)
        X = carray(_pointer(data[at_user]), (1,), np.float64)
        t = carray(d, (1,), np.float64)[at_time]
        h = carray(m, (1,), np.float64)[at_step]
        if carray(m, (1,), np.int32)[at_integrator] == RK4:
            h = 0.0
        nv = model[at_nv]
        weights = carray(_pointer(model[at_weight]), (nv,), np.float64)
        stiff = 0
        for i in range(n):
            block = address[i]
            if P[block] != MAGIC or P[block + RESOLVED] != 1.0:
                continue
            x = int(P[block + ROW])
            q = qpos[int(P[block + QPOS])]
            dof = int(P[block + DOF])
            v = qvel[dof]
            effects = block + int(P[block + EFFECTS])
            F = evaluate(P, block + HEAD, effects, X, x, t, q, v, 0.0, 0.0)
            if P[effects] > 0.0:
                F += with_effects(m, d, P, block, X, x, t, q, v, F)
            passive[dof] -= F
            if F != F:
                return  # gone astray: MuJoCo resets the whole state
            if is_stiff(P, block + HEAD, X, x, h, weights[dof]):
                stiff += 1
        if stiff == 0:
            return
        blocks = np.empty(stiff, np.int64)
        units, columns = np.zeros((stiff, nv)), np.zeros((stiff, nv))
        k = 0
        for i in range(n):
            block = address[i]
            if P[block] != MAGIC or P[block + RESOLVED] != 1.0:
                continue
            dof = int(P[block + DOF])
            if is_stiff(P, block + HEAD, X, int(P[block + ROW]), h, weights[dof]):
                blocks[k] = block
                units[k, dof] = 1.0
                k += 1
        _mj_solve_m(m, d, _pointer(columns.ctypes.data), _pointer(units.ctypes.data), stiff)
        more = settle(P, blocks, X, h, between(P, blocks, columns))
        for i in range(stiff):
            passive[int(P[blocks[i] + DOF])] -= more[i]

    return native


@njit(cache=True)
def unit_gravity(
    ax: float,
    ay: float,
    az: float,
    wx: float,
    wy: float,
    wz: float,
    gx: float,
    gy: float,
    gz: float,
    R: Vector,
    r: int,
) -> tuple[float, float]:
    """Torque to hold 1 kg at 1 m along each of the body's two axes across the joint.

    (ax, ay, az) the joint's axis in the body, (wx, wy, wz) in the world, (gx, gy, gz) gravity,
    R[r:r+9] the body's rotation. The two axes are those of ``identify.rigid_body``.
    """
    # helper: the coordinate axis the joint's axis leans on least
    hx = hy = hz = 0.0
    if abs(ax) <= abs(ay) and abs(ax) <= abs(az):
        hx = 1.0
    elif abs(ay) <= abs(az):
        hy = 1.0
    else:
        hz = 1.0
    e1x, e1y, e1z = ay * hz - az * hy, az * hx - ax * hz, ax * hy - ay * hx
    norm = (e1x * e1x + e1y * e1y + e1z * e1z) ** 0.5
    e1x, e1y, e1z = e1x / norm, e1y / norm, e1z / norm
    e2x, e2y, e2z = ay * e1z - az * e1y, az * e1x - ax * e1z, ax * e1y - ay * e1x
    tx, ty, tz = gy * wz - gz * wy, gz * wx - gx * wz, gx * wy - gy * wx
    bx = tx * R[r] + ty * R[r + 3] + tz * R[r + 6]
    by = tx * R[r + 1] + ty * R[r + 4] + tz * R[r + 7]
    bz = tx * R[r + 2] + ty * R[r + 5] + tz * R[r + 8]
    return (
        -(bx * e1x + by * e1y + bz * e1z),
        -(bx * e2x + by * e2y + bz * e2z),
    )


def python_callback(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """The same callback in Python: slower, but every line can be stepped through."""
    P, X = model.numeric_data, data.userdata
    h = 0.0 if model.opt.integrator == RK4 else model.opt.timestep
    stiff: list[int] = []
    for i in range(model.nnumeric):
        block = int(model.numeric_adr[i])
        if P[block] != MAGIC or P[block + RESOLVED] != 1.0:
            continue
        x, dof, joint = (int(P[block + k]) for k in (ROW, DOF, JOINT))
        q, v, t = float(data.qpos[int(P[block + QPOS])]), float(data.qvel[dof]), data.time
        effects = block + int(P[block + EFFECTS])
        last = model.M_rowadr[dof] + model.M_rownnz[dof] - 1
        F = evaluate(P, block + HEAD, effects, X, x, t, q, v, 0.0, 0.0)
        if P[effects] > 0.0:
            bias = np.zeros(model.nv)
            mujoco.mj_rne(model, data, 0, bias)
            a, w, g = model.jnt_axis[joint], data.xaxis[joint], model.opt.gravity
            R, r = data.xmat.reshape(-1), 9 * int(model.jnt_bodyid[joint])
            gx, gy = unit_gravity(a[0], a[1], a[2], w[0], w[1], w[2], g[0], g[1], g[2], R, r)
            F += effects_torque(
                P, block + HEAD, effects, X, x, t, q, v, F, bias[dof], data.M[last], gx, gy
            )
        data.qfrc_passive[dof] -= F
        if F != F:
            return
        if is_stiff(P, block + HEAD, X, x, h, model.dof_invweight0[dof]):
            stiff.append(block)
    if not stiff:
        return
    dofs = [int(P[block + DOF]) for block in stiff]
    units, columns = np.zeros((len(dofs), model.nv)), np.zeros((len(dofs), model.nv))
    units[np.arange(len(dofs)), dofs] = 1.0
    mujoco.mj_solveM(model, data, columns, units)
    blocks = np.array(stiff, dtype=np.int64)
    data.qfrc_passive[dofs] -= settle(P, blocks, X, h, between(P, blocks, columns))


Callback = Callable[[mujoco.MjModel, mujoco.MjData], None]
