"""A fit for the user: named parameters with standard errors and units."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.fit import Fit
from frictionjoint.parameter_meanings import UNITS
from frictionjoint.parameters import Friction

_LINEAR = ("Fc", "sigma2", "sigma1")
_DRIVE_UNITS = {"current": "A", "voltage": "V"}
# standard error over the value beyond which logs do not determine a parameter
LOOSE = 0.5


@dataclass(frozen=True)
class Estimate:
    """A number with its standard error (None if the logs do not determine it) and unit.

    A fit that ends at the bound 0 may miss it by rounding; such a value is 0.
    """

    value: float
    stderr: float | None
    unit: str

    def __post_init__(self) -> None:
        if self.stderr and abs(self.value) < 1e-12 * self.stderr:
            object.__setattr__(self, "value", 0.0)

    @property
    def is_loose(self) -> bool:
        """Whether the logs do not determine it: no standard error, or one beyond half of it."""
        return self.stderr is None or self.stderr > LOOSE * abs(self.value)

    def to_dict(self) -> dict[str, float | str | None]:
        """As in report.json."""
        return {"value": self.value, "stderr": self.stderr, "unit": self.unit}


def is_without_level(law: Mapping[str, Estimate]) -> bool:
    """Whether a law has no Coulomb friction, so that breakaway and stiffness mean nothing."""
    # a law needs one above zero; less than this is none in any unit of a joint
    return "Fc_pos" in law and law["Fc_pos"].value < 1e-9


def units_of(fitted: Fit, slide: bool) -> tuple[str, str]:
    """Units of torque and position of a fit."""
    torque, position = ("N", "m") if slide else ("N m", "rad")
    return (_drive_unit(fitted, slide) if fitted.in_drive_units else torque), position


def _drive_unit(fitted: Fit, slide: bool) -> str:
    """Unit of a drive that is not a torque; a position unit if torques are divided by kp."""
    if fitted.over_kp:
        return "m" if slide else "rad"
    return _DRIVE_UNITS[fitted.drive]


def scale_note(fitted: Fit, slide: bool) -> tuple[str, ...]:
    """A note on friction that is stated in units of the drive."""
    if not fitted.in_drive_units:
        return ()
    unit = _drive_unit(fitted, slide)
    if fitted.over_kp:
        return (
            "The scale is not determined: these logs do not show how large the controller's kp is, "
            f"so friction is stated over kp, as the position error in {unit} that overcomes it, "
            "and no model can carry it. Give kp in the controller's file, or record motion with a "
            "payload of known mass that is in the MJCF.",
        )
    return (
        f"The scale is not determined: these logs do not show how much torque 1 {unit} makes, so "
        f"friction is stated in {unit} and no model can carry it. Give the motor constant with "
        "--gain, or record motion with a payload of known mass that is in the MJCF.",
    )


def _coefficient_unit(fitted: Fit, unit: str, slide: bool) -> str:
    """Unit of a linear coefficient; per unit of torque if its column is a torque of the model."""
    torque, position = units_of(fitted, slide)
    if not fitted.in_drive_units or "T" in unit:
        return _spelled(unit, torque, position)
    per = f"{torque}/{'N' if slide else '(N m)'}"
    return per if unit == "1" else f"{per} {unit}"


def _spelled(unit: str, torque: str, position: str) -> str:
    """A unit of the catalogue with T and x spelled out."""
    return unit.replace("T", torque).replace("x", position) if unit != "deg C" else unit


def law_parameters(fitted: Fit) -> Friction:
    """The law as fitted, for simulation."""
    return fitted.shape.parameters(*_linear(fitted))


def _linear(fitted: Fit) -> list[float]:
    """Fc, sigma2 and sigma1; 0 where the fit has none."""
    return [fitted.coefficient(name) for name in _LINEAR]


def law_estimates(fitted: Fit, cov: Array, slide: bool) -> dict[str, Estimate]:
    """Parameters of the law by name, both directions, and the gain of a motor.

    Standard errors follow from the covariance of all parameters of the fit, in the order of its
    jacobian, to first order; None where the number was not fitted or the logs do not determine it.
    """
    linear, x = np.array(_linear(fitted)), fitted.shape.vector()
    theta = np.concatenate([linear, x])
    # columns of the jacobian that theta belongs to
    at = [fitted.names.index(n) if n in fitted.names else -1 for n in _LINEAR]
    at += list(range(fitted.layout.shape.start, fitted.layout.shape.stop))
    scale = np.array([fitted.gain] * len(linear) + [1.0] * len(x))
    values = _law_values(fitted, theta)
    gradients: dict[str, dict[int, float]] = {name: {} for name in values}
    for i in range(len(theta)):
        h = 1e-5 * abs(theta[i]) or 1e-9
        # the logarithm of a ratio of slopes must not rise above 0, nothing else below it
        h = -h if i >= len(linear) and fitted.shape.variables[i - len(linear)][:3] == "log" else h
        moved = theta.copy()
        moved[i] += h
        for name, value in _law_values(fitted, moved).items():
            if at[i] >= 0 and value != values[name]:
                gradients[name][i] = (value - values[name]) / h
    # Fs and Vs mean little where friction barely rises above the Coulomb level
    rises = [x / values["Fc" + name[2:]] for name, x in values.items() if name[:2] == "Fs"]
    flat = bool(rises) and max(rises) <= 1.0 + 1e-3
    units, shape = units_of(fitted, slide), fitted.shape
    assumptions = {"stiffness": shape.stiffness_assumed, "Fs": shape.breakaway_assumed}
    assumptions["Fc"] = fitted.level_assumed
    found = {}
    for name, value in values.items():
        symbol = name.partition("_")[0]
        fixed = symbol in ("sigma1", "sigma2") and symbol not in fitted.names
        if fixed and not value:
            continue
        on = list(gradients[name])
        by_column = {at[i]: gradients[name][i] * scale[i] for i in on}
        assumed = fixed or assumptions.get(symbol, False)
        unknown = not on or assumed or (flat and symbol in ("Vs", "delta"))
        if "T" in UNITS[symbol]:
            by_column |= _of_gain(fitted, value)
        error = None if unknown else _error(cov, by_column)
        found[name] = Estimate(value, error, _spelled(UNITS[symbol], *units))
    if _by_gain(fitted):
        unit = f"{units[0]}/{_drive_unit(fitted, slide)}"
        error = _error(cov, _of_gain(fitted, fitted.gain))
        found["gain"] = Estimate(fitted.gain, error, unit)
    return found


def _by_gain(fitted: Fit) -> bool:
    """Whether torques are known through an estimated gain of the motor."""
    return "load" in fitted.names and not fitted.in_drive_units


def _of_gain(fitted: Fit, value: float) -> dict[int, float]:
    """Derivative of a number proportional to the gain, by the column of the load."""
    if not _by_gain(fitted):
        return {}
    load = fitted.names.index("load")
    return {load: -value / float(fitted.beta[load])}


def _error(cov: Array, gradient: dict[int, float]) -> float | None:
    """Standard error of a number from its gradient by columns."""
    columns, g = list(gradient), np.array(list(gradient.values()))
    return _root(float(g @ cov[np.ix_(columns, columns)] @ g))


def _law_values(fitted: Fit, theta: Array) -> dict[str, float]:
    """Numbers of the law by name, the presliding stiffness last."""
    law = fitted.shape.moved(theta[len(_LINEAR) :]).parameters(*theta[: len(_LINEAR)])
    values = {name: x for name, x in law.to_dict().items() if isinstance(x, float)}
    return values | {"stiffness": law.stiffness}


def term_estimates(fitted: Fit, cov: Array, i: int, slide: bool) -> dict[str, Estimate]:
    """Parameters of term i by name; an effect that changes the load has no size of its own."""
    term, layout = fitted.terms[i], fitted.layout
    values = fitted.term_coefficients(i)
    units = term.effect.units or ("T",) * len(values)
    at = layout.coefficients(i).start
    found = {
        name: Estimate(
            float(values[k]),
            _error(cov, {at + k: fitted.gain} | _of_gain(fitted, float(values[k]))),
            _coefficient_unit(fitted, units[k], slide),
        )
        for k, name in enumerate(term.coefficients)
        if not term.effect.of_load
    }
    at, effect = layout.numbers(i).start, term.effect
    for k, name in enumerate(effect.shape):
        fixed = effect.shape_fixed
        error = None if k < fixed else _root(cov[at + k - fixed, at + k - fixed])
        unit = _spelled(effect.shape_units[k], *units_of(fitted, slide))
        found[name] = Estimate(term.shape[k], error, unit)
    return found | _slope(fitted, cov, i, slide, found)


def _slope(
    fitted: Fit, cov: Array, i: int, slide: bool, found: dict[str, Estimate]
) -> dict[str, Estimate]:
    """Initial slope of a level of which the logs show too little to determine level and length."""
    effect, layout = fitted.terms[i].effect, fitted.layout
    lengths = effect.shape[effect.shape_fixed :]
    if effect.decays_over not in lengths or not found["level"].is_loose:
        return {}
    k, length = lengths.index(effect.decays_over), found[effect.decays_over]
    slope = found["level"].value / length.value
    gradient = {layout.coefficients(i).start: fitted.gain / length.value}
    gradient |= {layout.numbers(i).start + k: -slope / length.value} | _of_gain(fitted, slope)
    unit = f"{found['level'].unit}/{length.unit}"
    estimate = Estimate(slope, _error(cov, gradient), unit)
    return {} if estimate.is_loose else {"slope": estimate}


def _root(variance: float) -> float | None:
    return float(np.sqrt(variance)) if np.isfinite(variance) and variance >= 0.0 else None
