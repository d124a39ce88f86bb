"""A motor driven by a voltage or a current, in MuJoCo.

The motor is an actuator whose ``ctrl`` is the voltage at its leads:

    torque = kt/R (V - kt v)

minus the saturation (`motor-saturation`), which the friction's callback subtracts. At 0 V its leads
are shorted and the back-EMF brakes. A motor that is switched off has open leads: no current, no
torque and no brake. In MuJoCo that is a disabled actuator, so the motor gets an actuator group of
its own. For a motor driven by a current, ``ctrl`` is that current and nothing brakes.
"""

from dataclasses import dataclass
from typing import Literal

import mujoco

from frictionjoint.effects.motor import given
from frictionjoint.errors import ModelError


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
