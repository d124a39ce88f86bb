"""Wrong inertial parameters of a link: mass; mass, centre and radius of gyration; or all ten.

All three keep the body physically possible: its pseudo-inertia becomes (L T)(L T)' with L its
Cholesky factor and T lower triangular with a positive diagonal (log-Cholesky; Rucker and Wensing
2022).
"""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.robot.causes.cause import Cause
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.inertia import NAMES, UNITS, about_centre, of_body, of_pseudo, pseudo

Form = Literal["mass", "mass, centre, gyration", "all ten"]
_SIZES: dict[Form, int] = {"mass": 1, "mass, centre, gyration": 5, "all ten": 10}
# of T, below its diagonal
_BELOW = np.tril_indices(4, -1)


@dataclass(frozen=True)
class BodyInertia(Cause):
    """Numbers: the logarithm of the mass over the model's; in addition the shift of the centre, m,
    and the logarithm of the radius of gyration over the model's, equal about all axes; or the
    logarithms of T's diagonal and its entries below.

    Attributes:
        body: number and name. form: which of its parameters are wrong.
        size: length by which its centre may be shifted, m.
    """

    body: int
    body_name: str
    form: Form
    size: float = 0.1
    name: ClassVar[str] = "body-inertia"

    @property
    def place(self) -> dict[str, str]:
        return {"body": self.body_name}

    @property
    def steps(self) -> Array:
        """1e-5 of each number, which is dimensionless or a length."""
        return np.full(_SIZES[self.form], 1e-5)

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """The farthest change of each number."""
        # beyond it, a factor of twenty in mass, it is another body
        found = [(-3.0, 3.0)] * _SIZES[self.form]
        if self.form == "mass, centre, gyration":
            found[1:4] = [(-3.0 * self.size, 3.0 * self.size)] * 3
        return tuple(found)

    @property
    def prior(self) -> Array:
        """About the model's own value; the size of the body for a shift of its centre."""
        # standard deviation of the relative change of each entry of T: undetermined numbers stay
        # near the model's
        found = np.ones(_SIZES[self.form])
        if self.form == "mass, centre, gyration":
            found[1:4] = self.size
        return found

    def applied(self, state: Corrections, x: Array) -> Corrections:
        """The ten parameters of the body, changed so that it stays physically possible."""
        return state.with_body(self.body, self._changed(state.phi[self.body], x))

    def _changed(self, phi: Array, x: Array) -> Array:
        if not np.any(x):
            return phi
        if self.form == "mass":
            return np.asarray(phi * np.exp(x[0]))
        if self.form == "mass, centre, gyration":
            # with the model's radius of gyration, the mass would be fitted to the inertia, and a
            # false rotor to what the wrong mass leaves in other joints
            mass, centre, own = about_centre(phi)
            grown = float(np.exp(x[0]))
            return of_body(mass * grown, centre + x[1:4], own * grown * float(np.exp(2.0 * x[4])))
        T = np.diag(np.exp(x[:4]))
        T[_BELOW] = x[4:]
        half = np.linalg.cholesky(pseudo(phi)) @ T
        return of_pseudo(half @ half.T)

    def values(self, state: Corrections, x: Array) -> dict[str, tuple[float, str]]:
        """Mass, centre and inertia of the body after the change, as far as the form has them."""
        before = state.phi[self.body]
        after = self._changed(before, x)
        found = {
            "mass": (float(after[0]), "kg"),
            "mass_over_model": (float(after[0] / before[0]), "1"),
        }
        if self.form != "mass":
            for axis, c in zip("xyz", after[1:4] / after[0], strict=True):
                found[f"centre_{axis}"] = (float(c), "m")
        if self.form == "mass, centre, gyration":
            found["gyration_radius_over_model"] = (float(np.exp(x[4])), "1")
        if self.form == "all ten":
            for name, unit, value in zip(NAMES[4:], UNITS[4:], after[4:], strict=True):
                found[name.replace("inertia ", "I")] = (float(value), unit)
        return found
