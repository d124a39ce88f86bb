"""What friction a model carries, and whether its time step suits it."""

from typing import Any

import mujoco
import numpy as np

from frictionjoint.arguments import require_model
from frictionjoint.effects import heating, motor_temperature, temperature_dependent
from frictionjoint.simulate.carrier import SimulatedEffect, read_friction
from frictionjoint.simulate.mechanism import DEFLECTION
from frictionjoint.simulate.native_friction import native_friction

# Above the first the presliding spring turns over within a step; up to the second the joints of an
# arm were measured to hold their loads; see docs/stiff_joints.md.
_LARGEST_STEP_RATIO, _LARGEST_MEASURED = 1.0, 8.0


def check_model(model: mujoco.MjModel) -> list[dict[str, Any]]:
    """One row a joint: law, presliding stiffness K and its unit, h sqrt(K/J) at qpos0, effects.

    "acts" is how each effect acts in a simulation, a sentence each.
    "native" is what of MuJoCo's own friction the joint has too, None without any.
    """
    require_model(model, "check_model")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inverse = np.zeros((model.nv, model.nv))
    mujoco.mj_solveM(model, data, inverse, np.eye(model.nv))
    rows = []
    carried_by = read_friction(model)
    native = native_friction(model, carried_by)
    for name, carried in carried_by.items():
        joint = model.joint(name).id
        dof = int(model.jnt_dofadr[joint])
        slide = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE
        stiffness = carried.parameters.stiffness
        ratio = model.opt.timestep * float(np.sqrt(stiffness * inverse[dof, dof]))
        remark = _remark(ratio, model.opt.timestep)
        if name in native:
            remark += f"; friction counts twice, with MuJoCo's own {native[name]}"
        rows.append(
            {
                "joint": name,
                "law": carried.parameters.law,
                "stiffness": stiffness,
                "unit": "N/m" if slide else "N m/rad",
                "step_ratio": ratio,
                "native": native.get(name),
                "effects": [e.effect.name for e in carried.effects],
                "acts": [f"{e.effect.name}: {how_it_acts(name, e)}" for e in carried.effects],
                "remark": remark,
            }
        )
    return rows


def _remark(ratio: float, timestep: float) -> str:
    """How a time step suits a joint whose h sqrt(K/J) is `ratio`."""
    if ratio <= _LARGEST_STEP_RATIO:
        return "suits the time step"
    resolved = f"{timestep * _LARGEST_STEP_RATIO / ratio:.2g} s"
    if ratio <= _LARGEST_MEASURED:
        return f"stiff: held, and presliding resolved at timestep <= {resolved}"
    return (
        f"stiffer than arms were measured to hold, {_LARGEST_MEASURED:g}: take a timestep <= "
        f"{timestep * _LARGEST_MEASURED / ratio:.3g} s, or <= {resolved} to resolve presliding"
    )


def how_it_acts(joint: str, carried: SimulatedEffect) -> str:
    """What of an effect a simulation has."""
    effect = carried.effect
    if effect.acts == "mechanism":
        return f"joint {joint + DEFLECTION}, between motor and link"
    if effect.acts == "sensors":
        late = "position and velocity" if carried.shape[0] > 0.0 else "actuator force"
        return f"the joint's sensors of {late} are late; control loops of the model are not"
    if effect is heating.EFFECT:
        return "the friction's loss warms the joint"
    if effect in (*temperature_dependent.FORMS, motor_temperature.EFFECT):
        return "a torque, at the temperature of heating, or that of set_temperature"
    return "a torque"
