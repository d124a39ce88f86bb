"""The numbers of a friction that recordings are compared by.

A number that is the same in both directions is one. Fs is compared above Fc, as a posterior has it.
Shapes (exponents, knots) are no such numbers.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.describe import meaning
from frictionjoint.effects.catalogue import title
from frictionjoint.effects.quantities import quantity_of
from frictionjoint.files import joint_friction
from frictionjoint.joint_friction import JointFriction
from frictionjoint.refine.posterior import is_number, numbers_in, with_numbers

_SHAPES = ("delta", "n", "i", "form", "reach", "sigma1")
_ABOVE = {"Fs": "Fs - Fc"}


@dataclass(frozen=True)
class Number:
    """A number of a friction.

    Attributes:
        name: symbol, after the canonical name for a number of an effect. indices: of the
            numbers of a parameter file, two if both directions share one.
        of_law: whether it belongs to the law.
    """

    name: str
    indices: tuple[int, ...]
    of_law: bool

    @property
    def words(self) -> str:
        """What it is."""
        if not self.of_law:
            effect, _, number = self.name.partition(" ")
            return f"{quantity_of(effect, number)} ({title(effect)})"
        symbol, above, _ = self.name.partition(" - ")
        return meaning(symbol) + (" above Coulomb friction" if above else "")


def numbers_of(content: Mapping[str, Any]) -> list[Number]:
    """The numbers of a parameter file that recordings are compared by."""
    values = numbers_in(content)
    places: list[tuple[str, int, bool]] = []
    at = 0
    for key, x in content.items():
        if key == "knots":
            at += 2 * len(x)
        elif key == "effects":
            for table in x:
                for name, value in table.items():
                    if is_number(name, value):
                        if name not in _SHAPES:
                            places.append((f"{table['effect']} {name}", at, False))
                        at += 1
        elif is_number(key, x):
            if key.rpartition("_")[0] not in _SHAPES and key not in _SHAPES:
                places.append((key, at, True))
            at += 1
    found: list[Number] = []
    by_name = {name: at for name, at, _ in places}
    for name, i, of_law in places:
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
            found.append(Number(word, (i, j) if twin and j is not None else (i,), of_law))
    return found


def values_of(content: Mapping[str, Any], numbers: list[Number]) -> Array:
    """Values of the numbers, shape (p,)."""
    values = numbers_in(content)
    return np.array([float(np.mean(values[list(x.indices)])) for x in numbers])


def changed(content: Mapping[str, Any], number: Number, by: float) -> JointFriction:
    """The friction with one number changed; what a curve needs goes along.

    Raises:
        ParameterError: no joint has such a friction.
    """
    values = numbers_in(content)
    values[list(number.indices)] += by
    return joint_friction(with_numbers(content, values))
