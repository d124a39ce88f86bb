"""The shape of the friction law in a fit: what stays nonlinear once Fc is factored out.

The integrated law is homogeneous: scaling Fs, Fc and the torques of Fd scales Fh. So the torque is
``Fc * H(q; shape) + sigma2 v`` with H computed at Fc = 1, and only the shape is searched.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frictionjoint.law.motion import drive
from frictionjoint.parameters import FrictionParameters, Knots

# Torque of the transition curve's knots over its reach, and their positions over the first one:
# three segments as in the paper, slopes falling by 1 : 0.4 : 0.1.
_TORQUES = (0.5, 0.8, 1.0)
_POSITIONS = (1.0, 2.5, 6.5)


# Those with closed-form steps: a log hardly tells exponents in between apart, and they are many
# times faster.
EXPONENTS = (1.0, 2.0, 4.0)


@dataclass(frozen=True)
class Shape:
    """Search variables of the law.

    Attributes:
        excess: Fs / Fc - 1, >= 0.
        Vs: Stribeck velocity, rad/s.
        delta: Stribeck exponent.
        length: z of the first knot, rad; the presliding stiffness is Fs / length.
        n: exponent of the transition to sliding; one of EXPONENTS, chosen by the fit.
    """

    excess: float
    Vs: float
    delta: float
    length: float
    n: float

    def parameters(self, Fc: float, sigma2: float) -> FrictionParameters:
        """The law at a Coulomb level."""
        Fs = Fc * (1.0 + self.excess)
        return FrictionParameters.symmetric(
            Fs=Fs,
            Fc=Fc,
            Vs=self.Vs,
            delta=self.delta,
            sigma2=sigma2,
            n=self.n,
            knots=self.knots(Fs),
        )

    def knots(self, Fs: float) -> Knots:
        """Transition curve that reaches Fs_pos + Fs_neg."""
        return tuple(
            (self.length * z, 2.0 * Fs * F) for z, F in zip(_POSITIONS, _TORQUES, strict=True)
        )

    def hysteresis(self, time: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
        """H(t) = Fh / Fc along a motion."""
        block = self.parameters(1.0, 0.0).pack()
        H = np.empty_like(q)
        drive(block, 0, time, q, np.empty(0), H)
        return H
