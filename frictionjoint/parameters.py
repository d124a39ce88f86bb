"""Parameters of a joint's friction: fields, units, validation, and the block that a kernel
reads."""

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray

from frictionjoint.display import table
from frictionjoint.errors import ParameterError
from frictionjoint.parameter_checks import (
    LEVEL_FIELDS,
    LEVELS,
    SIDES,
    both_directions,
    check_keys,
    check_number,
    number_pairs,
    one_of,
    require,
    require_table,
)
from frictionjoint.parameter_meanings import five, meaning, short

Variant = Literal["ganseman1997", "lampaert2002"]
Virgin = Literal["literal", "masing"]
Knots = tuple[tuple[float, float], ...]

# knots of a transition curve, or Maxwell-slip elements, which are the same
MOST_KNOTS = 16
_MAGNITUDE = "> 0 (a magnitude, also for negative motion)"
# range of each number, whatever its direction
_RANGES: dict[str, tuple[Callable[[float], bool], str]] = {
    **dict.fromkeys(("Fs", "Fc"), (lambda x: x > 0.0, _MAGNITUDE)),
    **dict.fromkeys(("Vs", "V0", "C", "sigma0"), (lambda x: x > 0.0, "> 0")),
    **dict.fromkeys(("sigma1", "sigma2"), (lambda x: x >= 0.0, ">= 0")),
    "delta": (lambda x: 0.0 < x <= 10.0, "in (0, 10]"),
    "i": (lambda x: 0.0 <= x <= 10.0, "in [0, 10]"),
    "breakaway": (lambda x: 0.0 <= x <= 0.99, "in [0, 0.99]"),
    "n": (lambda x: 1.0 <= x <= 1000.0, "in [1, 1000]"),
}


def _damaged() -> ParameterError:
    return ParameterError("the friction block is damaged: install the friction again")


