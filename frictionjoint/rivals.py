"""Parameters of the other friction laws, one frozen class per law.

Torques are magnitudes in N m, also for the negative direction; for a slide joint read N for N m and
m for rad. Fs, Fc, Vs, delta and sigma2 (_pos, _neg) are those of `FrictionParameters`. Every class
raises `ParameterError`, naming the value and its range.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from frictionjoint.parameter_checks import number_pairs, require
from frictionjoint.parameters import MOST_KNOTS, Friction, StribeckFriction


@dataclass(frozen=True, kw_only=True)
class _Bristle(StribeckFriction):
    """A law with a Stribeck effect and a spring of stiffness sigma0."""

    sigma0: float

    own: ClassVar[tuple[str, ...]] = ("sigma0",)

    @property
    def stiffness(self) -> float:
        """Presliding stiffness, N m/rad."""
        return self.sigma0


@dataclass(frozen=True, kw_only=True)
class StaticParameters(StribeckFriction):
    """Coulomb, Stribeck and viscous torque as a function of velocity (see ``law.static``).

    Attributes:
        V0: rad/s, > 0; below this speed the torque falls linearly to zero.
    """

    V0: float

    law: ClassVar[str] = "static"
    number: ClassVar[int] = 2
    own: ClassVar[tuple[str, ...]] = ("V0",)

    @property
    def stiffness(self) -> float:
        """Zero: the law has no presliding."""
        return 0.0


@dataclass(frozen=True, kw_only=True)
class ArmstrongParameters(_Bristle):
    """Linear presliding spring with breakaway, Armstrong-Helouvry (1991), ``law.armstrong``.

    Attributes:
        sigma0: stiffness before breakaway, N m/rad, > 0.
    """

    law: ClassVar[str] = "armstrong"
    number: ClassVar[int] = 3


class _DahlCurve:
    """What Dahl's curve has, on any level; its fields are declared where their order is known."""

    sigma0: float
    i: float

    own: ClassVar[tuple[str, ...]] = ("sigma0", "i")

    @property
    def stiffness(self) -> float:
        """Stiffness at a reversal of a symmetric joint, N m/rad: there w is 2."""
        rise: float = 2.0**self.i
        return self.sigma0 * rise


@dataclass(frozen=True, kw_only=True)
class DahlParameters(_DahlCurve, Friction):
    """Dahl's law (1968), ``law.dahl``.

    Attributes:
        Fc_pos: Coulomb torque, N m, > 0; Fc_neg for negative motion.
        sigma2_pos: viscous coefficient, N m s/rad, >= 0 (0 in Dahl's report); sigma2_neg for
            negative motion.
        sigma0: stiffness at zero torque, N m/rad, > 0.
        i: exponent, 0 <= i <= 10; 0 is a spring with a limit, 1 the usual exponential.
    """

    Fc_pos: float
    Fc_neg: float
    sigma2_pos: float = 0.0
    sigma2_neg: float = 0.0
    sigma0: float
    i: float = 1.0

    law: ClassVar[str] = "dahl"
    number: ClassVar[int] = 4

    def levels(self, side: str) -> list[float]:
        """The numbers of a direction; the law has no Stribeck effect."""
        Fc = getattr(self, f"Fc_{side}")
        return [Fc, Fc, 1.0, 1.0, getattr(self, f"sigma2_{side}")]


@dataclass(frozen=True, kw_only=True)
class DahlStribeckParameters(_DahlCurve, StribeckFriction):
    """Dahl's hysteresis scaled by the Stribeck curve, ``law.dahl.stribeck_step``.

    Attributes:
        sigma0: stiffness at zero torque and low speed, N m/rad, > 0.
        i: exponent, 0 <= i <= 10; 0 is a spring with a limit, 1 the usual exponential.
    """

    sigma0: float
    i: float = 1.0

    law: ClassVar[str] = "dahl_stribeck"
    number: ClassVar[int] = 8


@dataclass(frozen=True, kw_only=True)
class LuGreParameters(_Bristle):
    """LuGre (Canudas de Wit et al. 1995), ``law.lugre``.

    Attributes:
        sigma0: bristle stiffness, N m/rad, > 0.
        sigma1: bristle damping, N m s/rad, >= 0.
    """

    sigma1: float = 0.0

    law: ClassVar[str] = "lugre"
    number: ClassVar[int] = 5


@dataclass(frozen=True, kw_only=True)
class ElastoplasticParameters(_Bristle):
    """Elasto-plastic friction (Dupont et al. 2002), ``law.elastoplastic``.

    Attributes:
        sigma0: bristle stiffness, N m/rad, > 0.
        sigma1: bristle damping, N m s/rad, >= 0.
        breakaway: torque up to which the contact is elastic, divided by Fc, 0 <= breakaway <= 0.99;
            sigma0 zba = breakaway Fc.
    """

    sigma1: float = 0.0
    breakaway: float = 0.7

    law: ClassVar[str] = "elastoplastic"
    number: ClassVar[int] = 6
    own: ClassVar[tuple[str, ...]] = ("sigma0", "breakaway")


@dataclass(frozen=True, kw_only=True)
class MaxwellSlipParameters(StribeckFriction):
    """Generalized Maxwell-slip (Al-Bender, Lampaert and Swevers 2005), ``law.maxwell_slip``.

    Attributes:
        elements: ((k, fraction), ...), 1 to 16 elements; k in N m/rad, > 0, fractions of the level
            S, > 0, that sum to 1.
        C: attraction to the Stribeck curve, N m/s, > 0.
        sigma1: damping of the elements while they stick, by their fractions, N m s/rad, >= 0.
    """

    elements: tuple[tuple[float, float], ...]
    C: float
    sigma1: float = 0.0

    law: ClassVar[str] = "maxwell_slip"
    number: ClassVar[int] = 7

    @property
    def stiffness(self) -> float:
        """Presliding stiffness at a reversal, N m/rad: all springs together."""
        return math.fsum(k for k, _ in self.elements)

    def _check(self) -> None:
        super()._check()
        what = "[k, fraction of the level], numbers, k in N m/rad"
        pairs = number_pairs("elements", self.elements, what, MOST_KNOTS)
        for i, (k, fraction) in enumerate(pairs):
            require(k > 0, f"elements[{i}] stiffness", k, "> 0")
            require(fraction > 0, f"elements[{i}] fraction", fraction, "> 0")
        total = math.fsum(fraction for _, fraction in pairs)
        require(abs(total - 1) < 1e-9, "sum of the elements' fractions", total, "1")
        object.__setattr__(self, "elements", pairs)

    def _own(self) -> list[float]:
        return [self.C, float(len(self.elements)), *(x for pair in self.elements for x in pair)]

    @classmethod
    def _own_fields(cls, own: list[float]) -> dict[str, Any]:
        return {"C": own[0], "elements": tuple(zip(own[2::2], own[3::2], strict=True))}


RIVALS: tuple[type[Friction], ...] = (
    StaticParameters,
    ArmstrongParameters,
    DahlParameters,
    DahlStribeckParameters,
    LuGreParameters,
    ElastoplasticParameters,
    MaxwellSlipParameters,
)
