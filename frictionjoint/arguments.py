"""Checks of argument types in public functions: a TypeError that states the fix.

Without these checks Python would fail later, inside the package, with a message about a missing
attribute.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco

from frictionjoint.errors import ModelError
from frictionjoint.laws import kind_of, require_parameters

_COMPILED = "frictionjoint.load_model(path), or spec.compile()"


def require_model(model: Any, function: str) -> None:
    """Raise TypeError unless the argument is an MjModel."""
    if isinstance(model, mujoco.MjModel):
        return
    if isinstance(model, str | Path):
        fix = f"load {str(model)[:60]!r} with frictionjoint.load_model first"
    elif isinstance(model, mujoco.MjSpec):
        fix = "give spec.compile()"
    elif isinstance(model, mujoco.MjData):
        fix = "give the model that this data belongs to"
    elif isinstance(getattr(model, "ptr", None), mujoco.MjModel):
        fix = "give its .ptr, the MjModel within"
    elif isinstance(getattr(getattr(model, "unwrapped", None), "model", None), mujoco.MjModel):
        fix = "give its .unwrapped.model"
    else:
        fix = f"give an MjModel, from {_COMPILED}"
    raise TypeError(f"{function} takes a mujoco.MjModel, not {kind_of(model)}: {fix}")


def require_data(data: Any, model: Any, function: str) -> None:
    """Raise unless the arguments are an MjData and its MjModel.

    Raises:
        ModelError: the data belong to another model. TypeError: not an MjData or MjModel.
    """
    require_model(model, function)
    if not isinstance(data, mujoco.MjData):
        within = isinstance(getattr(data, "ptr", None), mujoco.MjData)
        fix = "give its .ptr, the MjData within" if within else "give mujoco.MjData(model)"
        raise TypeError(f"{function} takes a mujoco.MjData, not {kind_of(data)}: {fix}")
    fix = "give the data of this model, made by mujoco.MjData(model)"
    for name, own in (("qpos", model.nq), ("qvel", model.nv), ("userdata", model.nuserdata)):
        there = len(getattr(data, name))
        if there != own:
            raise ModelError(
                f"{function}: the data have {there} numbers of {name}, the model {own}: {fix}"
            )
    # copies of a model, as a batch makes them, have its signature
    if data.signature != model.signature:
        raise ModelError(f"{function}: the data belong to another model: {fix}")


def require_spec(spec: Any, function: str = "install") -> None:
    """Raise TypeError unless the argument is an MjSpec."""
    if isinstance(spec, mujoco.MjSpec):
        return
    if isinstance(spec, str | Path):
        fix = "give mujoco.MjSpec.from_file(path), or from_string(text)"
    elif isinstance(spec, mujoco.MjModel):
        fix = "a compiled model cannot be changed, give the spec that it was compiled from"
    else:
        fix = "give mujoco.MjSpec.from_file(path)"
    raise TypeError(f"{function} takes a mujoco.MjSpec, not {kind_of(spec)}: {fix}")


def require_friction(friction: Any) -> None:
    """Raise TypeError unless the argument is friction parameters by joint name."""
    if not isinstance(friction, Mapping):
        raise TypeError(
            f"install takes parameters by joint, not {kind_of(friction)}: "
            'give {"joint name": parameters}'
        )
    for joint, parameters in friction.items():
        if not isinstance(joint, str):
            raise TypeError(f"install: joint {joint!r} is no name: give its name in the model")
        require_parameters(parameters, f"install, joint {joint!r}")


def require_path(path: Any, function: str) -> None:
    """Raise TypeError unless the argument is a str or a Path."""
    if not isinstance(path, str | Path):
        raise TypeError(
            f"{function} takes the path of a file, not {kind_of(path)}: give str or Path"
        )