@dataclass(frozen=True, kw_only=True)
class Friction:
    """Parameters of a friction law: validated numbers, files, and the block that a kernel reads.

    A block contains the law's number, what stands before the levels, usually sigma1, the levels of
    both directions, and the law's own numbers: usually the fields named in `own`.

    Raises:
        ParameterError: a value is missing or out of its range; the message names it and the range.
    """

    law: ClassVar[str]
    number: ClassVar[int]
    own: ClassVar[tuple[str, ...]] = ()

    def __new__(cls, *args: Any, **given: Any) -> Self:
        """Check the names first: Python's own TypeError for a missing argument states no fix."""
        check_keys(cls, given)
        return super().__new__(cls)

    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]:
        # what copy and pickle give to __new__
        return (), vars(self)

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            if field.type is float:
                value = check_number(field.name, getattr(self, field.name))
                holds, allowed = _RANGES[field.name.partition("_")[0]]
                require(holds(value), field.name, value, allowed)
                object.__setattr__(self, field.name, value)
        self._check()

    def _check(self) -> None:
        """Check what concerns several numbers."""

    @property
    def stiffness(self) -> float:
        """Presliding stiffness at a reversal, N m/rad."""
        raise NotImplementedError

    def levels(self, side: str) -> list[float]:
        """The numbers of a direction, in the order of `LEVELS`."""
        return [getattr(self, f"{name}_{side}") for name in LEVELS]

    def _head(self) -> list[float]:
        """The numbers of the block between that of the law and the levels."""
        return [getattr(self, "sigma1", 0.0)]

    def _own(self) -> list[float]:
        """The numbers of the block behind the levels."""
        return [getattr(self, name) for name in self.own]

    @classmethod
    def _own_fields(cls, own: list[float]) -> dict[str, Any]:
        """Inverse of `_own`."""
        return dict(zip(cls.own, own, strict=True))

    def pack(self) -> NDArray[np.float64]:
        """The block of numbers that the law's kernel reads, the number of the law in front."""
        levels = [x for side in SIDES for x in self.levels(side)]
        return np.array([self.number, *self._head(), *levels, *self._own()], dtype=np.float64)

    @classmethod
    def _from_numbers(cls, numbers: list[float]) -> Self:
        """Parameters of a block; an IndexError, ValueError or OverflowError if it is damaged."""
        first = 2 + len(LEVEL_FIELDS)
        given = dict(zip(("sigma1", *LEVEL_FIELDS), numbers[1:first], strict=True))
        given |= cls._own_fields(numbers[first:])
        # the static law has no sigma1, Dahl's no Stribeck effect
        names = {field.name for field in dataclasses.fields(cls)}
        return cls(**{name: x for name, x in given.items() if name in names})

    @classmethod
    def unpack(cls, block: NDArray[np.float64]) -> Self:
        """Inverse of `pack`.

        Raises:
            ParameterError: the block is damaged or its values are out of range.
        """
        try:
            found = cls._from_numbers([float(x) for x in block])
        except ParameterError:
            raise
        except (IndexError, ValueError, OverflowError):
            raise _damaged() from None
        # the numbers a law has no field for must be those it writes
        if not np.array_equal(found.pack(), block):
            raise _damaged()
        return found

    @classmethod
    def symmetric(cls, **values: Any) -> Self:
        """The same levels in both directions: ``Fs=1.2`` for ``Fs_pos=1.2, Fs_neg=1.2``."""
        return cls.from_dict(values)

    def to_dict(self) -> dict[str, Any]:
        """Plain values by field name, `law` first, for TOML and JSON."""
        values = {
            name: [list(pair) for pair in x] if isinstance(x, tuple) else x
            for name, x in dataclasses.asdict(self).items()
        }
        return {"law": self.law, **values}

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Inverse of `to_dict`; ``Fs`` in place of ``Fs_pos`` and ``Fs_neg`` is both.

        Raises:
            ParameterError: a key is unknown or missing, or a value out of range.
            TypeError: `values` is no dict.
        """
        require_table(values)
        return cls(**both_directions({key: x for key, x in values.items() if key != "law"}))

    def _repr_html_(self) -> str:
        rows = ((name, five(x, str)) for name, x in self.to_dict().items())
        return table("friction: N m and rad, N and m for a slide", ("parameter", "value"), rows)


@dataclass(frozen=True, kw_only=True)
class StribeckFriction(Friction):
    """Levels with a Stribeck effect; see `FrictionParameters` for ranges and units."""

    Fs_pos: float
    Fs_neg: float
    Fc_pos: float
    Fc_neg: float
    Vs_pos: float
    Vs_neg: float
    delta_pos: float = 2.0
    delta_neg: float = 2.0
    sigma2_pos: float = 0.0
    sigma2_neg: float = 0.0

    def _check(self) -> None:
        for side in SIDES:
            Fs, Fc = getattr(self, f"Fs_{side}"), getattr(self, f"Fc_{side}")
            require(Fc <= Fs, f"Fc_{side}", Fc, f"in (0, Fs_{side} = {Fs:g}]")


@dataclass(frozen=True, kw_only=True, repr=False)
class FrictionParameters(StribeckFriction):
    """Parameters of the integrated friction model (Ganseman et al. 1997), one joint.

    Torques are magnitudes in N m, also those of the negative direction (the paper writes Fs-,
    Fc- with a negative sign). Each field in _pos, for positive motion, has its twin in _neg. For a
    slide joint read N for N m and m for rad.

    Attributes:
        Fs_pos: breakaway (static) torque, N m, > 0.
        Fc_pos: Coulomb torque, N m, 0 < Fc <= Fs.
        Vs_pos: Stribeck velocity, rad/s, > 0.
        delta_pos: Stribeck exponent, 0 < delta <= 10.
        sigma2_pos: viscous coefficient, N m s/rad, >= 0.
        sigma1: presliding damping, N m s/rad, >= 0.
        n: exponent of the transition to sliding, 1 <= n <= 1000.
        knots: ((z, F), ...) of the transition curve Fd for z > 0, rad and N m; it starts in
            (0, 0), increases, is concave, and its last torque is at least Fs_pos + Fs_neg.
        variant: "ganseman1997", or "lampaert2002" with r = Fh / S.
        virgin: first loading: "literal" Fd(z), or "masing" Fd(2z)/2.

    Raises:
        ParameterError: a value out of its range; the message names it and the range.
    """

    sigma1: float = 0.0
    n: float = 1.0
    knots: Knots
    variant: Variant = "ganseman1997"
    virgin: Virgin = "literal"

    law: ClassVar[str] = "integrated"
    number: ClassVar[int] = 1

    def _check(self) -> None:
        super()._check()
        require(self.variant in get_args(Variant), "variant", self.variant, one_of(Variant))
        require(self.virgin in get_args(Virgin), "virgin", self.virgin, one_of(Virgin))
        object.__setattr__(self, "knots", _checked_knots(self.knots, self.Fs_pos + self.Fs_neg))

    @classmethod
    def symmetric(
        cls,
        *,
        Fs: float | None = None,
        Fc: float | None = None,
        Vs: float | None = None,
        delta: float = 2.0,
        sigma2: float = 0.0,
        stiffness: float | None = None,
        **others: Any,
    ) -> Self:
        """The same levels in both directions; `others` are the remaining fields.

        Args:
            Fs: breakaway torque, N m. Fc: Coulomb torque, N m. Vs: Stribeck velocity, rad/s.
            delta: Stribeck exponent. sigma2: viscous coefficient, N m s/rad.
            stiffness: presliding stiffness at a reversal, N m/rad, in place of `knots`: the
                transition curve then has three segments, see `knots_of`.
        Raises:
            ParameterError: Fs, Fc or Vs is missing, a value is out of its range, or both or neither
                of stiffness and knots are given.
        """
        levels = {"Fs": Fs, "Fc": Fc, "Vs": Vs, "delta": delta, "sigma2": sigma2}
        missing = [f"{name} ({meaning(name)})" for name, x in levels.items() if x is None]
        if missing:
            raise ParameterError(f"missing parameter {', '.join(missing)}: add it")
        if (stiffness is None) == ("knots" not in others):
            raise ParameterError("give either stiffness, N m/rad, or knots")
        if stiffness is not None:
            others["stiffness"] = stiffness
        return cls.from_dict(levels | others)

    @property
    def stiffness(self) -> float:
        """Presliding stiffness at a reversal, N m/rad: the slope of Fd at 1% of its last torque.

        A fit may assume a steep beginning below that, so that the joint comes to rest.
        """
        least = 0.01 * self.knots[-1][1]
        return next(slope for _, F, slope in _segments(self.knots) if least <= F)

    def _head(self) -> list[float]:
        return [self.variant == "lampaert2002", self.virgin == "masing", self.n, self.sigma1]

    def _own(self) -> list[float]:
        return [len(self.knots), *(x for segment in _segments(self.knots) for x in segment)]

    @classmethod
    def _from_numbers(cls, numbers: list[float]) -> Self:
        if len(numbers) != 16 + 3 * int(numbers[15]) or len(numbers) == 16:
            raise ValueError
        return cls(
            **dict(zip(LEVEL_FIELDS, numbers[5:15], strict=True)),
            n=numbers[3],
            sigma1=numbers[4],
            knots=tuple(zip(numbers[16::3], numbers[17::3], strict=True)),
            variant="lampaert2002" if numbers[1] else "ganseman1997",
            virgin="masing" if numbers[2] else "literal",
        )

    def __repr__(self) -> str:
        given = {
            f.name: getattr(self, f.name)
            for f in dataclasses.fields(self)
            if getattr(self, f.name) != f.default
        }
        return f"FrictionParameters({short(given)})"

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """`Friction.from_dict`; takes a presliding `stiffness`, N m/rad, in place of knots too."""
        require_table(values)
        given = dict(values)
        if "stiffness" in given:
            if "knots" in given:
                raise ParameterError("stiffness and knots are given: give one of them")
            both = both_directions(given)
            largest = max(check_number(f"Fs_{s}", both.get(f"Fs_{s}", 1.0)) for s in SIDES)
            given["knots"] = knots_of(largest, given.pop("stiffness"))
        return super().from_dict(given)


def knots_of(Fs: float, stiffness: float) -> Knots:
    """A transition curve of three segments with a given first slope, reaching 2 Fs.

    The slope halves at Fs and again at 1.6 Fs. This shape is a choice: a stiffness alone does not
    determine the curve. If a fit provides knots, use those instead.

    Args:
        Fs: breakaway torque, N m. stiffness: first slope, N m/rad.
    Raises:
        ParameterError: Fs or the stiffness is not a positive number.
    """
    Fs, stiffness = check_number("Fs", Fs), check_number("stiffness", stiffness)
    require(Fs > 0, "Fs", Fs, "> 0")
    require(stiffness > 0, "stiffness", stiffness, "> 0")
    z = F = 0.0
    found = []
    for level, slope in ((1.0, 1.0), (1.6, 0.5), (2.0, 0.25)):
        z += (level * Fs - F) / (slope * stiffness)
        F = level * Fs
        found.append((z, F))
    return tuple(found)


def _segments(knots: Knots) -> Iterator[tuple[float, float, float]]:
    z0 = F0 = 0.0
    for z, F in knots:
        yield z, F, (F - F0) / (z - z0)
        z0, F0 = z, F


def _checked_knots(knots: Any, reach: float) -> Knots:
    pairs = number_pairs("knots", knots, "[z, F] of numbers: rad and N m", MOST_KNOTS)
    z0 = F0 = 0.0
    previous = math.inf
    for i, (z, F) in enumerate(pairs):
        if not (z > z0 and F > F0):
            raise ParameterError(f"knots[{i}] is [{z:g}, {F:g}]: z and F must increase from (0, 0)")
        slope = (F - F0) / (z - z0)
        # Rounding in files may break equality of slopes by parts in 1e15, not concavity.
        if not 0 < slope <= previous * (1 + 1e-9):
            raise ParameterError(
                f"knots[{i}] makes Fd convex ({slope:g} N m/rad after {previous:g}): "
                "slopes must fall, or inner hysteresis curves leave the outer ones"
            )
        if not math.isfinite(slope):
            raise ParameterError(f"knots[{i}] is [{z:g}, {F:g}]: its slope overflows")
        z0, F0, previous = z, F, slope
    if reach * (1 - 1e-12) > F0:
        raise ParameterError(
            f"knots end at {F0:g} N m: Fd must reach Fs_pos + Fs_neg = {reach:g} N m, add a knot"
        )
    return pairs
