"""Check of a model with friction: what acts, what does not, and whether the time step suffices."""

from typing import Any

import mujoco

from frictionjoint.arguments import require_model
from frictionjoint.effects import heating, motor, temperature_dependent
from frictionjoint.errors import ModelError
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.law.kernel import presliding
from frictionjoint.model_joints import is_slide
from frictionjoint.parameter_checks import SIDES
from frictionjoint.simulate.attach import callback_is_off
from frictionjoint.simulate.block import assumed
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.mechanism import DEFLECTION, require_flags
from frictionjoint.simulate.native_friction import CLEAR, native_friction, tendon_friction


def check(model: mujoco.MjModel) -> list[dict[str, Any]]:
    """Check the friction of a model: one row per joint.

    Returns:
        rows with the joint, the law, its stiffness K in "unit" and damping sigma (sigma1 + the
        larger sigma2) in "unit" s; "step_ratio" h sqrt(K/J) and "damping_ratio" h sigma/J with the
        joint's inertia J at qpos0, all other joints free; "implicit": whether the integrator solves
        friction within the step; "native": MuJoCo's own friction of the joint, or None; "effects",
        and "acts": how each acts in a simulation, one sentence each; "outside": a sentence per
        exceeded limit, with its fix; "remark": on the time step.
    Raises:
        ModelError: friction in the model is damaged. TypeError: no MjModel.
    """
    require_model(model, "check")
    carried_by = read_friction(model)
    native = native_friction(model, carried_by)
    implicit = bool(model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4)
    step, rows = model.opt.timestep, []
    for name, carried in carried_by.items():
        j = model.joint(name).id
        unit = "N/m" if is_slide(model, name) else "N m/rad"
        # of one degree of freedom MuJoCo keeps the inverse inertia at qpos0
        inverse = float(model.dof_invweight0[int(model.jnt_dofadr[j])])
        law = carried.parameters
        stiffness, sigma1 = presliding(law.pack(), 0)
        damping = float(sigma1) + max(float(law.levels(side)[-1]) for side in SIDES)
        ratio, damping_ratio = step * float(stiffness * inverse) ** 0.5, step * damping * inverse
        outside = _outside(step, ratio, damping_ratio, implicit)
        if callback_is_off(model):
            outside.append(
                "friction does not act: spring and damper flags are both disabled, enable one of "
                "them in <option><flag>"
            )
        outside += _springs_outside(step, inverse, carried)
        if name in native:
            outside.append(f"friction counts twice, with MuJoCo's own {native[name]}: {CLEAR}")
        try:
            require_flags(model, name)
        except ModelError as error:
            outside.append(str(error))
        acts = [
            f"the effect {e.effect.title or e.effect.name!r} {how_it_acts(name, e)}"
            for e in carried.effects
        ]
        if law.law == "static":  # it would not hold a joint at rest
            spring = f"an elastic element of {stiffness:.4g} {unit}"
            acts.insert(0, f"static: a joint at rest is held by {spring}")
        rows.append(
            {
                "joint": name,
                "law": law.law,
                "stiffness": float(stiffness),
                "damping": damping,
                "unit": unit,
                "step_ratio": ratio,
                "damping_ratio": damping_ratio,
                "implicit": implicit,
                "native": native.get(name),
                "effects": [e.effect.name for e in carried.effects],
                "acts": acts + tendon_friction(model, name) + assumed(model, name),
                "outside": outside,
                "remark": "the time step resolves presliding"
                if ratio <= 1.0
                else f"holds; presliding motion is resolved at timestep <= {step / ratio:.2g} s",
            }
        )
    return rows


def integrator_note(model: mujoco.MjModel) -> str:
    """How the model's integrator treats friction, in a sentence."""
    name = mujoco.mjtIntegrator(model.opt.integrator).name.removeprefix("mjINT_")
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        return f"Integrator {name}: friction is explicit, within limits of the time step."
    return f"Integrator {name}: friction is implicit, solved together with all other forces."


def _outside(timestep: float, ratio: float, damping_ratio: float, implicit: bool) -> list[str]:
    """A sentence per exceeded limit of the time step."""
    # to which joints are tested to hold; the explicit stages of RK4 are stable up to about 2.8
    limit, advice = 2.0, " with RK4: use the integrator implicitfast, or take a timestep"
    if implicit:
        limit, advice = 1000.0, ": take a timestep"
    return [
        f"{what} is {value:.3g}, above {limit:g}, to which joints are tested{advice} <= "
        f"{timestep * limit / value:.2g} s"
        for what, value in (("h sqrt(K/J)", ratio), ("h sigma/J", damping_ratio))
        if value > limit
    ]


def _springs_outside(timestep: float, inverse: float, carried: JointFriction) -> list[str]:
    """A sentence per effect that is an explicit spring too stiff for the time step."""
    found = []
    for effect in carried.effects:
        for plain, value in zip(effect.effect.plain, effect.coefficients, strict=False):
            ratio = timestep * (max(value, 0.0) * inverse) ** 0.5
            if plain == "stiffness" and ratio > 1.0:
                found.append(
                    f"effect {effect.effect.name} is an explicit spring with h sqrt(k/J) = "
                    f"{ratio:.3g}, above 1: take a timestep <= {timestep / ratio:.2g} s"
                )
    return found


def how_it_acts(joint: str, carried: SimulatedEffect) -> str:
    """How a simulation represents an effect, as a predicate."""
    effect = carried.effect
    if effect.acts == "mechanism":
        return f"is the joint {joint + DEFLECTION} between motor and link"
    if effect.acts == "sensors":
        late = "position and velocity" if carried.shape[0] > 0.0 else "actuator force"
        return f"delays the joint's sensors of {late}, not the control loops of the model"
    if effect is heating.EFFECT:
        return "warms the joint by the heat of friction"
    if effect in (*temperature_dependent.FORMS, motor.TEMPERATURE):
        return "acts at the temperature that heating or set_temperature gives"
    return "scales friction" if effect.entry == "scales the friction level" else "adds a torque"
