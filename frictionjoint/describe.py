"""Friction of a joint in words and units, for people: `inspect`, comments in models, reports."""

from frictionjoint.effects.catalogue import EVERY
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.quantities import quantity_of
from frictionjoint.joint_friction import JointFriction
from frictionjoint.parameter_meanings import Value, by_direction, meaning, spelled, unit_of
from frictionjoint.parameters import Friction

# what a comment in a model states
_COMMENTED = ("Fc", "Fs", "Vs", "sigma2", "stiffness")


def law_values(parameters: Friction, slide: bool) -> tuple[Value, ...]:
    """Parameters of a law; one row where both directions are equal; of a slide in N and m."""
    numbers = {k: x for k, x in parameters.to_dict().items() if isinstance(x, float)}
    if parameters.stiffness > 0.0:
        numbers |= {"stiffness": parameters.stiffness}
    return tuple(
        Value(symbol, meaning(symbol), numbers[name], unit_of(symbol, slide))
        for symbol, name in by_direction(numbers)
    )


def effect_texts(joint: JointFriction, slide: bool) -> tuple[str, ...]:
    """Each effect with its numbers in units."""
    found = []
    for one in joint.effects:
        effect, values = one.effect, one.named
        numbers = (
            f"{quantity_of(effect.name, n)} {Value(n, '', values[n], spelled(unit, slide)).text}"
            for n, unit in _units(effect).items()
        )
        found.append(f"{effect.title or effect.name}: {', '.join(numbers)}")
    return tuple(found)


def effect_value(effect: str, number: str, value: float, slide: bool) -> tuple[str, str]:
    """What a number of an effect is, and its value with its unit, by their names in a report."""
    units = {n: unit for e in EVERY if e.name == effect for n, unit in _units(e).items()}
    unit = spelled(units.get(number, "1"), slide)
    return quantity_of(effect, number), Value(number, "", value, unit).text


def _units(effect: Effect) -> dict[str, str]:
    """Units of an effect's numbers by their names, coefficients first."""
    names = (*effect.coefficients, *effect.shape)
    return dict(zip(names, (*effect.units, *effect.shape_units), strict=True))


def one_line(name: str, joint: JointFriction, slide: bool) -> str:
    """The friction of a joint in one line, as in the comments of a model."""
    values = [
        f"{x.symbol} {x.text} ({x.meaning})"
        for x in law_values(joint.parameters, slide)
        if x.symbol.partition("_")[0] in _COMMENTED
    ]
    text = f"Friction of joint {name}, law {joint.parameters.law}: {', '.join(values)}"
    return "; ".join([text, *effect_texts(joint, slide)])
