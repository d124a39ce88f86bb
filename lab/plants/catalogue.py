"""Names of all effects a plant can have, and how each is put in."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

import numpy as np

from . import effects, unknown
from .parts import Parts
from .spec import Effect, PlantSpec


def _modules(package: ModuleType) -> dict[str, ModuleType]:
    found = (import_module(f"{package.__name__}.{m.name}") for m in iter_modules(package.__path__))
    return {module.NAME: module for module in found}


EFFECTS = _modules(effects)
UNKNOWN = _modules(unknown)


def build(parts: Parts, effect: Effect) -> None:
    """Put `effect` into the plant."""
    _module(effect.name).build(parts, effect.parameters)


def draw(rng: np.random.Generator, spec: PlantSpec, name: str) -> Effect:
    """The effect `name` with a size drawn for this plant."""
    return Effect(name, _module(name).draw(rng, spec))


def quantities(name: str) -> tuple[str, ...]:
    """Measured quantities that may rightly be named for an out-of-catalogue kind."""
    return tuple(UNKNOWN[name].QUANTITIES)


def also(name: str) -> frozenset[str]:
    """Effects of the catalogue that an out-of-catalogue kind truly brings with it."""
    return frozenset(getattr(UNKNOWN[name], "ALSO", ()))


def _module(name: str) -> ModuleType:
    every = {**EFFECTS, **UNKNOWN}
    if name not in every:
        raise ValueError(f"no effect {name!r}; there are {', '.join(sorted(every))}")
    return every[name]
