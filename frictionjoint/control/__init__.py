"""Controllers that drive a joint to its target, for logs and for simulations.

``controller``   gains, limits, delays
``controller_file``  its TOML file, with differences per joint
``kernel``       the control law of one tick
``kernel_numbers``  the numbers of a controller for one log
``reconstruct``  the drive of a log that contains only target and position
``presets``      controllers of common servos and legs, each with its source
"""

from frictionjoint.control.controller import Controller
from frictionjoint.control.controller_file import read_controller
from frictionjoint.control.presets import PRESETS

__all__ = ["PRESETS", "Controller", "read_controller"]
