"""From the firmware's output to torque at the joint."""

from typing import NamedTuple


class Drive(NamedTuple):
    """Torque = factor * gain * output - emf * speed."""

    gain: float  # N m per unit of the output (duty, V or N m)
    emf: float  # back-EMF of a DC motor under voltage, N m s/rad; 0 under current control
    factor: float  # torque over what the controller file says
