"""A joint as it truly is: load, friction, drive and firmware."""

from typing import NamedTuple

from .drive import Drive
from .firmware import Firmware
from .friction import Friction
from .load import Load


class Joint(NamedTuple):
    """The whole plant without its gain, which may belong to a log."""

    load: Load
    friction: Friction
    drive: Drive
    firmware: Firmware
    step: float  # largest step of the integrator, s

    @property
    def torque_range(self) -> float:
        """Torque at standstill with the output at its limit, N m."""
        return self.drive.gain * self.firmware.limit
