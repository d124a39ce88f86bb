"""Names of all effects a plant can have, and how each is put in."""

from __future__ import annotations

import numpy as np

from .effects import EFFECTS
from .kind import Kind
from .parts import Parts
from .spec import Effect, PlantSpec
from .unknown import UNKNOWN


def build(parts: Parts, effect: Effect) -> None:
    """Put `effect` into the plant."""
    _kind(effect.name).build(parts, effect.parameters)


def draw(rng: np.random.Generator, spec: PlantSpec, name: str) -> Effect:
    """The effect `name` with a size drawn for this plant."""
    return Effect(name, _kind(name).draw(rng, spec))


def _kind(name: str) -> Kind:
    every = EFFECTS | UNKNOWN
    if name not in every:
        raise ValueError(f"no effect {name!r}; there are {', '.join(sorted(every))}")
    return every[name]
