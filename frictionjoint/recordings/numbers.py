"""The friction parameters by which recordings are compared.

A parameter with the same value in both directions counts once. Fs is represented by Fs - Fc, as in
a posterior. Shape parameters (exponents, knots) are not compared.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from frictionjoint.effects.catalogue import title
from frictionjoint.effects.quantities import quantity_of
from frictionjoint.files import joint_friction
from frictionjoint.joint_friction import JointFriction
from frictionjoint.parameter_meanings import meaning
from frictionjoint.refine.posterior import entries, numbers_in, with_numbers

# N counts teeth or magnets; T0 is where the law applies, a choice
_SHAPES = ("delta", "n", "i", "form", "reach", "sigma1", "N", "knots", "T0")
_OTHER_SIDE = {"pos": "neg", "neg": "pos"}


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
    numbers = entries(content)
    places: list[tuple[str, int, str]] = []
    for at, (key, table, _, _) in enumerate(numbers):
        if table and key not in _SHAPES:
            effect = title(table["effect"], table["form"])
            places.append((f"{table['effect']} {key}", at, effect))
        elif not table and not {key, key.rpartition("_")[0]} & {*_SHAPES}:
            places.append((key, at, ""))
    by_name = {name: at for name, at, _ in places}
    found: list[Number] = []
    for name, at, effect in places:
        stem, _, side = name.rpartition("_")
        twin = by_name.get(f"{stem}_{_OTHER_SIDE.get(side)}")
        if twin is not None and numbers[twin].value != numbers[at].value:
            twin = None
        if numbers[at].value == 0.0 or (twin is not None and side == "neg"):
            continue
        word = name if twin is None else stem
        if word.partition("_")[0] == "Fs":
            word = word.replace("Fs", "Fs - Fc", 1)
        found.append(Number(word, (at,) if twin is None else (at, twin), effect))
    return found


def changed(content: Mapping[str, Any], number: Number, by: float) -> JointFriction:
    """The friction with one parameter changed, also its transition curve, or ParameterError."""
    values = numbers_in(content)
    values[list(number.indices)] += by
    return joint_friction(with_numbers(content, values))
