"""Terms a fit can hold beside the friction law: an effect of the catalogue, or a smooth curve."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from sklearn.preprocessing import SplineTransformer

from frictionjoint.effects.effect import Effect
from frictionjoint.effects.kernel import columns
from frictionjoint.effects.signals import LOAD, TEMP, TIME, A, H, Q, V
from frictionjoint.identify.prepare import Segment

Array = NDArray[np.float64]

VARIABLES = {
    "position": Q,
    "velocity": V,
    "acceleration": A,
    "load": LOAD,
    "time": TIME,
    "temperature_c": TEMP,
}


class Term(Protocol):
    """What a fit asks of a term."""

    @property
    def name(self) -> str:
        """Canonical name of the effect, or the variable of a smooth curve."""
        ...

    @property
    def coefficients(self) -> tuple[str, ...]:
        """One name a column."""
        ...

    @property
    def shape(self) -> tuple[float, ...]:
        """Numbers that enter nonlinearly."""
        ...

    @property
    def free_shape(self) -> tuple[float, ...]:
        """Those of them a fit may refine."""
        ...

    def with_shape(self, shape: tuple[float, ...]) -> "Term":
        """The same term with other shape numbers."""
        ...

    @property
    def follows_law(self) -> bool:
        """Whether the columns change with the law's shape."""
        ...

    def columns(self, segment: Segment, signals: Array) -> Array:
        """Torque per unit of each coefficient, shape (n, k)."""
        ...


@dataclass(frozen=True)
class EffectTerm:
    """An effect of the catalogue at given shape numbers."""

    effect: Effect
    shape: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """Canonical name."""
        return self.effect.name

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Names of the linear coefficients."""
        return self.effect.coefficients

    @property
    def free_shape(self) -> tuple[float, ...]:
        """None where the shape is a fixed reference."""
        return () if self.effect.shape_fixed else self.shape

    def with_shape(self, shape: tuple[float, ...]) -> "EffectTerm":
        """The same effect elsewhere on its grid."""
        return replace(self, shape=shape)

    @property
    def follows_law(self) -> bool:
        """Effects on the friction level see Fh."""
        return self.effect.entry == "scales the friction level"

    def columns(self, segment: Segment, signals: Array) -> Array:
        """See `Term`; the kernel is the one a simulation runs."""
        return columns(self.effect.effect_id, self.shape, len(self.coefficients), signals)


@dataclass(frozen=True)
class SmoothTerm:
    """A cubic spline in one measured quantity, alone or times the direction of friction.

    Attributes:
        variable: a key of VARIABLES, or of the segment's further quantities.
        low, high: range the knots span; the curve goes on as a constant outside.
        odd: multiplied by H, the direction of friction.
    """

    variable: str
    low: float
    high: float
    odd: bool = False
    pieces: int = 5
    shape: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """The quantity."""
        return self.variable

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Spline coefficients; the constant is not among them."""
        return tuple(f"b{i}" for i in range(self.pieces + 2))

    @property
    def free_shape(self) -> tuple[float, ...]:
        """None."""
        return ()

    def with_shape(self, shape: tuple[float, ...]) -> "SmoothTerm":
        """A smooth term has no shape numbers."""
        return self

    @property
    def follows_law(self) -> bool:
        """Only times the direction of friction."""
        return self.odd

    def columns(self, segment: Segment, signals: Array) -> Array:
        """See `Term`."""
        x = quantity(segment, signals, self.variable)
        knots = np.linspace(self.low, self.high, self.pieces + 1)[:, None]
        spline = SplineTransformer(3, knots=knots, extrapolation="constant", include_bias=False)
        spline.fit(knots)
        out: Array = spline.transform(np.clip(x, self.low, self.high)[:, None])
        return out * signals[:, [H]] if self.odd else out


def quantity(segment: Segment, signals: Array, variable: str) -> Array:
    """A measured quantity along a segment, shape (n,)."""
    if variable in VARIABLES:
        return signals[:, VARIABLES[variable]]
    return segment.others[variable]
