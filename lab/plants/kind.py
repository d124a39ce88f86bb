"""A kind of undeclared effect: how its size is drawn, and how it is put into a plant."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .parts import Parts
from .spec import PlantSpec

Sizes = dict[str, float]


class Kind(NamedTuple):
    """An effect built from MuJoCo parts or in the stepping loop.

    draw: parameters of a realistic size for a plant. build: puts them into the plant. Of kinds that
    the catalogue lacks on purpose, quantities: what a residual should point at, by the names of a
    report; also: effects of the catalogue that the kind truly brings with it.
    """

    draw: Callable[[np.random.Generator, PlantSpec], Sizes]
    build: Callable[[Parts, Sizes], None]
    quantities: tuple[str, ...] = ()
    also: tuple[str, ...] = ()


def in_loop(**constants: str) -> Callable[[Parts, Sizes], None]:
    """Put parameters into the loop: constants of `loop.FIELDS` by the parameters' names."""

    def build(parts: Parts, p: Sizes) -> None:
        parts.loop |= {constant: p[name] for constant, name in constants.items()}

    return build
