"""What data hold of friction: each joint's torque and memory, and the mass matrix without it."""

from dataclasses import dataclass

import mujoco
import numpy as np

from frictionjoint.arguments import require_data
from frictionjoint.arrays import Array
from frictionjoint.effects.catalogue import SIMULATED
from frictionjoint.effects.kernel import MEMORY
from frictionjoint.errors import ModelError
from frictionjoint.law import bristle
from frictionjoint.law.kernel import INTEGRATED, header_size, hysteresis_torque, levels_at
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.law.memory import BOUND, FORGOTTEN, N_MAX, N_MIN, RATE
from frictionjoint.law.stribeck import SIGMA2, VS
from frictionjoint.parameters import FrictionParameters
from frictionjoint.simulate import block as slot
from frictionjoint.simulate.attach import warn_if_idle
from frictionjoint.simulate.block import blocks, effects_of
from frictionjoint.simulate.carrier import read_friction, resolve
from frictionjoint.simulate.row import (
    BASE,
    FRONT,
    GAIN,
    STEP,
    T_EVALUATED,
    TORQUE,
    V_EVALUATED,
    WRITTEN,
)
from frictionjoint.simulate.thermal import temperature_of

_NAMES = {float(effect.effect_id): effect.name for effect in SIMULATED}


@dataclass(frozen=True)
class FrictionTorque:
    """Friction of one joint over the last step; N m, or N for a slide.

    Torques are positive against positive motion; minus `total` acts on the joint.

    Attributes:
        total: the sum of the following parts.
        hysteresis: Fh, the torque of the bristles.
        damping: sigma1 dz/dt. viscous: sigma2 v.
        implicit: change of these three over the step; they are those of its beginning; 0 with RK4.
        effects: torque of each effect by name; a second one of a name is "name_2".
        sticks: the bristles take up most of the motion (dz/dx > 1/2), or the joint rests; a joint
            that drifts does not stick.
        temperature: deg C, of a joint with `heating` or a temperature-dependent effect; else None.
        time: s, of the evaluation; NaN before the first one.
    """

    total: float
    hysteresis: float
    damping: float
    viscous: float
    implicit: float
    effects: dict[str, float]
    sticks: bool
    temperature: float | None
    time: float


def torque(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, FrictionTorque]:
    """Friction torque of every joint with friction, by name of the joint.

    After ``mj_step`` it is the torque that acted over the step that began at `time`; after
    ``mj_forward`` the torque that a step from here would have.

    Args:
        model: attached, or while `enable` is in force. data: of that model.
    Raises:
        ModelError: the model has no friction.
        TypeError: no MjModel or MjData.
    """
    require_data(data, model, "torque")
    P = model.numeric_data
    found = blocks(model)
    if any(P[at + slot.RESOLVED] != 1.0 for at in found.values()):
        found = resolve(model)
    if not found:
        raise ModelError("the model has no friction: use frictionjoint.install on its spec")
    warn_if_idle(model, data, found)
    return {name: _of_joint(model, data, block) for name, block in found.items()}


def sticks(velocity: float, rate: float, stribeck: float) -> bool:
    """Whether a joint sticks; rate: dz/dx. stribeck: the Stribeck velocity, rad/s."""
    # resting: slower than a millionth of the Stribeck velocity
    return rate > 0.5 or abs(velocity) <= 1e-6 * stribeck


def _of_joint(model: mujoco.MjModel, data: mujoco.MjData, block: int) -> FrictionTorque:
    P, X = model.numeric_data, data.userdata
    x = int(P[block + slot.ROW])
    if X[x + STEP] == 0.0:
        nothing, cold = dict.fromkeys(_effects(P, block, X, x), 0.0), temperature_of(P, block, X)
        return FrictionTorque(0.0, 0.0, 0.0, 0.0, 0.0, nothing, True, cold, float("nan"))
    p, law, v = block + slot.HEAD, x + FRONT, float(X[x + V_EVALUATED])
    levels, place = levels_at(P, p), RATE if P[p] == INTEGRATED else bristle.RATE
    side = bristle.side(levels, v)
    rate = float(X[law + header_size(P, p) + place])
    hysteresis = float(hysteresis_torque(P, p, X, law))
    sigma1, sigma2 = float(P[levels]), float(P[side + SIGMA2])
    dof = int(P[block + slot.DOF])
    # velocity at the end of the step that starts at the evaluation
    end = float(data.qvel[dof])
    if data.time <= X[x + T_EVALUATED]:
        end += model.opt.timestep * float(data.qacc[dof])
    law_torque = float(X[x + TORQUE] + X[x + GAIN] * end)
    # as the kernel adds them: without a gain exactly 0 is left
    implicit = law_torque - (hysteresis + (sigma1 * rate + sigma2) * v)
    effects = _effects(P, block, X, x)
    return FrictionTorque(
        total=law_torque + sum(effects.values()),
        hysteresis=hysteresis,
        damping=sigma1 * rate * v,
        viscous=sigma2 * v,
        implicit=implicit,
        effects=effects,
        sticks=sticks(v, rate, float(P[side + VS])),
        temperature=temperature_of(P, block, X),
        time=float(X[x + T_EVALUATED]),
    )


def _effects(P: Array, block: int, X: Array, x: int) -> dict[str, float]:
    """Torque of each effect of a block by its name."""
    numbers = effects_of(P, block + int(P[block + slot.EFFECTS]))
    each = x + FRONT + int(law_row_size(P, block + slot.HEAD)) + 2 * MEMORY * len(numbers)
    found: dict[str, float] = {}
    for i, (effect, _) in enumerate(numbers):
        name = _NAMES[effect]
        alike = sum(1 for other in found if other.partition("_")[0] == name)
        found[f"{name}_{alike + 1}" if alike else name] = float(X[each + i])
    return found


@dataclass(frozen=True)
class Remembered:
    """Memory of one joint.

    Attributes:
        minima, maxima: number of extrema on the stacks m and M, without their limits.
        forgotten: pairs of extrema removed for lack of room since the joint began to move.
        error: N m; bound on the error of the hysteresis torque compared with unlimited stacks: the
            sum of the gaps that the removed pairs left, and never more than Fs_pos + Fs_neg.
    """

    minima: int
    maxima: int
    forgotten: int
    error: float


def remembered(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, Remembered]:
    """Memory of each joint with the integrated law, at the last committed step, in a model that is
    attached or from `load_model`."""
    require_data(data, model, "remembered")
    found = {}
    addresses = resolve(model)
    for name, carried in read_friction(model).items():
        law = carried.parameters
        if not isinstance(law, FrictionParameters):
            continue
        row = int(model.numeric_data[addresses[name] + slot.ROW]) + FRONT
        X = data.userdata[row:]
        found[name] = Remembered(
            minima=max(0, int(X[N_MIN]) - 1),
            maxima=max(0, int(X[N_MAX]) - 1),
            forgotten=int(X[FORGOTTEN]),
            error=min(float(X[BOUND]), law.Fs_pos + law.Fs_neg),
        )
    return found


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
        dof, row = int(P[block + slot.DOF]), int(P[block + slot.ROW])
        diagonal = model.M_rowadr[dof] + model.M_rownnz[dof] - 1
        if entries[diagonal] == X[row + WRITTEN]:
            entries[diagonal] = X[row + BASE]
    dense = np.zeros((model.nv, model.nv))
    rows = np.repeat(np.arange(model.nv), model.M_rownnz)
    dense[rows, model.M_colind] = entries
    dense[model.M_colind, rows] = entries
    return dense
