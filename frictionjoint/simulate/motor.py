"""A motor driven by a voltage or a current, in MuJoCo.

The motor is an actuator whose ``ctrl`` is the voltage at its leads:

    torque = kt/R (V - kt v)

minus the saturation (`motor-saturation`), which the friction's callback subtracts. At 0 V its leads
are shorted and the back-EMF brakes. A motor that is switched off has open leads: no current, no
torque and no brake. In MuJoCo that is a disabled actuator, so the motor gets an actuator group of
its own. For a motor driven by a current, ``ctrl`` is that current and nothing brakes.

By some effects a joint's motors deliver less than commanded. MuJoCo computes actuator forces after
the passive ones, so the callback reads ``ctrl`` itself. It supports actuators with a gain and an
affine bias, without dynamics and without a force limit.
"""

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.compiled import compiled
from frictionjoint.effects.motor import SATURATION, TEMPERATURE, given
from frictionjoint.errors import ModelError
from frictionjoint.simulate.block import names_of
from frictionjoint.simulate.layout import ModelView
from frictionjoint.simulate.pointers import (
    AT,
    DATA,
    MODEL,
    Address,
    flags,
    reals,
    shorts,
    shorts_in,
    wholes_in,
)

_IDS = tuple(float(effect.effect_id) for effect in (SATURATION, TEMPERATURE))
_JOINT = int(mujoco.mjtTrn.mjTRN_JOINT)
_NO_ACTUATION = int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
_NO_CLAMP = int(mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL)
_NO_DYNAMICS, _FIXED = int(mujoco.mjtDyn.mjDYN_NONE), int(mujoco.mjtGain.mjGAIN_FIXED)
_PLAIN = (int(mujoco.mjtBias.mjBIAS_NONE), int(mujoco.mjtBias.mjBIAS_AFFINE))
# numbers an actuator has of each kind
_GEAR, _GAIN, _BIAS = 6, mujoco.mjNGAIN, mujoco.mjNBIAS


@dataclass(frozen=True)
class Motor:
    """A DC motor as its gear transmits it.

    Attributes:
        gain: kt/R, N m/V (N/V for a slide); kt, N m/A, for a motor driven by its current.
        back_emf: kt**2/R, N m s/rad (N s/m); 0 for a current.
        drive: kind of its ``ctrl``.
        saturation: s of the effect `motor-saturation`, 1/(N m)^2.
    """

    gain: float
    back_emf: float
    drive: Literal["voltage", "current"] = "voltage"
    saturation: float = 0.0

    def torque(self, voltage: float, velocity: float) -> float:
        """Torque with the circuit closed, N m (N)."""
        return float(given(self.gain * voltage - self.back_emf * velocity, self.saturation))


def add_motor(spec: mujoco.MjSpec, joint: str, motor: Motor) -> None:
    """Put a motor on a joint: the actuator ``JOINT_voltage`` or ``JOINT_current``, in the place of
    one of an earlier run.

    Raises:
        ModelError: the model's actuators take all groups.
    """
    earlier = spec.actuator(f"{joint}_{motor.drive}")
    if earlier is not None:
        spec.delete(earlier)
    # `opt.disableactuator` can switch off 31 groups
    free = sorted(set(range(31)) - {a.group for a in spec.actuators})
    if not free:
        raise ModelError("the model's actuators take all 31 groups: leave one for the motor")
    actuator = spec.add_actuator(
        name=f"{joint}_{motor.drive}",
        target=joint,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        group=free[-1],
    )
    actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    actuator.gainprm[0] = motor.gain
    actuator.biasprm[2] = -motor.back_emf


@compiled
def gives_less(P: Vector, effects: int) -> bool:
    """Whether the block at P[effects] contains `motor-saturation` or `motor-temperature`."""
    at = effects + 1
    for _ in range(int(P[effects])):
        for k in range(len(_IDS)):
            if P[at] == _IDS[k]:
                return True
        at += 2 + int(P[at + 1])
    return False


@compiled
def commanded_torque(m: Address, d: Address, joint: int, q: float, v: float) -> float:
    """Commanded torque of the actuators on a joint, N m."""
    total = 0.0
    disabled = int(shorts_in(m, AT[MODEL.disableflags])[0])
    if disabled & _NO_ACTUATION:
        return total
    off = int(shorts_in(m, AT[MODEL.disableactuator])[0])
    # until MuJoCo 3.12 each actuator has one control and one output, of its number
    apart = AT[MODEL.nactuator] != 0
    first, count = shorts(m, AT[MODEL.actuator_ctrladr]), shorts(m, AT[MODEL.actuator_ctrlnum])
    outputs = shorts(m, AT[MODEL.actuator_outadr])
    kinds, targets = shorts(m, AT[MODEL.actuator_trntype]), shorts(m, AT[MODEL.actuator_trnid])
    groups, gears = shorts(m, AT[MODEL.actuator_group]), reals(m, AT[MODEL.actuator_gear])
    gains, biases = reals(m, AT[MODEL.actuator_gainprm]), reals(m, AT[MODEL.actuator_biasprm])
    limited = flags(m, AT[MODEL.actuator_ctrllimited])
    ranges, ctrl = reals(m, AT[MODEL.actuator_ctrlrange]), reals(d, AT[DATA.ctrl])
    for i in range(int(wholes_in(m, AT[MODEL.nactuator] if apart else AT[MODEL.nu])[0])):
        if kinds[i] != _JOINT or targets[2 * i] != joint:
            continue
        group = int(groups[i])
        if 0 <= group <= 30 and (off >> group) & 1:
            continue
        k = int(first[i]) if apart else i
        u = 0.0
        if not apart or count[i] > 0:
            u = ctrl[k]
            if limited[k] and not disabled & _NO_CLAMP:
                u = min(max(u, ranges[2 * k]), ranges[2 * k + 1])
            if u != u:
                u = 0.0  # MuJoCo takes a control that is no number for zero
        gear = gears[_GEAR * (int(outputs[i]) if apart else i)]
        g, b = _GAIN * i, _BIAS * i
        force = gains[g] * u + biases[b] + gear * (biases[b + 1] * q + biases[b + 2] * v)
        total += gear * force
    return total


def motors_of(model: mujoco.MjModel | ModelView, joint: int) -> list[int]:
    """The actuators on a joint."""
    actuators = model.nactuator if hasattr(model, "nactuator") else model.nu
    return [
        i
        for i in range(actuators)
        if model.actuator_trntype[i] == _JOINT and model.actuator_trnid[i, 0] == joint
    ]


def check_motors(model: mujoco.MjModel | ModelView, name: str, joint: int) -> None:
    """Raise ModelError where `commanded_torque` does not support the actuators on a joint."""
    found = motors_of(model, joint)
    if not found:
        raise ModelError(
            f"joint {name!r} has a motor that delivers less than commanded, but no actuator: put "
            "one on it, see add_motor"
        )
    for i in found:
        if (
            model.actuator_dyntype[i] != _NO_DYNAMICS
            or model.actuator_gaintype[i] != _FIXED
            or model.actuator_biastype[i] not in _PLAIN
            or (model.actuator_forcelimited[i] and np.isfinite(model.actuator_forcerange[i]).any())
        ):
            actuator = names_of(model, "actuator")[i] or i
            raise ModelError(
                f"joint {name!r} has a motor that delivers less than commanded: its actuator "
                f"{actuator!r} must have a fixed gain, no dynamics and no finite forcerange"
            )
