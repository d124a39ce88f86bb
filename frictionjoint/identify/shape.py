"""The shape of the friction law in a fit: what stays nonlinear once Fc is factored out.

The integrated law is homogeneous: scaling Fs, Fc and the torques of Fd scales Fh. So the torque is
``Fc * H(q; shape) + sigma2 v`` with H computed at Fc = 1, and only the shape is searched.
"""

from dataclasses import dataclass
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from frictionjoint.law.motion import drive_integrated
from frictionjoint.parameters import FrictionParameters, Knots, Variant, Virgin

# Torque of the transition curve's knots over its reach: three segments, as in the paper.
_TORQUES = (0.5, 0.8, 1.0)


@dataclass(frozen=True)
class Form:
    """Choices in the law that a fit makes by trying each.

    Attributes:
        n: exponent of the transition to sliding. variant, virgin: see `FrictionParameters`.
    """

    n: float
    variant: Variant
    virgin: Virgin


# Exponents with closed-form steps: a log hardly tells those in between apart, and they are many
# times faster.
FORMS = tuple(Form(n, variant, "literal") for variant in get_args(Variant) for n in (1.0, 2.0, 4.0))


@dataclass(frozen=True)
class Shape:
    """Search variables of the law.

    Attributes:
        excess: Fs / Fc - 1, >= 0.
        Vs: Stribeck velocity, rad/s.
        delta: Stribeck exponent.
        length: z of the first knot, rad; the presliding stiffness is Fs / length.
        bend: slope of the second segment over the first, and of the third over the second, each
            in (0, 1]; (1, 1) is a straight transition curve.
        form: what a search cannot vary smoothly.
    """

    excess: float
    Vs: float
    delta: float
    length: float
    bend: tuple[float, float]
    form: Form

    def parameters(self, Fc: float, sigma2: float, sigma1: float = 0.0) -> FrictionParameters:
        """The law at a Coulomb level."""
        Fs = Fc * (1.0 + self.excess)
        return FrictionParameters.symmetric(
            Fs=Fs,
            Fc=Fc,
            Vs=self.Vs,
            delta=self.delta,
            sigma2=sigma2,
            sigma1=sigma1,
            n=self.form.n,
            variant=self.form.variant,
            virgin=self.form.virgin,
            knots=self.knots(Fs),
        )

    def knots(self, Fs: float) -> Knots:
        """Transition curve that reaches Fs_pos + Fs_neg."""
        z, F, slope = 0.0, 0.0, _TORQUES[0] / self.length
        found = []
        for torque, bend in zip(_TORQUES, (1.0, *self.bend), strict=True):
            slope *= bend
            z += (torque - F) / slope
            F = torque
            found.append((z, 2.0 * Fs * F))
        return tuple(found)

    def hysteresis(
        self, time: NDArray[np.float64], q: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """H = Fh / Fc and dz/dq along a motion, each of shape (n,)."""
        H, rate = np.empty_like(q), np.empty_like(q)
        drive_integrated(self.parameters(1.0, 0.0).pack(), time, q, H, rate)
        return H, rate
