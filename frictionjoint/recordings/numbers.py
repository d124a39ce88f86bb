"""The friction parameters by which recordings are compared.

A parameter with the same value in both directions counts once. Fs is represented by Fs - Fc, as in
a posterior. Shape parameters (exponents, knots) are not compared.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.catalogue import title
from frictionjoint.effects.quantities import quantity_of
from frictionjoint.files import joint_friction
from frictionjoint.joint_friction import JointFriction
from frictionjoint.parameter_meanings import meaning
from frictionjoint.refine.posterior import is_number, numbers_in, with_numbers

# N counts teeth or magnets
_SHAPES = ("delta", "n", "i", "form", "reach", "sigma1", "N")
_ABOVE = {"Fs": "Fs - Fc"}


@dataclass(frozen=True)
class Number:
    """A friction parameter.

    Attributes:
        name: its symbol; for a parameter of an effect, the effect's canonical name and the symbol.
        indices: of the numbers in a parameter file, two if both directions share one value.
        effect: common name of the effect that it belongs to; empty for the law.
    """

    name: str
    indices: tuple[int, ...]
    effect: str

    @property
    def of_law(self) -> bool:
        """Whether the parameter belongs to the law."""
        return not self.effect

    @property
    def words(self) -> str:
        """Description of the parameter."""
        if not self.of_law:
            effect, _, number = self.name.partition(" ")
            return f"{quantity_of(effect, number)} ({self.effect})"
        symbol, above, _ = self.name.partition(" - ")
        return meaning(symbol) + (" above Coulomb friction" if above else "")


def numbers_of(content: Mapping[str, Any]) -> list[Number]:
    """The parameters in a parameter file by which recordings are compared."""
    values = numbers_in(content)
    places: list[tuple[str, int, str]] = []
    at = 0
    for key, x in content.items():
        if key == "knots":
            at += 2 * len(x)
        elif key == "effects":
            for table in x:
                plain = title(table["effect"], table["form"])
                for name, value in table.items():
                    if is_number(name, value):
                        if name not in _SHAPES:
                            places.append((f"{table['effect']} {name}", at, plain))
                        at += 1
        elif is_number(key, x):
            if key.rpartition("_")[0] not in _SHAPES and key not in _SHAPES:
                places.append((key, at, ""))
            at += 1
    found: list[Number] = []
    by_name = {name: at for name, at, _ in places}
    for name, i, effect in places:
        stem, _, side = name.rpartition("_")
        j = by_name.get(f"{stem}_neg")
        if (
            side == "neg"
            and f"{stem}_pos" in by_name
            and values[by_name[f"{stem}_pos"]] == values[i]
        ):
            continue
        twin = side == "pos" and j is not None and values[j] == values[i]
        word = stem if twin else name
        for short, long in _ABOVE.items():
            if word == short or word.startswith(f"{short}_"):
                word = word.replace(short, long, 1)
        if values[i] != 0.0:
            found.append(Number(word, (i, j) if twin and j is not None else (i,), effect))
    return found


def values_of(content: Mapping[str, Any], numbers: list[Number]) -> Array:
    """Values of the parameters, shape (p,)."""
    values = numbers_in(content)
    return np.array([float(np.mean(values[list(x.indices)])) for x in numbers])


def changed(content: Mapping[str, Any], number: Number, by: float) -> JointFriction:
    """The friction with one parameter changed; its transition curve stays consistent.

    Raises:
        ParameterError: the changed values are not a valid friction.
    """
    values = numbers_in(content)
    values[list(number.indices)] += by
    return joint_friction(with_numbers(content, values))
