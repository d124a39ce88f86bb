"""MuJoCo's viewer with the friction of a model."""

import importlib
import warnings
from pathlib import Path

import mujoco

from frictionjoint.errors import FrictionJointError
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import load_model


def view(path: str | Path) -> None:
    """Open the viewer on an MJCF with friction, until its window is closed.

    Models that are dragged into the window have their friction too.

    Raises:
        ModelError: as `load_model`.
        FrictionJointError: no viewer, or no display.
    """
    model = load_model(path)
    try:
        glfw = importlib.import_module("glfw")
        viewer = importlib.import_module("mujoco.viewer")
    except ImportError as error:
        raise FrictionJointError(
            f"MuJoCo's viewer cannot be loaded ({error}): pip install --force-reinstall mujoco glfw"
        ) from None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ready = glfw.init()
    if not ready:
        # MuJoCo would end the process here, with no word of where it came from
        reason = f" ({'; '.join(str(w.message) for w in caught)})" if caught else ""
        raise FrictionJointError(
            f"the viewer finds no display{reason}: run it where windows can be opened"
        )
    with attach(model):
        viewer.launch(model, mujoco.MjData(model))
