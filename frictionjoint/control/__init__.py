"""What drives a joint towards its target: one controller for logs and for simulations.

``controller``   what is known of it: gains, limits, delays
``controller_file``  its TOML file, with what differs by joint
``kernel``       the control law of a tick
``block``        the numbers of a controller for one log
``reconstruct``  the drive of a log that holds target and position only
``presets``      controllers of common servos and legs, each with its source
"""

from frictionjoint.control.controller import Controller
from frictionjoint.control.controller_file import read_controller
from frictionjoint.control.presets import PRESETS

__all__ = ["PRESETS", "Controller", "read_controller"]
