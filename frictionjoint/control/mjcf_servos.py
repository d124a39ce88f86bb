"""The controller that a position servo of the MJCF represents."""

from collections.abc import Sequence

import mujoco

from frictionjoint.control.controller import Controller
from frictionjoint.errors import ParameterError
from frictionjoint.model_joints import actuators_of

IN_MJCF = "mjcf"


def controller_in(models: Sequence[mujoco.MjModel], joint: str) -> Controller:
    """Controller of a joint in its models: kp, kv, force range and delay.

    Targets are those of the joint; through a gear g an actuator follows g times the target. Its
    ctrlrange does not limit them.

    Args:
        models: of the joint under one or several loads; they have the same servo.
    Raises:
        ParameterError: no servo drives the joint, several do, or one has internal dynamics.
    """
    found = {_of(model, joint) for model in models}
    if len(found) > 1:
        raise ParameterError(f"the models have different servos at joint {joint!r}: give a file")
    return found.pop()


def _of(model: mujoco.MjModel, joint: str) -> Controller:
    number = model.joint(joint).id
    own = actuators_of(model, joint)
    if len(own) != 1:
        many = f"{len(own)} actuators" if own else "no actuator"
        raise ParameterError(f"the MJCF has {many} on joint {joint!r}: give the controller's file")
    (i,) = own
    kp, bias = float(model.actuator_gainprm[i, 0]), model.actuator_biasprm[i]
    servo = (
        model.actuator_gaintype[i] == int(mujoco.mjtGain.mjGAIN_FIXED)
        and model.actuator_biastype[i] == int(mujoco.mjtBias.mjBIAS_AFFINE)
        and model.actuator_dyntype[i] == int(mujoco.mjtDyn.mjDYN_NONE)
        and bias[0] == 0.0
        and bias[1] == -kp < 0.0
    )
    if not servo:
        raise ParameterError(
            f"actuator {model.actuator(i).name or i!r} of joint {joint!r} is no position servo "
            "without dynamics of its own: give the controller's file"
        )
    gear = abs(float(model.actuator_gear[i, 0]))
    limits = [float("inf")]
    if model.actuator_forcelimited[i]:
        limits.append(gear * _limit(model.actuator_forcerange[i], "forcerange", joint))
    if model.jnt_actfrclimited[number]:
        limits.append(_limit(model.jnt_actfrcrange[number], "actuatorfrcrange", joint))
    delay = model.actuator_delay[i] if hasattr(model, "actuator_delay") else 0.0
    return Controller(
        output="torque_nm",
        kp=gear**2 * kp,
        kd=-(gear**2) * float(bias[2]),
        limit=min(limits),
        delay_s=float(delay),
        source="the MJCF",
    )


def _limit(ends: Sequence[float], what: str, joint: str) -> float:
    low, high = (float(x) for x in ends)
    # symmetric but for rounding
    if abs(low + high) > 1e-9 * max(abs(low), abs(high)):
        raise ParameterError(
            f"{what} of joint {joint!r} is {low:g} to {high:g}: a controller has one limit, give "
            "its file"
        )
    return high
