"""Exports as Python modules for another program, from the templates in this folder."""

import os
import re
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

import jinja2
import mujoco

from frictionjoint.export.sliding import PlainFriction


def rendered(template: str, **values: Any) -> str:
    """The text of a template of this folder, which may also name this package's `version`."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("frictionjoint.export", "."),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["pystr"] = _quoted
    environment.filters["pyregex"] = lambda name: _quoted(re.escape(name))
    values["version"] = metadata.version("frictionjoint")
    return environment.get_template(template).render(values)


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def newton_text(source: Path, friction: Mapping[str, PlainFriction], model: mujoco.MjModel) -> str:
    """A module with the model's totals for `newton.Model`, and a function that writes them."""
    joints = {}
    for name in friction:
        j = model.joint(name).id
        dof, q = int(model.jnt_dofadr[j]), int(model.jnt_qposadr[j])
        joints[name] = {
            "friction": float(model.dof_frictionloss[dof]),
            "damping": float(model.dof_damping[dof]),
            "armature": float(model.dof_armature[dof]),
            "stiffness": float(model.jnt_stiffness[j]),
            "rest_q": float(model.qpos_spring[q] - model.qpos0[q]),
        }
    step = float(model.opt.timestep)
    return rendered(
        "newton.py.j2", source=source.name, joints=joints, step=step, time_constant=2.0 * step
    )


def isaac_text(source: Path, friction: Mapping[str, PlainFriction], model: mujoco.MjModel) -> str:
    """A module with one actuator configuration per joint."""
    joints = {}
    for name, plain in friction.items():
        dof = int(model.jnt_dofadr[model.joint(name).id])
        native = float(model.dof_frictionloss[dof]) - plain.coulomb
        joints[name] = {
            "friction": native + plain.breakaway,
            "dynamic_friction": native + plain.coulomb,
            "viscous_friction": float(model.dof_damping[dof]),
            "armature": float(model.dof_armature[dof]),
        }
    return rendered("isaac.py.j2", source=source.name, joints=joints)


def mjlab_text(source: Path, out: Path, joints: list[str], model: mujoco.MjModel) -> str:
    """A module with an articulation whose joints have the friction of the model."""
    way = os.path.relpath(source.absolute(), out.absolute().parent)
    moved = [
        model.joint(int(model.actuator_trnid[i, 0])).name
        for i in range(len(model.actuator_group))
        if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_JOINT
    ]
    driven = [name for name in joints if name in moved]
    free = [name for name in joints if name not in moved]
    return rendered(
        "mjlab.py.j2",
        source=source.name,
        way=way,
        driven=[driven] if driven else [],
        free=[free] if free else [],
    )
