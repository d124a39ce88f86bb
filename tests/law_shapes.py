"""Shapes of a friction law at a chosen point, for tests that need any law and no fit."""

from typing import TypeVar

import numpy as np

from frictionjoint.identify.shape import Shape

_S = TypeVar("_S", bound=Shape)


def law_at(form: _S, Vs: float, length: float) -> _S:
    """A form of a law with this Stribeck velocity (rad/s) and presliding length (rad)."""
    wanted = {"log Vs": np.log(Vs), "log length": np.log(length)}
    numbers = [wanted.get(n, x) for n, x in zip(form.variables, form.vector(), strict=True)]
    return form.moved(np.array(numbers))
