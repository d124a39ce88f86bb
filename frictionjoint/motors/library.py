"""Motors and joints identified from public logs, one TOML file each in this folder.

A file holds ``[motor]``, the fields of `Motor`, and ``[friction]``, law and effects as in a
parameter file. ``scripts/make_motors.py`` writes them all.
"""

import tomllib
from dataclasses import dataclass, field, fields
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import ParameterError
from frictionjoint.files import joint_friction
from frictionjoint.joint_friction import JointFriction


@dataclass(frozen=True)
class Motor:
    """A motor of the library.

    Attributes:
        name: as the command takes it. title: what it is.
        joint, model: of the MJCF it was identified with, which holds its inertia.
        source, licence: of the logs. logs: SHA-256 of them all, in order.
        conditions: of the recordings: machine, load, rate, temperature as far as known.
        command: that identified it. version: commit of the package that ran it.
        verdict: of the report, as its key of that name; empty where it was not kept.
        remark: what to know before using it; may be empty.
        unit: of torques.
        fit: what was left before and after effects were added, by name: `torque` rms of the drive
            in `unit`, `replay` rms of free runs and `closed_loop` mean absolute error of whole logs
            from their target, rad or m; each `_fit` and `_held_out`, and these with `_before`.
        stderr: standard errors of the law's numbers.
        found: numbers of all effects that were added, by effect, also of those that are no part of
            `friction`: the drive's, the load's, the log's.
        friction: law and effects.
        units: Fs, Fc and sigma2 of every unit that was identified, by its joint, mean of both
            directions; empty if there is one. `friction` is that of one of them.
    """

    name: str
    title: str
    joint: str
    model: str
    source: str
    licence: str
    conditions: str
    command: str
    version: str
    logs: str
    verdict: str
    remark: str
    unit: str
    fit: dict[str, float]
    stderr: dict[str, float]
    found: dict[str, dict[str, float]]
    friction: JointFriction
    units: dict[str, dict[str, float]] = field(default_factory=dict)


# what a file says of a motor, all of it text but the numbers of the fit
TEXTS = tuple(x.name for x in fields(Motor) if x.type is str and x.name not in ("name", "unit"))


def list_motors(folder: Traversable | None = None) -> list[Motor]:
    """All motors of the library, or of another folder, by name."""
    folder = folder or files("frictionjoint.motors")
    found = (x for x in folder.iterdir() if x.name.endswith(".toml"))
    return [_read(x) for x in sorted(found, key=lambda x: x.name)]


def get_motor(name: str) -> Motor:
    """One motor of the library.

    Raises:
        ParameterError: no motor has this name.
    """
    known = {motor.name: motor for motor in list_motors()}
    if name not in known:
        raise ParameterError(f"no motor {name!r}: `frictionjoint motors list` names them")
    return known[name]


def friction_speed(motor: Motor) -> tuple[Array, dict[str, Array]]:
    """Steady friction of a motor at speeds from a tenth to twenty of its Stribeck velocities.

    Returns:
        speeds, rad/s or m/s, shape (n,), and magnitudes of the friction by direction, "pos"
        and "neg", in the motor's unit.
    """
    from frictionjoint.export.sliding import levels, sliding_torque

    Vs = max(level[2] for level in levels(motor.friction.parameters).values())
    # a Stribeck velocity beyond 10 rad/s (m/s) is none
    speeds = np.geomspace(0.1, 20.0, 9) * (Vs if 0.0 < Vs < 10.0 else 1.0)
    return speeds, {side: sliding_torque(motor.friction, speeds, side) for side in ("pos", "neg")}


def _numbers(table: dict[str, Any]) -> dict[str, float]:
    return {key: float(x) for key, x in table.items()}


def _read(file: Traversable) -> Motor:
    name = file.name.removesuffix(".toml")
    try:
        content: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
        about = content["motor"]
        return Motor(
            name=name,
            unit=about["unit"],
            fit=_numbers(about["fit"]),
            stderr=_numbers(about["stderr"]),
            found={effect: _numbers(x) for effect, x in about["found"].items()},
            friction=joint_friction(content["friction"]),
            units={unit: dict(numbers) for unit, numbers in about.get("units", {}).items()},
            **{key: str(about[key]) for key in TEXTS},
        )
    except (tomllib.TOMLDecodeError, KeyError, ValueError, ParameterError) as error:
        raise ParameterError(f"motor {name}: its file is damaged: {error}") from None
