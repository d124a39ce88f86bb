"""Controller files: values for all joints, and tables [joint.NAME] with differences."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, get_args

import mujoco

from frictionjoint.control.controller import Controller, Output
from frictionjoint.control.mjcf_servos import IN_MJCF, controller_in
from frictionjoint.control.presets import PRESETS
from frictionjoint.errors import ParameterError
from frictionjoint.measured.arguments import expect
from frictionjoint.structured_files import read_toml

# one for all joints, one per joint name, a file of either, a preset's name, or "mjcf"
GivenController = Controller | Mapping[str, Controller] | str | Path
_JOINTS = "joint"


def controller_of(
    given: GivenController | None, joint: str, models: Sequence[mujoco.MjModel]
) -> Controller | None:
    """The controller of a joint; None if none is given.

    Args:
        models: of the joint under one or several loads.
    Raises:
        ParameterError: no controller for this joint, one for a joint that no model has, or see
            `read_controller` and `controller_in`.
    """
    if given is None or isinstance(given, Controller):
        return given
    if given == IN_MJCF:
        return controller_in(models, joint)
    if isinstance(given, Mapping):
        by_joint, where = dict(given), "controller"
        if joint not in by_joint:
            listed = ", ".join(by_joint) or "none"
            raise ParameterError(f"controller: none for joint {joint!r}, there is {listed}")
    else:
        by_joint, where = _by_joint(given), str(given)
    joints = {model.joint(j).name for model in models for j in range(model.njnt)}
    strange = [name for name in by_joint if name not in joints]
    if strange:
        listed = ", ".join(sorted(joints))
        raise ParameterError(f"{where}: no joint {strange[0]!r} in the model, it has {listed}")
    found = by_joint.get(joint)
    return found if found or isinstance(given, Mapping) else read_controller(given)


def read_controller(path: str | Path) -> Controller:
    """A controller from its TOML file, or a preset by name, without differences per joint.

    Raises:
        ParameterError: one line that names the file, the key and the fix.
    """
    if str(path) in PRESETS:
        return PRESETS[str(path)]
    content = _content(path)
    content.pop(_JOINTS, None)
    return _made(str(path), content)


def _by_joint(path: str | Path) -> dict[str, Controller]:
    """Controllers of the joints that have a table in the file."""
    if str(path) in PRESETS:
        return {}
    content = _content(path)
    tables = content.pop(_JOINTS, {})
    if not (isinstance(tables, dict) and all(isinstance(x, dict) for x in tables.values())):
        raise ParameterError(f"{path}: joint is {tables!r}: give tables [joint.NAME]")
    return {name: _made(f"{path}, [joint.{name}]", content | own) for name, own in tables.items()}


def _content(path: str | Path) -> dict[str, Any]:
    expect(path, (str, Path), "controller", "give the path of its TOML file, or a preset's name")
    listed = ", ".join((*PRESETS, IN_MJCF))
    return read_toml(Path(path), f"; give a TOML file, or one of {listed}")


def _made(where: str, content: Mapping[str, Any]) -> Controller:
    known = [field.name for field in fields(Controller)]
    unknown = [key for key in content if key not in known]
    if unknown:
        raise ParameterError(f"{where}: unknown {unknown[0]!r}, it has {', '.join(known)}")
    missing = [key for key in ("output", "kp") if key not in content]
    if missing:
        raise ParameterError(
            f"{where}: no {missing[0]}: give output (one of {', '.join(get_args(Output))}) and kp"
        )
    try:
        return Controller(**content)
    except ParameterError as error:
        raise ParameterError(f"{where}: {error}") from None
