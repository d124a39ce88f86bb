"""Trial plants: position servos and leg joints that hide one effect of their drive.

    plant = draw("delay", np.random.default_rng(0))
    plant.mjcf, plant.controller, plant.recordings, plant.held_out  # what a user has
    plant.kind, plant.hidden, plant.own, plant.position(...)  # the truth

Written without knowledge of the identification that they judge: own integrator, own friction laws.
"""

from .drawing import draw
from .kinds import KINDS
from .plant import Plant, Recording

__all__ = ["KINDS", "Plant", "Recording", "draw"]
