"""``--to c``: one C99 header with the law, the effects and the parameters of a model's joints.

The functions are those of the simulation (`frictionjoint.translate.c_functions`), limited to
the model's laws and effects, and give the same torque. Nothing is allocated; of the C library only
exp, log and pow are used.
"""

import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from frictionjoint.arrays import Array
from frictionjoint.effects.heating import EFFECT as HEATING
from frictionjoint.effects.signals import GEAR, GX, GY, LOAD, MOTOR, TEMP
from frictionjoint.errors import ModelError
from frictionjoint.export.scripts import rendered
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.parameter_checks import LEVEL_FIELDS
from frictionjoint.parameters import Friction
from frictionjoint.rivals import MaxwellSlipParameters
from frictionjoint.simulate.joint_effects import effects_torque
from frictionjoint.simulate.row import row_size, torque_now
from frictionjoint.translate.c_functions import Translation, name_of
from frictionjoint.translate.kernel import Known

# what the caller gives besides the motion: signals, and arguments of `effects_torque`
_AROUND = frozenset({LOAD, GEAR, GX, GY, MOTOR})
_SURROUNDINGS = {
    "bias": "s->bias",
    "inertia": "s->inertia",
    "armature": "s->armature",
    "gx": "s->gravity[0]",
    "gy": "s->gravity[1]",
    "asked": "s->asked",
}
# where an effect that is no torque acts
_ELSEWHERE = {"mechanism": "between motor and link", "sensors": "in the instruments"}


@dataclass(frozen=True)
class CJoint:
    """One joint in the header: its name in C, and its numbers as text, each with a description;
    where the effects' numbers begin, doubles of memory, and whether an effect needs more than the
    motion.
    """

    name: str
    identifier: str
    numbers: tuple[tuple[str, str], ...]
    effects: int
    state: int
    surroundings: bool


def header(friction: Mapping[str, JointFriction], guard: str) -> str:
    """The text of the header for joints by name; `guard`: name of the file, for its include guard.

    Raises:
        ModelError: two joints' names become one C identifier.
    """
    joints = [_joint(name, carried) for name, carried in friction.items()]
    identifiers = [joint.identifier for joint in joints]
    for i, joint in enumerate(joints):
        if joint.identifier in identifiers[:i]:
            raise ModelError(
                f"joint {joint.name!r} and another are both {joint.identifier} in C: rename one"
            )
    with_effects = any(carried.effects for carried in friction.values())
    functions = [torque_now, effects_torque] if with_effects else [torque_now]
    return rendered(
        "friction.h.j2",
        guard=f"FRICTIONJOINT_{_identifier(guard).upper()}",
        joints=joints,
        source=Translation(functions, _known(friction.values())).text(),
        torque=name_of(torque_now),
        effects=f"{name_of(effects_torque)}({_effect_arguments()})" if with_effects else "",
        state=max(joint.state for joint in joints),
        lost=lost_effects(friction),
    )


def lost_effects(friction: Mapping[str, JointFriction]) -> list[str]:
    """``joint: effect, why`` for effects that are zero in the header."""
    found = []
    for name, joint in friction.items():
        heated = any(carried.effect is HEATING for carried in joint.effects)
        for effect in (carried.effect for carried in joint.effects):
            if effect.acts != "torque":
                found.append(f"{name}: {effect.name}, {_ELSEWHERE[effect.acts]}")
            elif TEMP in effect.needs and not heated:
                found.append(f"{name}: {effect.name}, at its reference temperature")
    return found


def _effect_arguments() -> str:
    own = ["P", "0", "joint->effects", "state", "0", "time", "position", "velocity"]
    names = list(inspect.signature(effects_torque).parameters)
    return ", ".join([*own, *(_SURROUNDINGS[name] for name in names[len(own) :])])


def _known(carried: Iterable[JointFriction]) -> Known:
    """The laws and effects in use, so that the header contains no others."""
    joints = list(carried)
    laws = frozenset(float(joint.parameters.pack()[0]) for joint in joints)
    effects = frozenset(float(e.effect.effect_id) for joint in joints for e in joint.effects)
    return {
        ("law.kernel", "P[p]"): laws,
        ("law.kernel", "law"): laws,
        ("effects.kernel", "effect_id"): effects,
    }


def _joint(name: str, carried: JointFriction) -> CJoint:
    law = carried.parameters.pack()
    labels = [*_law_labels(carried.parameters, law), "number of effects"]
    values = [*law, float(len(carried.effects))]
    for effect in carried.effects:
        own = (*effect.effect.shape, *effect.effect.coefficients)
        labels += [f"effect: {effect.effect.name}", "its numbers", *own]
        values += list(effect.pack())
    return CJoint(
        name=name,
        identifier=_identifier(name),
        numbers=tuple(zip((repr(float(x)) for x in values), labels, strict=True)),
        effects=len(law),
        state=row_size(int(law_row_size(law, 0)), len(carried.effects)),
        surroundings=any(_AROUND & set(e.effect.needs) for e in carried.effects),
    )


def _law_labels(parameters: Friction, block: Array) -> list[str]:
    """Description of each number of a law's block."""
    first = f"law: {parameters.law}"
    if parameters.law == "integrated":
        kinds = ["variant: 0 ganseman1997, 1 lampaert2002", "virgin: 0 literal, 1 masing"]
        head = [first, *kinds, "n", "sigma1", *LEVEL_FIELDS]
        knots = int(block[len(head)])
        of_knots = [f"{x} of knot {i}" for i in range(knots) for x in ("z", "F", "slope")]
        return [*head, "knots", *of_knots]
    own: Iterable[str] = parameters.own
    if isinstance(parameters, MaxwellSlipParameters):
        pairs = range(len(parameters.elements))
        own = ["C", "elements", *(f"{x}[{i}]" for i in pairs for x in ("k", "share"))]
    return [first, "sigma1", *LEVEL_FIELDS, *own]


def _identifier(name: str) -> str:
    """A name as a C identifier, after a prefix."""
    return re.sub(r"\W", "_", name, flags=re.ASCII)
