"""Meanings and units of the parameters of a law."""

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NamedTuple

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
    "knots": "transition curve",
    "gain": "motor constant",
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


def meaning(name: str) -> str:
    """Description of a parameter of a law, from its name."""
    base, _, side = name.rpartition("_")
    if side in SIDES:
        return f"{meaning(base)}, {SIDES[side]}"
    return MEANINGS.get(name, "parameter of the law")


def meanings(names: Iterable[str]) -> str:
    """Descriptions of some parameters of a law, without repetitions and without directions."""
    bases = (name.removesuffix("_pos").removesuffix("_neg") for name in names)
    return ", ".join(dict.fromkeys(meaning(base) for base in bases))


def short(fields: Mapping[str, Any]) -> str:
    """Fields of parameters as `name=value`; equal values of both directions appear once."""
    rows = by_direction(fields)
    return ", ".join(f"{symbol}={five(fields[x])}" for symbol, x in rows if x != "law")


def by_direction(
    fields: Mapping[str, Any], equal: Callable[[Any, Any], bool] = operator.eq
) -> Iterator[tuple[str, str]]:
    """Symbol and name of each field; one symbol, without a direction, where both are equal."""
    for name in fields:
        base, _, side = name.rpartition("_")
        positive, negative = f"{base}_pos", f"{base}_neg"
        if side not in SIDES or positive not in fields or negative not in fields:
            yield name, name
        elif side == "pos" and equal(fields[positive], fields[negative]):
            yield base, positive
        elif side == "pos":
            yield from ((positive, positive), (negative, negative))


def five(x: Any, text: Callable[[Any], str] = repr) -> str:
    """Numbers to five figures; `text` of anything else."""
    if isinstance(x, float):
        return f"{x:.5g}"
    if isinstance(x, Iterable) and not isinstance(x, str):
        return f"({', '.join(five(y, text) for y in x)})"
    return text(x)
