"""Motors and joints identified from public logs, one TOML file each in this folder.

A file holds ``[motor]``: title, source and licence of the logs it was identified from, the command
that did it, and what the fit left; and ``[friction]``: law and effects as in a parameter file.
"""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

import tomlkit

from frictionjoint.errors import ParameterError
from frictionjoint.files import joint_friction, toml_document
from frictionjoint.simulate.carrier import JointFriction

# what a file says of a motor, all of it text but the numbers of the fit
TEXTS = ("title", "joint", "model", "source", "licence", "command", "remark")
NUMBERS = ("torque_rms", "torque_rms_before", "held_out_rms", "held_out_rms_before")


@dataclass(frozen=True)
class Motor:
    """A motor of the library.

    Attributes:
        name: as the command takes it. title: what it is.
        joint, model: of the MJCF it was identified with, which holds its inertia.
        source, licence: of the logs. command: that identified it.
        remark: what to know before using it; may be empty.
        unit: of torques. fit: rms of what the fit left, by name, in that unit: `torque_rms` of all
            logs, or of the fitted and the held-out ones, before and after effects were added.
        friction: law and effects.
    """

    name: str
    title: str
    joint: str
    model: str
    source: str
    licence: str
    command: str
    remark: str
    unit: str
    fit: dict[str, float]
    friction: JointFriction


def list_motors() -> list[Motor]:
    """All motors, by name."""
    found = (x for x in files("frictionjoint.motors").iterdir() if x.name.endswith(".toml"))
    return [_read(x) for x in sorted(found, key=lambda x: x.name)]


def get_motor(name: str) -> Motor:
    """One motor.

    Raises:
        ParameterError: there is none of that name.
    """
    known = {motor.name: motor for motor in list_motors()}
    if name not in known:
        raise ParameterError(f"no motor {name!r}: there are {', '.join(known) or 'none'}")
    return known[name]


def motor_text(motor: Motor) -> str:
    """The file of a motor, for the library."""
    document = tomlkit.document()
    table = tomlkit.table()
    for key in (*TEXTS, "unit"):
        table.add(key, getattr(motor, key))
    table.add("fit", motor.fit)
    document.add("motor", table)
    friction = toml_document(motor.friction.parameters, motor.friction.effects)
    document.add("friction", tomlkit.item(friction.unwrap()))
    return tomlkit.dumps(document)


def _read(file: Traversable) -> Motor:
    name = file.name.removesuffix(".toml")
    try:
        content: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
        about = content["motor"]
        return Motor(
            name=name,
            unit=about["unit"],
            fit={key: float(about["fit"][key]) for key in NUMBERS if key in about["fit"]},
            friction=joint_friction(content["friction"]),
            **{key: str(about[key]) for key in TEXTS},
        )
    except (tomllib.TOMLDecodeError, KeyError, ParameterError) as error:
        raise ParameterError(f"motor {name}: its file is damaged: {error}") from None
