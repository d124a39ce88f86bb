"""Parameter files: TOML with the law's fields, and the effects under ``[[effects]]``."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomlkit

from frictionjoint.effects.catalogue import SIMULATED
from frictionjoint.effects.motor import TORQUE_GAIN
from frictionjoint.errors import ParameterError
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.laws import parameters_from_dict
from frictionjoint.parameter_checks import check_number
from frictionjoint.parameters import Friction
from frictionjoint.structured_files import read_json, read_toml


def read_parameters(path: Path) -> JointFriction:
    """Friction of one joint from a TOML file.

    Raises:
        ParameterError: the file is missing, is no TOML, or contains an unknown entry.
    """
    content = read_toml(path, "; give a parameter file, as identify writes it")
    try:
        return joint_friction(content)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from None


def read_samples(path: Path) -> tuple[JointFriction, ...]:
    """Friction of one joint, one per sample, from the JSON that ``frictionjoint sample`` writes.

    Raises:
        ParameterError: the file is missing, is no such list, or contains an unknown entry.
    """
    tables = read_json(path, "write it with `frictionjoint sample`")
    if not isinstance(tables, list) or not tables or not all(isinstance(x, dict) for x in tables):
        raise ParameterError(f"{path}: no list of tables: write it with `frictionjoint sample`")
    samples = []
    for number, table in enumerate(tables):
        try:
            samples.append(joint_friction(table))
        except ParameterError as error:
            raise ParameterError(f"{path}: sample {number}: {error}") from None
    return tuple(samples)


def joint_friction(content: Mapping[str, Any]) -> JointFriction:
    """Friction of one joint from the content of a parameter file.

    Raises:
        ParameterError: an unknown entry, or friction that is not in N m (N).
    """
    if "unit" in content:
        raise ParameterError(
            f"its friction is in {content['unit']}, since its logs do not determine the torque of "
            "the motor: identify it again with --gain"
        )
    law = {key: value for key, value in content.items() if key != "effects"}
    effects = content.get("effects", [])
    if not isinstance(effects, list):
        raise ParameterError("effects must be an array of tables, [[effects]]")
    return JointFriction(parameters_from_dict(law), tuple(_effect(table) for table in effects))


def _effect(table: Any) -> SimulatedEffect:
    if not isinstance(table, dict) or "form" not in table:
        raise ParameterError("an effect needs its form: the number of its kernel")
    form = table["form"]
    effect = next((e for e in SIMULATED if e.effect_id == form), None)
    if effect is None or isinstance(form, bool):
        raise ParameterError(f"no effect has the form {form!r}")
    name = table.get("effect", effect.name)
    if name != effect.name:
        raise ParameterError(f"effect {name!r} does not go with form {form!r}, {effect.name}")
    names = (*effect.shape, *effect.coefficients)
    unknown = [key for key in table if key not in (*names, "effect", "form")]
    if unknown:
        raise ParameterError(f"effect {name}: unknown {unknown[0]!r}, it has {', '.join(names)}")
    values = tuple(check_number(f"effect {name}: {key}", table.get(key)) for key in names)
    cut = len(effect.shape)
    return SimulatedEffect(effect, values[:cut], values[cut:])


def toml_text(
    parameters: Friction, effects: tuple[SimulatedEffect, ...] = (), notes: Sequence[str] = ()
) -> str:
    """Inverse of `read_parameters`, exact to the last bit.

    Args:
        notes: on the friction, written as comments.
    """
    return tomlkit.dumps(toml_document(parameters, effects, notes))


def toml_text_without_scale(parameters: Friction, unit: str, notes: Sequence[str] = ()) -> str:
    """Text of friction that is known in A or V only, or in rad or m where kp is not known;
    `read_parameters` rejects it."""
    comment = f"Joint friction in {unit}: its logs do not determine N m/{unit}."
    return tomlkit.dumps(_document((comment, *notes), {"unit": unit, **parameters.to_dict()}))


def toml_document(
    parameters: Friction, effects: tuple[SimulatedEffect, ...] = (), notes: Sequence[str] = ()
) -> tomlkit.TOMLDocument:
    """The TOML document of `toml_text`."""
    comments = ["Joint friction, SI units: N m and rad, or N and m for a slide.", *notes]
    if any(x.effect is TORQUE_GAIN for x in effects):
        comments.append("The unit of torques is that of the log, 1 + gain times the true one.")
    document = _document(comments, parameters.to_dict())
    if effects:
        tables = [
            {"effect": x.effect.name, "form": x.effect.effect_id}
            | {name: float(value) for name, value in x.named.items()}
            for x in effects
        ]
        document.add("effects", tomlkit.item(tables))
    return document


def _document(comments: Sequence[str], values: Mapping[str, Any]) -> tomlkit.TOMLDocument:
    document = tomlkit.document()
    for comment in comments:
        document.add(tomlkit.comment(comment))
    for key, value in values.items():
        document.add(key, value)
    return document
