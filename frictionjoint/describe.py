"""Friction of a joint in words and units, for people: `inspect`, comments in models, reports."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from frictionjoint.effects.quantities import quantity_of

if TYPE_CHECKING:
    from frictionjoint.joint_friction import JointFriction
    from frictionjoint.parameters import Friction

MEANINGS = {
    "Fc": "Coulomb friction",
    "Fs": "breakaway friction",
    "Vs": "Stribeck velocity",
    "V0": "velocity below which friction falls to zero",
    "delta": "Stribeck exponent",
    "sigma0": "bristle stiffness",
    "sigma1": "presliding damping",
    "sigma2": "viscous friction",
    "stiffness": "presliding stiffness",
    "n": "exponent of the transition to sliding",
    "gain": "torque per unit of drive",
}
SIDES = {"pos": "forward", "neg": "backward"}
# T: torque or force of a joint, x: its position
UNITS = {
    **dict.fromkeys(("Fs", "Fc"), "T"),
    **dict.fromkeys(("Vs", "V0"), "x/s"),
    **dict.fromkeys(("delta", "n", "i", "breakaway"), "1"),
    **dict.fromkeys(("sigma1", "sigma2"), "T s/x"),
    **dict.fromkeys(("sigma0", "stiffness"), "T/x"),
    "C": "T/s",
}
# what a comment in a model states
_COMMENTED = ("Fc", "Fs", "Vs", "sigma2", "stiffness")


class Value(NamedTuple):
    """A parameter: symbol, meaning, value, unit ("1" without one)."""

    symbol: str
    meaning: str
    value: float
    unit: str

    @property
    def text(self) -> str:
        """Four figures and the unit."""
        return f"{self.value:.4g}" + ("" if self.unit == "1" else f" {self.unit}")


def unit_of(symbol: str, slide: bool) -> str:
    """SI unit of a parameter of a law."""
    return spelled(UNITS.get(symbol.partition("_")[0], "1"), slide)


def spelled(unit: str, slide: bool) -> str:
    """A unit of the catalogue with T and x spelled out."""
    torque, position = ("N", "m") if slide else ("N m", "rad")
    return unit if unit == "deg C" else unit.replace("T", torque).replace("x", position)


def law_values(parameters: "Friction", slide: bool = False) -> tuple[Value, ...]:
    """Parameters of a law; one row where both directions are equal.

    Args:
        parameters: of any law. slide: whether the joint is one: N and m in place of N m and rad.
    """
    numbers = {k: x for k, x in parameters.to_dict().items() if isinstance(x, float)}
    if parameters.stiffness > 0.0:
        numbers |= {"stiffness": parameters.stiffness}
    found = []
    for name, x in numbers.items():
        base, _, side = name.rpartition("_")
        twin = numbers.get(f"{base}_{'neg' if side == 'pos' else 'pos'}") if side in SIDES else None
        if twin == x:
            if side == "pos":
                found.append(Value(base, _meaning(base), x, unit_of(base, slide)))
            continue
        found.append(Value(name, meaning(name), x, unit_of(name, slide)))
    return tuple(found)


def meaning(name: str) -> str:
    """Description of a parameter of a law, from its name."""
    base, _, side = name.rpartition("_")
    return f"{_meaning(base)}, {SIDES[side]}" if side in SIDES else _meaning(name)


def meanings(names: Iterable[str]) -> str:
    """Descriptions of some parameters of a law, without repetitions and without directions."""
    bases = (name.removesuffix("_pos").removesuffix("_neg") for name in names)
    return ", ".join(dict.fromkeys(_meaning(base) for base in bases))


def _meaning(symbol: str) -> str:
    return MEANINGS.get(symbol, "parameter of the law")


def effect_texts(joint: "JointFriction", slide: bool = False) -> tuple[str, ...]:
    """Each effect with its numbers in units."""
    found = []
    for one in joint.effects:
        effect = one.effect
        names = (*effect.coefficients, *effect.shape)
        units = (*effect.units, *effect.shape_units)
        values = (*one.coefficients, *one.shape)
        rows = zip(names, values, units, strict=True)
        numbers = (
            f"{quantity_of(effect.name, n)} {Value(n, '', x, spelled(u, slide)).text}"
            for n, x, u in rows
        )
        found.append(f"{effect.title or effect.name}: {', '.join(numbers)}")
    return tuple(found)


def one_line(name: str, joint: "JointFriction", slide: bool = False) -> str:
    """The friction of a joint in one line, as in the comments of a model."""
    values = [
        f"{x.symbol} {x.text} ({x.meaning})"
        for x in law_values(joint.parameters, slide)
        if x.symbol.partition("_")[0] in _COMMENTED
    ]
    text = f"Friction of joint {name}, law {joint.parameters.law}: {', '.join(values)}"
    return "; ".join([text, *effect_texts(joint, slide)])


def short(fields: Mapping[str, Any]) -> str:
    """Fields of parameters as `name=value`; equal values of both directions appear once."""
    parts: list[str] = []
    for name, x in fields.items():
        base, _, side = name.rpartition("_")
        twin = fields.get(f"{base}_{'neg' if side == 'pos' else 'pos'}") if side in SIDES else None
        if twin is not None and twin == x:
            if side == "pos":
                parts.append(f"{base}={_short(x)}")
        elif name != "law":
            parts.append(f"{name}={_short(x)}")
    return ", ".join(parts)


def _short(x: Any) -> str:
    if isinstance(x, float):
        return f"{x:.5g}"
    if isinstance(x, Iterable) and not isinstance(x, str):
        return f"({', '.join(_short(y) for y in x)})"
    return repr(x)
