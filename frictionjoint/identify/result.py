"""A fit as a user reads it: named parameters with standard errors and units."""

from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.effect import Effect
from frictionjoint.identify.fit import LAW_SHAPE, Fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.parameters import FrictionParameters


@dataclass(frozen=True)
class Estimate:
    """A number with its standard error (None where the logs do not determine it) and unit."""

    value: float
    stderr: float | None
    unit: str

    def to_dict(self) -> dict[str, float | str | None]:
        """As in report.json."""
        return {"value": self.value, "stderr": self.stderr, "unit": self.unit}


def spelled(unit: str, slide: bool) -> str:
    """A unit of the catalogue with T and x spelled out."""
    torque, position = ("N", "m") if slide else ("N m", "rad")
    return unit.replace("T", torque).replace("x", position) if unit != "deg C" else unit


def law_parameters(fitted: Fit) -> FrictionParameters:
    """The law as fitted, for simulation."""
    sigma2 = fitted.coefficient("sigma2") if "sigma2" in fitted.names else 0.0
    sigma1 = fitted.coefficient("sigma1") if "sigma1" in fitted.names else 0.0
    Fc = fitted.coefficient("Fc")
    return fitted.shape.parameters(Fc, sigma2, sigma1)


def law_estimates(fitted: Fit, cov: Array, slide: bool) -> dict[str, Estimate]:
    """Parameters of the law by name, both directions."""
    torque, speed, viscous = (spelled(u, slide) for u in ("T", "x/s", "T s/x"))
    i = fitted.names.index("Fc")
    s = len(fitted.names)  # shape variables follow the linear ones
    Fc, gain = fitted.coefficient("Fc"), fitted.gain
    var_Fc = cov[i, i] * gain**2
    excess, Vs = fitted.shape.excess, fitted.shape.Vs
    slope = 1.0 + excess
    var_Fs = slope**2 * var_Fc + Fc**2 * cov[s, s] + 2 * slope * Fc * gain * cov[i, s]
    Fs = Fc * slope
    K = fitted.shape.parameters(Fc, 0.0).stiffness
    # Fs and Vs mean little where friction hardly rises above the Coulomb level
    seen = excess > 1e-3
    rows = {
        "Fs": Estimate(Fs, _root(var_Fs), torque),
        "Fc": Estimate(Fc, _root(var_Fc), torque),
        "Vs": Estimate(Vs, _scaled(cov[s + 1, s + 1], Vs) if seen else None, speed),
        "delta": Estimate(fitted.shape.delta, _root(cov[s + 2, s + 2]) if seen else None, "1"),
    }
    if "sigma2" in fitted.names:
        k = fitted.names.index("sigma2")
        rows["sigma2"] = Estimate(fitted.coefficient("sigma2"), _root(cov[k, k]), viscous)
    found = {f"{name}_{side}": x for name, x in rows.items() for side in ("pos", "neg")}
    relative = _root(cov[s + 3, s + 3])
    found["stiffness"] = Estimate(
        K, None if relative is None else K * relative, spelled("T/x", slide)
    )
    if "sigma1" in fitted.names:
        k = fitted.names.index("sigma1")
        found["sigma1"] = Estimate(
            fitted.coefficient("sigma1"), _scaled(cov[k, k], fitted.gain), viscous
        )
    found["n"] = Estimate(fitted.shape.form.n, None, "1")
    if gain != 1.0:
        g = cov[0, 0] * gain**2
        relative = _root(g / (fitted.beta[0] * gain) ** 2)
        found["gain"] = Estimate(
            gain, None if relative is None else gain * relative, f"{torque} per unit of drive"
        )
    return found


def term_estimates(fitted: Fit, cov: Array, i: int, slide: bool) -> dict[str, Estimate]:
    """Parameters of term i by name."""
    term = fitted.terms[i]
    before = sum(len(t.coefficients) for t in fitted.terms[:i])
    after = sum(len(t.coefficients) for t in fitted.terms[i:])
    first = len(fitted.names) - before - after + before
    values = fitted.term_coefficients(i)
    units = term.effect.units if isinstance(term, EffectTerm) else ("N m",) * len(values)
    found = {
        name: Estimate(
            float(values[k]),
            _scaled(cov[first + k, first + k], fitted.gain),
            spelled(units[k], slide),
        )
        for k, name in enumerate(term.coefficients)
    }
    if isinstance(term, EffectTerm):
        at = len(fitted.names) + LAW_SHAPE + sum(len(t.free_shape) for t in fitted.terms[:i])
        effect: Effect = term.effect
        for k, name in enumerate(effect.shape):
            error = None if effect.shape_fixed else _root(cov[at + k, at + k])
            unit = spelled(effect.shape_units[k], slide)
            found[name] = Estimate(term.shape[k], error, unit)
    return found


def _root(variance: float) -> float | None:
    return float(np.sqrt(variance)) if np.isfinite(variance) and variance >= 0.0 else None


def _scaled(variance: float, gain: float) -> float | None:
    root = _root(variance)
    return None if root is None else root * gain
