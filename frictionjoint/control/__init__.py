"""Controllers that drive a joint to its target, for logs and for simulations."""

from frictionjoint.control.controller import Controller
from frictionjoint.control.controller_file import read_controller
from frictionjoint.control.presets import PRESETS

__all__ = ["PRESETS", "Controller", "read_controller"]
